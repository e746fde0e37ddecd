// Stiffness and damping of the springs of a body made of points.
#pragma once

#include "integrators/points/point_body.h"

namespace polhode {

/// Angular frequencies (rad/s) of the network's slowest and fastest vibration about its rest state.
struct SpringFrequencies {
    double slowest = 0, fastest = 0;
};
/// Computes these frequencies for springs of this stiffness (N/m), without damping.
SpringFrequencies spring_frequencies(const PointBody& body, double stiffness);

/// Default stiffness, N/m: the slowest vibration has 100 times the scene's largest angular velocity (or, without
/// rotation, 100 times one radian per duration). The stretch due to rotation is then about 10^-4. Explicit steps that
/// give moderate accuracy for the rotation are just stable.
double default_stiffness(const Problem& problem, const PointBody& body);

/// N s/m: damping for `ratio` times the critical damping of the slowest vibration, 2 ratio k / w. Faster vibrations
/// are damped more strongly.
double damping_from_ratio(const PointBody& body, double stiffness, double ratio);

}  // namespace polhode
