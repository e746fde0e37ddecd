// How stiff the springs of a body made of points are.
#pragma once

#include "integrators/points/point_body.h"

namespace polhode {

/// Angular frequencies (rad/s) of the network's slowest and fastest vibration about its rest.
struct SpringFrequencies {
    double slowest = 0, fastest = 0;
};
SpringFrequencies spring_frequencies(const PointBody& body, double stiffness);

/// N/m: so that the slowest vibration has 100 times the scene's largest angular velocity (or, in a scene without
/// rotation, of one radian in its duration). The stretch under rotation is then about 10^-4, and explicit steps that
/// would do for the rotation at a moderate accuracy are just stable.
double default_stiffness(const Problem& problem, const PointBody& body);

/// N s/m: `ratio` of the slowest vibration's critical damping, 2 ratio k / w; the faster ones have more of theirs.
double damping_of_ratio(const PointBody& body, double stiffness, double ratio);

}  // namespace polhode
