// Errors of one body on trajectories made by hand, compared with values computed by hand.
#include "measure/errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "measure/scene_measure.h"

namespace polhode {
namespace {

Quaternion<double> about_x(double angle) { return {std::cos(angle / 2), std::sin(angle / 2), 0, 0}; }

Pair pair(double high) { return {high, 0}; }
Vector3<Pair> pair(const Vector3<double>& v) {
    Vector3<Pair> p{{}, {}, {}};
    for (int i = 0; i < 3; ++i) p[i] = pair(v[i]);
    return p;
}
Quaternion<Pair> pair(const Quaternion<double>& q) { return {pair(q.w), pair(q.x), pair(q.y), pair(q.z)}; }

Scene free_body() {
    Scene scene;
    scene.name = "free", scene.duration = 1;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 3));
    return scene;
}

// A reference with constant attitude and an angular velocity of 2 rad/s about x. It is not a motion: only the values
// that the error measures read matter.
Reference reference_at_rest(int samples) {
    Reference reference;
    reference.available = true;
    for (int k = 0; k <= samples; ++k) {
        ReferenceSample s;
        s.t = sample_time(1, k, samples);
        s.q = pair(Quaternion<double>{1, 0, 0, 0});
        s.angular_velocity_B = pair(Vector3<double>(2, 0, 0));
        s.angular_momentum_W = pair(Vector3<double>(2, 0, 0));
        s.position_W = s.velocity_W = pair(Vector3<double>());
        s.energy = pair(2);
        reference.samples.push_back(s);
    }
    return reference;
}

Trajectory trajectory_with(const Quaternion<double>& q, const Vector3<double>& w_B) {
    Trajectory trajectory;
    for (int k = 0; k <= 2; ++k) trajectory.samples.push_back({sample_time(1, k, 2), q, w_B, {}, {}});
    return trajectory;
}

TEST(AttitudeError, IsTheAngleOfRotation) {
    // sin and cos of the double angle are rounded: 2 ulp of 1
    for (double angle : {1e-12, 1e-6, 0.1, 1.0, 3.0, std::numbers::pi})
        EXPECT_NEAR(attitude_error(about_x(angle), pair(Quaternion<double>{1, 0, 0, 0})), angle, 5e-16);
}

TEST(AttitudeError, HasNoSignAndNoLength) {
    const Quaternion<double> q = about_x(0.25), twice{2 * q.w, 2 * q.x, 0, 0}, minus{-q.w, -q.x, 0, 0};
    const auto reference = pair(Quaternion<double>{1, 0, 0, 0});
    EXPECT_NEAR(attitude_error(twice, reference), 0.25, 1e-15);
    EXPECT_NEAR(attitude_error(minus, reference), 0.25, 1e-15);
    EXPECT_NEAR(attitude_error(q, pair(about_x(1))), 0.75, 1e-15);
}

TEST(AttitudeError, SeesTheLowPartOfTheTruth) {
    Quaternion<Pair> reference = pair(Quaternion<double>{1, 0, 0, 0});
    reference.x = {0, 1e-20};
    EXPECT_NEAR(attitude_error({1, 0, 0, 0}, reference), 2e-20, 1e-30);
}

TEST(Errors, MomentumIsComparedAsAVector) {
    // the energy and |L| are right but the attitude is rotated: the error shows in the vector L, not in E
    const Scene scene = free_body();
    const Reference reference = reference_at_rest(2);
    const Quaternion<double> q{std::cos(0.5), 0, std::sin(0.5), 0};  // 1 rad about y
    const Trajectory trajectory = trajectory_with(q, {2, 0, 0});
    const Errors e = errors(error_series(scene, trajectory, reference), trajectory, reference);
    EXPECT_NEAR(*e["attitude"].max, 1, 1e-15);
    EXPECT_NEAR(*e["momentum"].max, 2 * std::sin(0.5), 1e-15);  // chord of 1 rad
    EXPECT_NEAR(*e["energy"].max, 0, 1e-15);
    EXPECT_NEAR(*e["omega"].max, 0, 1e-15);
    EXPECT_NEAR(*e["norm"].max, 0, 2e-16);
}

