// The polhode: the curve of the angular velocity in body-fixed axes, and the inertia ellipsoid that it lies on.
#pragma once

#include <string>
#include <vector>

#include "body/algebra.h"
#include "motion/problem.h"

namespace polhode {

using Polyline = std::vector<Vector3<double>>;

/// The curve of the angular velocity in principal axes, rad/s.
struct PolhodeCurve {
    std::string fault;  ///< why there is no curve; otherwise empty
    Vector3<double> moments;
    bool body_axes = true;  ///< the principal axes are the body axes
    /// True if the curve stays on the ellipsoid: no torque, and no impulse after the start.
    bool free = false;
    /// The kinetic energy of rotation, J, at t = 0, or the largest of the run if that is zero. Zero if the body does
    /// not rotate.
    double energy = 0;
    bool energy_of_start = true;
    /// The semi-axes sqrt(2 E / I_i) of the ellipsoid 2 E = I1 w1^2 + I2 w2^2 + I3 w3^2.
    Vector3<double> semi_axes;
    /// The curve in order of time, in pieces between impulses; for a free body at most one period.
    std::vector<Polyline> curve;
    bool closed = false;  ///< the curve ends at its start
    double until = 0;     ///< end of the time shown, s
    /// The separatrix of a free asymmetric body: the two ellipses through the ends of the middle axis, L^2 = 2 E I2
    /// (Poinsot 1834).
    std::vector<Polyline> separatrix;
};

/// Solves the scene with the method that `auto` selects and returns its polhode.
PolhodeCurve polhode_curve(const Problem& problem);

/// Simplifies a polyline (Ramer, Douglas and Peucker): omitted points are within `tolerance` of the result. Lengths are
/// measured in units of `scale` along each axis.
Polyline simplify(const Polyline& line, const Vector3<double>& scale, double tolerance);

}  // namespace polhode
