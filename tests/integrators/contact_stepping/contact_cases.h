// Contact scenes with closed forms, for the tests of time-stepping contact methods.
#pragma once

#include <cmath>
#include <string>

#include "integrators/scenes.h"
#include "scene/body_source.h"

namespace polhode::testing {

inline constexpr double contact_g = 9.81;

/// A body of 2 kg on or above the plane z = 0, under gravity; its origin is its centre of mass.
inline Scene on_floor(const Shape& shape, double height, double restitution, double friction) {
    Scene scene;
    scene.name = "on the floor", scene.duration = 1;
    scene.body = body_of(body_source(ShapedBody{shape, {2, false}}));
    scene.initial.position_W = {0, 0, height};
    scene.loads = {Gravity{{0, 0, -contact_g}, {}}};
    scene.planes = {{{0, 0, 1}, 0, restitution, friction}};
    return scene;
}

/// A body at rest on a ramp at `angle` (rad) to the horizontal, in a frame in which the ramp is the plane z = 0:
/// gravity acts along (sin angle, 0, -cos angle), and x points down the ramp.
inline Scene on_ramp(const Shape& shape, double height, double angle, double friction) {
    Scene scene = on_floor(shape, height, 0, friction);
    scene.loads = {Gravity{{contact_g * std::sin(angle), 0, -contact_g * std::cos(angle)}, {}}};
    return scene;
}

/// A solid ball of radius 0.1 m on the floor with the velocity (u, 0, 0), not rotating. It slides until
/// t = 2 u / (7 mu g), then rolls with 5 u / 7 (J. A. Hopkins & J. D. Patterson 1977, Am. J. Phys. 45, 263).
inline Scene bowling_ball(double u, double friction) {
    Scene scene = on_floor(SolidSphere{0.1}, 0.1, 0, friction);
    scene.initial.velocity_W = {u, 0, 0};
    return scene;
}
inline double bowled_distance(double u, double friction, double t) {
    const double rolls = 2 * u / (7 * friction * contact_g), sliding = std::min(t, rolls);
    return u * sliding - friction * contact_g * sliding * sliding / 2 + 5 * u / 7 * (t - sliding);
}

}  // namespace polhode::testing