TEST(Errors, AreRelativeToTheLargestOfTheRun) {
    const Scene scene = free_body();
    const Reference reference = reference_at_rest(2);
    const Trajectory trajectory = trajectory_with({1, 0, 0, 0}, {2, 0, 0.5});
    const Errors e = errors(error_series(scene, trajectory, reference), trajectory, reference);
    EXPECT_NEAR(*e["omega"].max, 0.25, 1e-15);
    EXPECT_NEAR(*e["momentum"].max, 3 * 0.5 / 2, 1e-15);
    EXPECT_NEAR(*e["energy"].max, 0.5 * 3 * 0.25 / 2, 1e-15);
}

TEST(Errors, AScaleOfZeroMakesThemAbsolute) {
    const Scene scene = free_body();
    Reference reference = reference_at_rest(2);
    for (ReferenceSample& s : reference.samples) {
        s.angular_velocity_B = s.angular_momentum_W = pair(Vector3<double>());
        s.energy = pair(0);
    }
    const Trajectory trajectory = trajectory_with({1, 0, 0, 0}, {1e-3, 0, 0});
    const Errors e = errors(error_series(scene, trajectory, reference), trajectory, reference);
    EXPECT_NEAR(*e["omega"].max, 1e-3, 1e-18);
    EXPECT_NEAR(*e["momentum"].max, 1e-3, 1e-18);
    EXPECT_NEAR(*e["energy"].max, 0.5e-6, 1e-21);
}

TEST(Errors, NormIsThatOfTheQuaternionOrOfTheMatrix) {
    Trajectory trajectory = trajectory_with({1 + 1e-10, 0, 0, 0}, {2, 0, 0});
    EXPECT_NEAR(error_series(free_body(), trajectory, {})["norm"][1], 1e-10, 1e-15);
    trajectory.orthogonality_defect = {0, 1e-5, 2e-5};
    EXPECT_EQ(error_series(free_body(), trajectory, {})["norm"], trajectory.orthogonality_defect);
}

TEST(Errors, WithoutTruthOnlyTheNormRemains) {
    const Scene scene = free_body();
    const Trajectory trajectory = trajectory_with({1, 0, 0, 0}, {2, 0, 0});
    const Errors e = errors(error_series(scene, trajectory, {}), trajectory, {});
    EXPECT_FALSE(e["attitude"].final || e["attitude"].max || e["omega"].max || e["energy"].max || e["momentum"].max);
    EXPECT_TRUE(e["norm"].max);
}

TEST(Errors, ARunThatDidNotReachTheEndHasNone) {
    const Scene scene = free_body();
    const Reference reference = reference_at_rest(2);
    Trajectory trajectory = trajectory_with({1, 0, 0, 0}, {2, 0, 0});
    trajectory.samples.pop_back();
    trajectory.status = Status::diverged;
    const ErrorSeries series = error_series(scene, trajectory, reference);
    EXPECT_EQ(series["attitude"].size(), 2U);
    const Errors e = errors(series, trajectory, reference);
    EXPECT_FALSE(e["attitude"].final || e["attitude"].max || e["norm"].max);
}

TEST(Errors, RefusesOtherSampleTimes) {
    const Scene scene = free_body();
    Trajectory trajectory = trajectory_with({1, 0, 0, 0}, {2, 0, 0});
    trajectory.samples[1].t += 1e-9;
    EXPECT_THROW(error_series(scene, trajectory, reference_at_rest(2)), std::invalid_argument);
}

TEST(Errors, GoAsFarAsTheTruthDoes) {
    const Scene scene = free_body();
    Reference reference = reference_at_rest(2);
    reference.samples.pop_back();
    const Trajectory trajectory = trajectory_with({1, 0, 0, 0}, {2, 0, 0});
    const ErrorSeries series = error_series(scene, trajectory, reference);
    EXPECT_EQ(series["attitude"], (std::vector<double>{0, 0}));
    EXPECT_EQ(series["norm"].size(), 3U);
    EXPECT_EQ(series.t.size(), 3U);
    Trajectory shorter = trajectory_with({1, 0, 0, 0}, {2, 0, 0});
    shorter.samples.pop_back();
    const Reference whole = reference_at_rest(2);
    const Errors e = errors(error_series(scene, shorter, whole), shorter, whole);
    EXPECT_FALSE(e["attitude"].final || e["omega"].max);
    EXPECT_TRUE(e["norm"].max);
}

