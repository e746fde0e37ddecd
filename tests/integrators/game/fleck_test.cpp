// Updates from the slides: compared with the slides' step, with the exact motion, and the drift of A^T A = 1.
#include <gtest/gtest.h>

#include "body/orientation.h"
#include "build_kind.h"
#include "integrators/game/game_scenes.h"
#include "motion/exact_body.h"

namespace polhode {
namespace {

using namespace polhode::testing;

constexpr std::array<const char*, 5> all{"fleck_matrix", "fleck_matrix_drifting", "fleck_quaternion",
                                         "accumulated_vertices", "fleck_resummed_inertia"};

/// The slides' code line by line, with the tensor rotated to world axes and inverted there.
TEST(FleckMatrix, IsTheSlidesStep) {
    const Scene scene = pulled(1);
    Matrix3<double> A = rotation_matrix(scene.initial.orientation);
    Vector3<double> x = scene.initial.position_W, v = scene.initial.velocity_W;
    Vector3<double> w = A * scene.initial.angular_velocity,
                    L = A * (scene.body.inertia_B * scene.initial.angular_velocity);
    const int n = 100;
    const double h = scene.duration / n;
    for (int i = 0; i < n; ++i) {
        Vector3<double> F, torque;
        for (const Load& load : scene.loads) {
            const Force& f = std::get<Force>(load);
            const bool in_body = f.point_frame == Frame::body;
            const Vector3<double> r = in_body ? A * (f.point - scene.body.center_of_mass) : f.point - x;
            F = F + f.vector, torque = torque + cross(r, f.vector);
        }
        x = x + h * v;
        Vector3<double> X, Y, Z;
        for (int k = 0; k < 3; ++k) X[k] = A[k][0], Y[k] = A[k][1], Z[k] = A[k][2];
        X = X + h * cross(w, X), Y = Y + h * cross(w, Y), Z = Z + h * cross(w, Z);
        v = v + (h / scene.body.mass) * F;
        L = L + h * torque;
        X = 1 / std::sqrt(dot(X, X)) * X;
        Z = cross(X, Y), Z = 1 / std::sqrt(dot(Z, Z)) * Z;
        Y = cross(Z, X), Y = 1 / std::sqrt(dot(Y, Y)) * Y;
        for (int k = 0; k < 3; ++k) A[k] = {X[k], Y[k], Z[k]};
        w = inverse(A * scene.body.inertia_B * transposed(A)) * L;
    }
    const Sample end = with_step(scene, "fleck_matrix", h).samples.back();
    // a few ulp per step
    EXPECT_LT(attitude_error(end.q, quaternion_from_matrix(A)), 1e-13);
    EXPECT_LT(distance(rotate(end.q, end.angular_velocity_B), w), 1e-13);
    EXPECT_LT(distance(end.position_W, x), 1e-13);
    EXPECT_LT(distance(end.velocity_W, v), 1e-13);
}

/// One step of the quaternion update: q + (h/2) (0, w) q, normalised.
TEST(FleckQuaternion, TurnsByTheFirstOrderUpdate) {
    Scene scene = free_body(0.125);
    scene.initial.orientation = {0.8, 0.6, 0, 0};
    scene.initial.angular_velocity_frame = Frame::world;
    const Sample end = with_step(scene, "fleck_quaternion", 0.125).samples.back();
    // (h/2) (0, 1, 1, 1) (0.8, 0.6, 0, 0) = 0.0625 (-0.6, 0.8, 1.4, 0.2)
    const Quaternion<double> expected = normalized(Quaternion<double>{0.7625, 0.65, 0.0875, 0.0125});
    EXPECT_LT(attitude_error(end.q, expected), 1e-15);
    EXPECT_NEAR(squared_norm(end.q), 1, 1e-15);
}

TEST(Fleck, ConvergesWithOrderOneUnderEveryLoad) {
    for (const char* method : all) expect_convergence(everything(2), method, 2e-4, 1, 0.02);
}

TEST(Fleck, ConvergesWithOrderOneOnAHeldBody) {
    for (const char* method : all) expect_convergence(held(1), method, 1e-4, 1, 0.05);
}

/// A rotating sphere keeps its w. Every step stretches A perpendicular to w by sqrt(1 + h^2 w^2): A^T A - 1 becomes
/// (1 + h^2 w^2)^n - 1 in this plane, and sqrt 2 times that in the Frobenius norm.
TEST(FleckMatrixDrifting, DriftsAsItsStepSays) {
    Scene scene;
    scene.name = "ball", scene.duration = 10;
    scene.initial.angular_velocity = {1, -2, 2};
    scene.initial.orientation = {0.8, 0, 0.6, 0};
    const double h = 1e-3;
    const Trajectory trajectory = with_step(scene, "fleck_matrix_drifting", h, 10);
    ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
    ASSERT_EQ(trajectory.orthogonality_defect.size(), 11U);
    for (int k = 1; k <= 10; ++k) {
        const double expected = std::sqrt(2.0) * (std::pow(1 + 9 * h * h, 1000 * k) - 1);
        EXPECT_NEAR(trajectory.orthogonality_defect[static_cast<std::size_t>(k)], expected, 1e-9 * expected);
    }
    // the reported attitude is still a rotation: atan(h w) per step
    const Sample& end = trajectory.samples.back();
    const double angle = 10000 * std::atan(3 * h), s = std::sin(angle / 2) / 3;
    const Quaternion<double> turned{std::cos(angle / 2), s, -2 * s, 2 * s};
    // rounding of 1e4 steps
    EXPECT_LT(attitude_error(end.q, scene.initial.orientation * turned), 1e-11);
    EXPECT_NEAR(squared_norm(end.q), 1, 1e-14);
}

TEST(FleckMatrix, StaysOrthogonalToRounding) {
    for (const char* method : {"fleck_matrix", "fleck_resummed_inertia"}) {
        const Trajectory trajectory = with_step(free_body(10), method, 1e-3, 100);
        ASSERT_EQ(trajectory.orthogonality_defect.size(), 101U);
        for (const double defect : trajectory.orthogonality_defect) EXPECT_LT(defect, 2e-15) << method;
    }
}

/// The defect of the drifting matrix increases with every sample and has order 1 in h. Except on a sphere it affects w.
TEST(FleckMatrixDrifting, DriftsByOrderOneOnATumblingBody) {
    const Trajectory coarse = with_step(free_body(10), "fleck_matrix_drifting", 1e-3, 20),
                     fine = with_step(free_body(10), "fleck_matrix_drifting", 5e-4, 20);
    ASSERT_EQ(coarse.orthogonality_defect.size(), 21U);
    for (std::size_t k = 1; k <= 20; ++k)
        EXPECT_GT(coarse.orthogonality_defect[k], coarse.orthogonality_defect[k - 1] + 1e-4);
    EXPECT_NEAR(std::log2(coarse.orthogonality_defect[20] / fine.orthogonality_defect[20]), 1, 0.1);
}

/// Rounding alone deforms the set of vertices, increasingly with every step.
TEST(AccumulatedVertices, DriftByRounding) {
    const long n = optimised_build ? 200000 : 20000;
    const Trajectory trajectory = with_step(free_body(1e-3 * static_cast<double>(n)), "accumulated_vertices", 1e-3, 2);
    ASSERT_EQ(trajectory.orthogonality_defect.size(), 3U);
    // more than the few ulp of one orthogonal matrix, less than two roundings per step in one direction
    EXPECT_GT(trajectory.orthogonality_defect[2], 1e-14);
    EXPECT_LT(trajectory.orthogonality_defect[2], 4.4e-16 * 3 * static_cast<double>(n));
}

TEST(FleckResummedInertia, IsTheMatrixUpdateButForRounding) {
    // a flat body has no extent along one axis
    Scene flat = free_body(3);
    flat.body.inertia_B = diagonal(Vector3<double>(1, 2, 3));
    for (const Scene& scene : {everything(3), held(3), pulled(3), flat}) {
        const Trajectory transformed = with_step(scene, "fleck_matrix", 1e-3, 10);
        const Trajectory summed = with_step(scene, "fleck_resummed_inertia", 1e-3, 10);
        ASSERT_EQ(transformed.status, Status::ok) << transformed.message;
        ASSERT_EQ(summed.samples.size(), 11U);
        for (std::size_t i = 0; i <= 10; ++i) {
            EXPECT_LT(attitude_error(summed.samples[i].q, transformed.samples[i].q), 1e-11) << scene.name;
            EXPECT_LT(distance(summed.samples[i].angular_velocity_B, transformed.samples[i].angular_velocity_B), 1e-10);
        }
    }
}

/// L is a state variable and does not change without a torque.
TEST(Fleck, KeepsTheMomentumOfAFreeBody) {
    const Scene scene = free_body(10);
    for (const char* method : {"fleck_matrix", "fleck_quaternion", "accumulated_vertices"})
        for (const Sample& s : with_step(scene, method, 0.01, 50).samples)
            EXPECT_LT(distance(rotate(s.q, scene.body.inertia_B * s.angular_velocity_B), {1, 2, 3}), 1e-14) << method;
}

/// Divergence is reported.
TEST(FleckMatrixDrifting, DivergesByName) {
    const Trajectory trajectory = with_step(free_body(1000), "fleck_matrix_drifting", 0.1, 10);
    EXPECT_EQ(trajectory.status, Status::diverged);
    EXPECT_FALSE(trajectory.message.empty());
}

}  // namespace
}  // namespace polhode
