// Adds a torque that scene files do not support.
#include <cmath>

#include "expect.h"
#include "own_method.h"
#include "parts.h"
#include "scene_in_code.h"

using namespace polhode;

void add_a_torque() {
    // about a principal axis: I w' = a sin(b t), so w = w0 + a/(b I) (1 - cos b t), and the angle is its integral
    constexpr double a = 0.75, b = 2, w0 = 0.25;
    Scene scene = symmetric_body();
    scene.initial.angular_velocity = {0, 0, w0};
    scene.loads.push_back(
        UserTorque{.name = "motor",
                   .torque_B = [=](const LoadState& state) { return Vector3<double>(0, 0, a * std::sin(b * state.t)); },
                   .window = {}});
    Settings settings;
    settings.step = 1e-3;
    const Trajectory trajectory = solve(scene, heun, settings);
    expect_ok("user-defined torque", trajectory);
    const Sample& end = trajectory.samples.back();
    const double w = w0 + a / (b * moment_C) * (1 - std::cos(b * duration));
    const double angle = w0 * duration + a / (b * moment_C) * (duration - std::sin(b * duration) / b);
    // the trapezoidal rule's error: T h^2 / 12 max |w''| = 10 * 1e-6 / 12 * a b / C = 4.2e-7 for w, and for the angle
    // at most T times that, plus as much again from |q| and w held linear inside a step
    expect_below("user-defined torque: rate", std::fabs(end.angular_velocity_B[2] - w), 4.2e-7);
    expect_below("user-defined torque: angle", angle_between(rotation(Vector3<double>(0, 0, 1), angle), end.q), 8.4e-6);
}