TEST(Errors, AreRelativeToTheLargestEvenWhereTheTruthEndsAtRest) {
    const Scene scene = free_body();
    Reference reference = reference_at_rest(2);
    reference.samples[2].angular_velocity_B = reference.samples[2].angular_momentum_W = pair(Vector3<double>());
    reference.samples[2].energy = pair(0);
    Trajectory trajectory = trajectory_with({1, 0, 0, 0}, {2, 0, 0});
    trajectory.samples[2].angular_velocity_B = {0.5, 0, 0};
    const Errors e = errors(error_series(scene, trajectory, reference), trajectory, reference);
    EXPECT_NEAR(*e["omega"].max, 0.25, 1e-15);
    EXPECT_NEAR(*e["momentum"].final, 0.25, 1e-15);
    EXPECT_NEAR(*e["energy"].final, 0.125 / 2, 1e-15);
}

TEST(Errors, AtTheEndAndAtTheirLargestAreTwoThings) {
    const Scene scene = free_body();
    const Reference reference = reference_at_rest(2);
    Trajectory trajectory = trajectory_with({1, 0, 0, 0}, {2, 0, 0});
    trajectory.samples[1].q = about_x(0.5), trajectory.samples[2].q = about_x(0.25);
    trajectory.samples[1].position_W = {0, 3, 4}, trajectory.samples[1].velocity_W = {0, 0.5, 0};
    const Errors e = errors(error_series(scene, trajectory, reference), trajectory, reference);
    EXPECT_NEAR(*e["attitude"].max, 0.5, 1e-15);
    EXPECT_NEAR(*e["attitude"].final, 0.25, 1e-15);
    EXPECT_EQ(*e["position"].max, 5);
    EXPECT_EQ(*e["velocity"].max, 0.5);
    EXPECT_EQ(*e["position"].final, 0);
}

TEST(Errors, AQuaternionOfAnyLengthHasTheMomentumOfItsAttitude) {
    const Scene scene = free_body();
    const Reference reference = reference_at_rest(2);
    const Trajectory trajectory = trajectory_with({2, 0, 0, 0}, {2, 0, 0});
    const Errors e = errors(error_series(scene, trajectory, reference), trajectory, reference);
    EXPECT_EQ(*e["momentum"].max, 0);
    EXPECT_EQ(*e["norm"].max, 1);
}

TEST(Errors, AMaximumThatOverflowsDoesNotExist) {
    const Scene scene = free_body();
    const Reference reference = reference_at_rest(2);
    Trajectory trajectory = trajectory_with({1, 0, 0, 0}, {2, 0, 0});
    trajectory.samples[1].velocity_W = {std::numeric_limits<double>::infinity(), 0, 0};
    const Errors e = errors(error_series(scene, trajectory, reference), trajectory, reference);
    EXPECT_FALSE(e["velocity"].max);
    EXPECT_EQ(*e["velocity"].final, 0);
}

TEST(Errors, WhatIsNotANumberHasNoMaximum) {
    const Scene scene = free_body();
    const Reference reference = reference_at_rest(2);
    for (std::size_t k = 0; k < 3; ++k) {
        Trajectory trajectory = trajectory_with({1, 0, 0, 0}, {2, 0, 0});
        trajectory.samples[k].position_W = {0, std::numeric_limits<double>::quiet_NaN(), 0};
        const ErrorSeries series = error_series(scene, trajectory, reference);
        EXPECT_TRUE(std::isnan(series["position"][k])) << k;
        EXPECT_FALSE(errors(series, trajectory, reference)["position"].max) << k;
    }
}

// The kinetic energy of the reference: m v^2 / 2 is included in flight; on a pivot it is I w^2 / 2 about the pivot.
TEST(SceneMeasure, HasTheKineticEnergyOfFlightOnlyWhereItFlies) {
    Scene scene = free_body();
    scene.body.mass = 2;
    ReferenceSample sample = reference_at_rest(1).samples[0];
    sample.velocity_W = pair(Vector3<double>(0, 3, 0)), sample.angular_velocity_B = pair(Vector3<double>(0, 2, 0));
    sample.q.x = {0, 0x1p-80};
    const auto kinetic = [&] {
        JointCoordinates coordinates(scene);
        const BodyMotion<double> motion = true_motion<double>(sample);
        return SceneMeasure<double>(scene).true_invariants({&sample, 1}, {&motion, 1}, coordinates).kinetic;
    };
    EXPECT_EQ(kinetic(), 4 + 9);
    EXPECT_EQ(true_motion<Wide>(sample).q.x, Wide(0x1p-80));
    scene.pivot = Vector3<double>();
    EXPECT_EQ(kinetic(), 4);
}

}  // namespace
}  // namespace polhode
