// Scenes and closed forms shared by the integrators' tests.
#pragma once

#include <cmath>
#include <numbers>

#include "integrators/method.h"
#include "scene/scene.h"

namespace polhode::testing {

/// The attitude error as defined in the contract: the rotation angle between the two, in rad.
inline double attitude_error(const Quaternion<double>& q, const Quaternion<double>& reference) {
    const Quaternion<double> d = conjugate(reference) * q;
    return 2 * std::atan2(std::sqrt(dot(vector_part(d), vector_part(d))), std::abs(d.w));
}

/// A free body, omega = (1, 1, 1), I = (1, 2, 3).
inline Scene free_body(double duration) {
    Scene scene;
    scene.name = "free body", scene.duration = duration;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 3));
    scene.initial.angular_velocity = {1, 1, 1};
    return scene;
}

/// A free symmetric body, I = (I1, I1, I3), started at the identity.
inline Scene symmetric_body(double duration) {
    Scene scene;
    scene.name = "symmetric body", scene.duration = duration;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 1, 1.75));
    scene.initial.angular_velocity = {0.9, 0.4, 1.1};
    return scene;
}

/// The attitude of symmetric_body() in closed form (Landau & Lifshitz 1976, section 33): a rotation about L by the
/// angle |L| t / I1 after a rotation about the symmetry axis by (1 - I3/I1) w3 t.
inline Quaternion<double> symmetric_attitude(const Scene& scene, double t) {
    const double I1 = scene.body.inertia_B[0][0], I3 = scene.body.inertia_B[2][2];
    const Vector3<double>& w = scene.initial.angular_velocity;
    const Vector3<double> L(I1 * w[0], I1 * w[1], I3 * w[2]);
    const double length = std::sqrt(dot(L, L)), half = length * t / I1 / 2, spin = (1 - I3 / I1) * w[2] * t / 2;
    const double s = std::sin(half) / length;
    return Quaternion<double>{std::cos(half), s * L[0], s * L[1], s * L[2]} *
           Quaternion<double>{std::cos(spin), 0, 0, std::sin(spin)};
}

/// Lagrange's top: a symmetric body with a fixed point, under gravity.
inline Scene heavy_top(double duration) {
    Scene scene;
    scene.name = "heavy top", scene.duration = duration;
    scene.body.inertia_B = diagonal(Vector3<double>(0.75, 0.75, 0.5));
    scene.body.center_of_mass = {0, 0, 0.5};
    scene.pivot = Vector3<double>(0, 0, 0);
    scene.initial.orientation = {0.9689124217106447, 0.24740395925452294, 0, 0};
    scene.initial.angular_velocity = {0, 0, 20};
    scene.loads = {Gravity{{0, 0, -9.80665}, {}}};
    return scene;
}

/// A body in flight with an offset centre of mass, a full tensor, every load of a scene file, windows and impulses.
inline Scene everything(double duration) {
    Scene scene;
    scene.name = "everything", scene.duration = duration;
    scene.body.mass = 2.5;
    scene.body.inertia_B = {
        {Vector3<double>(1.1, 0.1, -0.05), Vector3<double>(0.1, 1.7, 0.2), Vector3<double>(-0.05, 0.2, 2.2)}};
    scene.body.center_of_mass = {0.1, -0.2, 0.3};
    scene.initial.orientation = {0.5, -0.5, 0.5, 0.5};
    scene.initial.angular_velocity = {1.2, -0.7, 0.9};
    scene.initial.position_W = {0.3, 0.1, -0.4};
    scene.initial.velocity_W = {-0.2, 0.5, 0.6};
    const double a = 0.31 * duration, b = 0.5 * duration, c = 0.73 * duration;
    scene.loads = {Gravity{{0.1, 0.2, -1.5}, {}},
                   Torque{{0.3, -0.2, 0.1}, Frame::body, {a, c}},
                   Torque{{-0.1, 0.2, 0.4}, Frame::world, {}},
                   Force{{0.4, 0.3, -0.2}, Frame::world, {0.5, 0.1, -0.3}, Frame::body, {}},
                   Force{{-0.3, 0.2, 0.5}, Frame::body, {0.2, 0.4, 0.1}, Frame::body, {}},
                   Force{{0.2, -0.1, 0.3}, Frame::world, {0.7, -0.6, 0.2}, Frame::world, {b, duration}},
                   Force{{0.1, 0.2, -0.3}, Frame::body, {-0.4, 0.3, 0.6}, Frame::world, {}},
                   Impulse{{0.5, -0.4, 0.3}, Frame::world, {0.3, 0.2, 0.1}, Frame::body, b},
                   Impulse{{-0.2, 0.3, 0.4}, Frame::body, {0.4, -0.3, 0.5}, Frame::world, c},
                   Drag{{0.2, 0.3, 0.1}, 0.4, {}},
                   Spring{1.3, {0.8, 0.6, 0, 0}, {}}};
    return scene;
}

/// Solves the scene by the named method with a fixed step or a tolerance. The test fails if the method does not exist.
inline Trajectory with_step(const Scene& scene, const char* method, double step, long samples = 1) {
    Settings settings;
    settings.step = step, settings.samples = samples;
    return solve(scene, *find_method(method), settings);
}
inline Trajectory with_tolerance(const Scene& scene, const char* method, double tolerance, long samples = 1) {
    Settings settings;
    settings.tolerance = tolerance, settings.samples = samples;
    return solve(scene, *find_method(method), settings);
}

}  // namespace polhode::testing
