// The polhode: the curve that the angular velocity draws in the body, and the inertia ellipsoid that it lies on.
#pragma once

#include <string>
#include <vector>

#include "body/algebra.h"
#include "motion/problem.h"

namespace polhode {

using Polyline = std::vector<Vector3<double>>;

/// The curve that the angular velocity draws in the body: principal axes, rad/s.
struct PolhodeCurve {
    std::string fault;  ///< empty, or why there is no curve
    Vector3<double> moments;
    bool body_axes = true;  ///< the principal axes are the body's own
    /// The curve stays on the ellipsoid: no torque, and no impulse after the start.
    bool free = false;
    /// The kinetic energy of rotation, J, at t = 0, or the run's largest where that is zero. Zero for a body that never
    /// turns.
    double energy = 0;
    bool energy_of_start = true;
    /// The semi-axes sqrt(2 E / I_i) of the ellipsoid 2 E = I1 w1^2 + I2 w2^2 + I3 w3^2.
    Vector3<double> semi_axes;
    /// The curve in order of time, in pieces between impulses; for a free body no further than once round.
    std::vector<Polyline> curve;
    bool closed = false;  ///< the curve ends where it began
    double until = 0;     ///< s, the time shown
    /// The separatrix of a free asymmetric body: the two ellipses through the ends of the middle axis, L^2 = 2 E I2
    /// (Poinsot 1834).
    std::vector<Polyline> separatrix;
};

/// Solves the scene by the method that suits it best (as `solve` does without a method).
PolhodeCurve polhode_curve(const Problem& problem);

/// The points that matter of a polyline: what is left out lies within `tolerance` of the rest (Ramer, Douglas and
/// Peucker). Lengths are measured in units of `scale` along each axis.
Polyline simplified(const Polyline& line, const Vector3<double>& scale, double tolerance);

}  // namespace polhode
