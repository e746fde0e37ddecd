// Points with constant distances by position-based dynamics: effect of sweeps and steps. For the order: order_test.cpp.
#include <gtest/gtest.h>

#include "integrators/points/point_runs.h"
#include "integrators/scenes.h"
#include "motion/moderate_scene.h"

namespace polhode {
namespace {

using namespace polhode::testing;

PointRun run_with(const Scene& scene, double step, int iterations) {
    Settings settings;
    settings.step = step, settings.samples = 10;
    PointOptions options;
    options.iterations = iterations;
    return point_xpbd(pose(scene), settings, options);
}

TEST(PointXpbd, ConvergesWithOrderOneUnderEveryLoad) {
    const Scene scene = everything(1);
    const Sample truth = with_tolerance(scene, "odeint_fehlberg78", 1e-12).samples.back();
    std::array<std::array<double, 4>, 2> errors{};
    for (int i = 0; i < 2; ++i) {
        const PointRun run = run_with(scene, 1e-3 / (1 << i), 10);
        ASSERT_EQ(run.trajectory.status, Status::ok) << run.trajectory.message;
        const Sample& end = run.trajectory.samples.back();
        errors[i] = {attitude_error(end.q, truth.q), distance(end.angular_velocity_B, truth.angular_velocity_B),
                     distance(end.position_W, truth.position_W), distance(end.velocity_W, truth.velocity_W)};
    }
    for (int part = 0; part < 4; ++part) {
        EXPECT_LT(errors[0][part], 0.02) << part;
        EXPECT_NEAR(std::log2(errors[0][part] / errors[1][part]), 1, 0.15) << part;
    }
}

/// Rounding can place the start of a load next to the end of a step, 10^-17 s before it. The velocity must not change.
TEST(PointXpbd, StandsAStepCutByRounding) {
    Scene scene = symmetric_body(1);
    scene.initial.velocity_W = {1, 2, 3};
    const Sample plain = run_with(scene, 0.01, 10).trajectory.samples.back();
    for (const double begin : {std::nextafter(0.3, 0.0), std::nextafter(0.3, 1.0), 0.1 + 0.2, 0.7}) {
        scene.loads = {Torque{{1e-12, 0, 0}, Frame::world, {begin, 2}}};
        const PointRun run = run_with(scene, 0.01, 10);
        ASSERT_EQ(run.trajectory.status, Status::ok) << run.trajectory.message;
        EXPECT_LT(distance(run.trajectory.samples.back().velocity_W, plain.velocity_W), 1e-9) << begin;
    }
}

/// The remaining error of the distances decreases with the number of sweeps and with the square of the step.
TEST(PointXpbd, HoldsTheDistancesByItsSweeps) {
    const Scene scene = symmetric_body(2);
    const double one = run_with(scene, 0.01, 1).largest_stretch, ten = run_with(scene, 0.01, 10).largest_stretch;
    EXPECT_LT(ten, one / 10);
    EXPECT_NEAR(std::log2(one / run_with(scene, 0.005, 1).largest_stretch), 2, 0.4);
}

/// The method damps: it loses more rotational energy at longer steps. Momentum is conserved.
TEST(PointXpbd, LosesEnergyButNotMomentum) {
    Scene scene = symmetric_body(2);
    scene.initial.velocity_W = {0.1, 0.2, -0.3};
    const auto energy = [&](const Sample& s) {
        return dot(s.angular_velocity_B, scene.body.inertia_B * s.angular_velocity_B) / 2;
    };
    double lost[2];
    for (int i = 0; i < 2; ++i) {
        const Trajectory t = run_with(scene, 0.01 / (1 << i), 10).trajectory;
        ASSERT_EQ(t.status, Status::ok);
        for (std::size_t k = 1; k < t.samples.size(); ++k) EXPECT_LT(energy(t.samples[k]), energy(t.samples[k - 1]));
        lost[i] = energy(t.samples.front()) - energy(t.samples.back());
        EXPECT_LT(distance(t.samples.back().velocity_W, scene.initial.velocity_W), 1e-11);
    }
    EXPECT_GT(lost[1], 0);
    EXPECT_NEAR(std::log2(lost[0] / lost[1]), 1, 0.15);
}

TEST(PointXpbd, RefusesWhatHasNoPoints) {
    Scene scene = free_body(1);  // flat
    scene.initial.position_W = scene.initial.velocity_W = {};
    scene.pivot = Vector3<double>(0, 0, 1);
    const Trajectory t = with_step(scene, "point_xpbd", 0.01);
    EXPECT_EQ(t.status, Status::unsupported);
    EXPECT_NE(t.message.find("flat"), std::string::npos);
}

}  // namespace
}  // namespace polhode
