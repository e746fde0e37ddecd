// The rigid body of the course by Baraff and Witkin: compared with its listing, convergence, invariants.
#include <gtest/gtest.h>

#include "integrators/game/game_scenes.h"
#include "motion/exact_body.h"

namespace polhode {
namespace {

using namespace polhode::testing;

/// The course's struct and ddt with explicit steps: Iinv = R Ibodyinv R^T, omega = Iinv L, v = P / mass, and the
/// matrix of the normalised quaternion.
TEST(BaraffWitkinEuler, IsTheListing) {
    const Scene scene = pulled(1);
    Vector3<double> x = scene.initial.position_W, P = scene.body.mass * scene.initial.velocity_W;
    Quaternion<double> q = scene.initial.orientation;
    const Matrix3<double> Ibody = scene.body.inertia_B;
    Vector3<double> L = rotate(q, Ibody * scene.initial.angular_velocity), omega, v;
    Matrix3<double> R;
    const auto auxiliary = [&] {
        R = rotation_matrix(normalized(q));
        omega = inverse(R * Ibody * transposed(R)) * L;
        v = (1 / scene.body.mass) * P;
    };
    const int n = 100;
    const double h = scene.duration / n;
    for (int i = 0; i < n; ++i) {
        auxiliary();
        Vector3<double> force, torque;
        for (const Load& load : scene.loads) {
            const Force& f = std::get<Force>(load);
            const bool in_body = f.point_frame == Frame::body;
            force = force + f.vector;
            torque = torque + cross(in_body ? R * (f.point - scene.body.center_of_mass) : f.point - x, f.vector);
        }
        const Quaternion<double> qdot = Quaternion<double>{0, omega[0], omega[1], omega[2]} * q;
        x = x + h * v;
        q = {q.w + h / 2 * qdot.w, q.x + h / 2 * qdot.x, q.y + h / 2 * qdot.y, q.z + h / 2 * qdot.z};
        P = P + h * force;
        L = L + h * torque;
    }
    auxiliary();
    const Sample end = with_step(scene, "baraff_witkin_euler", h).samples.back();
    EXPECT_LT(attitude_error(end.q, q), 1e-13);
    EXPECT_NEAR(squared_norm(end.q), squared_norm(q), 1e-13);
    EXPECT_LT(distance(rotate(normalized(end.q), end.angular_velocity_B), omega), 1e-13);
    EXPECT_LT(distance(end.position_W, x), 1e-13);
    EXPECT_LT(distance(end.velocity_W, v), 1e-13);
}

TEST(BaraffWitkin, ConvergesUnderEveryLoad) {
    expect_convergence(everything(2), "baraff_witkin_euler", 2e-4, 1, 0.02);
    expect_convergence(everything(2), "baraff_witkin_rk4", 2e-2, 4, 1e-4);
    expect_convergence(held(1), "baraff_witkin_euler", 1e-4, 1, 0.05);
    expect_convergence(held(1), "baraff_witkin_rk4", 1e-2, 4, 1e-4);
}

/// A sphere rotating about z: each explicit step scales |q| by sqrt(1 + h^2 w^2 / 4) and rotates q by 2 atan(h w / 2).
TEST(BaraffWitkinEuler, LengthensTheQuaternionAsItsStepSays) {
    Scene scene;
    scene.name = "ball", scene.duration = 10;
    scene.initial.angular_velocity = {0, 0, 2};
    const double h = 0.01;
    const Sample end = with_step(scene, "baraff_witkin_euler", h).samples.back();
    EXPECT_NEAR(squared_norm(end.q), std::pow(1 + h * h, 1000), 1e-12);
    const double half = 1000 * std::atan(h);
    EXPECT_LT(attitude_error(end.q, {std::cos(half), 0, 0, std::sin(half)}), 1e-12);
}

TEST(BaraffWitkin, KeepsBothMomentaOfAFreeBody) {
    Scene scene = free_body(10);
    scene.initial.velocity_W = {0.3, 0.2, -0.1};
    for (const char* method : {"baraff_witkin_rk4", "baraff_witkin_euler"})
        for (const Sample& s : with_step(scene, method, 0.01, 50).samples) {
            const Vector3<double> L = rotate(normalized(s.q), scene.body.inertia_B * s.angular_velocity_B);
            EXPECT_LT(distance(L, {1, 2, 3}), 1e-14) << method;
            EXPECT_EQ(s.velocity_W, scene.initial.velocity_W) << method;
        }
}

}  // namespace
}  // namespace polhode
