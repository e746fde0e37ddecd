// Scenes shared by the tests of the game updates.
#pragma once

#include <array>
#include <cmath>
#include <string>

#include "integrators/scenes.h"

namespace polhode::testing {

inline double distance(const Vector3<double>& a, const Vector3<double>& b) { return std::sqrt(dot(a - b, a - b)); }

/// Two forces, at a body point and at a world point, on a body with an offset centre of mass.
inline Scene pulled(double duration) {
    Scene scene = everything(duration);
    scene.loads = {Force{{0.4, 0.3, -0.2}, Frame::world, {0.5, 0.1, -0.3}, Frame::body, {}},
                   Force{{0.1, 0.2, -0.3}, Frame::world, {-0.4, 0.3, 0.6}, Frame::world, {}}};
    return scene;
}

/// Every load of a scene file, with an initial pitch of 10 degrees.
inline Scene everything_level(double duration) {
    Scene scene = everything(duration);
    scene.initial.orientation = {0.9, 0.3, 0.25, 0.19364916731037085};
    return scene;
}

/// A body with a pivot other than its origin, with gravity, drag, a force, an impulse and a user-defined torque.
inline Scene held(double duration) {
    Scene scene = heavy_top(duration);
    scene.initial.orientation = {0.8, 0.36, 0, 0.48};
    scene.initial.angular_velocity = {0.3, -0.2, 4};
    scene.pivot = Vector3<double>(0.1, -0.05, 0.1);
    UserTorque swirl;
    swirl.torque_B = [](const LoadState& s) { return Vector3<double>(std::sin(s.t), s.q.x, -s.angular_velocity_B[2]); };
    scene.loads = {scene.loads.front(), Drag{{0.1, 0.2, 0.3}, 0.5, {}},
                   Force{{1, 2, 0}, Frame::body, {0.1, 0.2, 0.4}, Frame::body, {}},
                   Impulse{{0.5, 0, 0.2}, Frame::world, {0.1, 0, 0.6}, Frame::body, 0.5 * duration}, swirl};
    return scene;
}

/// The errors of attitude, w, p and v at the end.
inline std::array<double, 4> end_errors(const Scene& scene, const char* method, double step, const Sample& truth) {
    const Trajectory trajectory = with_step(scene, method, step);
    EXPECT_EQ(trajectory.status, Status::ok) << method << ": " << trajectory.message;
    if (trajectory.samples.empty()) return {};
    const Sample& end = trajectory.samples.back();
    return {attitude_error(end.q, truth.q), distance(end.angular_velocity_B, truth.angular_velocity_B),
            distance(end.position_W, truth.position_W), distance(end.velocity_W, truth.velocity_W)};
}

/// Checks that all parts of the error shrink by 2^order when the step is halved.
inline void expect_convergence(const Scene& scene, const char* method, double step, int order, double most) {
    const Sample truth = with_tolerance(scene, "odeint_fehlberg78", 1e-13).samples.back();
    const std::array<double, 4> coarse = end_errors(scene, method, step, truth),
                                fine = end_errors(scene, method, step / 2, truth);
    for (std::size_t part = 0; part < 4; ++part) {
        EXPECT_LT(coarse[part], most) << method << " on " << scene.name << ", part " << part;
        EXPECT_NEAR(std::log2(coarse[part] / fine[part]), order, 0.15)
            << method << " on " << scene.name << ", part " << part;
    }
}

}  // namespace polhode::testing
