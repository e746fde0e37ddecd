// `extrapolation` and `dop853` against closed forms, the truth, and other code paths of the same methods.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "build_kind.h"
#include "integrators/scenes.h"

namespace polhode {
namespace {

using namespace polhode::testing;

double worst_error(const Trajectory& trajectory, const Trajectory& reference) {
    double worst = 0;
    EXPECT_EQ(trajectory.status, Status::ok) << trajectory.message;
    EXPECT_EQ(trajectory.samples.size(), reference.samples.size());
    for (std::size_t i = 0; i < std::min(trajectory.samples.size(), reference.samples.size()); ++i)
        worst = std::max(worst, attitude_error(trajectory.samples[i].q, reference.samples[i].q));
    return worst;
}
Trajectory exact(const Scene& scene, long samples) {
    Settings settings;
    settings.samples = samples;
    return solve(scene, *find_method("exact"), settings);
}

class OwnTolerance : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, OwnTolerance, ::testing::Values("extrapolation", "dop853"),
                         [](const auto& of) { return std::string(of.param); });

TEST_P(OwnTolerance, GovernsTheError) {
    for (const Scene& scene : {free_body(30), heavy_top(5)}) {
        const Trajectory reference = exact(scene, 10);
        for (double R : {1e-4, 1e-6, 1e-8, 1e-10, 1e-12})
            // measured at most 200 R: each step errs by up to R per component, accumulated over up to 100 rad
            EXPECT_LT(worst_error(with_tolerance(scene, GetParam(), R, 10), reference), 2000 * R) << scene.name << R;
    }
}

TEST_P(OwnTolerance, NearTheRoundingLeavesLittleElse) {
    const Scene scene = free_body(100);
    // measured 3e-14, in part from `exact`; dop853 5e-13, its truncation error at 1e-14
    const double most = std::string(GetParam()) == "dop853" ? 2e-12 : 1e-13;
    for (double R : {1e-14, 1e-15})
        EXPECT_LT(worst_error(with_tolerance(scene, GetParam(), R, 10), exact(scene, 10)), most) << R;
}

TEST_P(OwnTolerance, FollowsTheTruthUnderLoads) {
    Scene pivoted = heavy_top(3);
    pivoted.body.inertia_B = diagonal(Vector3<double>(0.75, 0.9, 0.5));
    pivoted.body.center_of_mass = {0.1, -0.2, 0.5};
    pivoted.initial.angular_velocity = {0.3, -0.4, 5};
    pivoted.loads.push_back(Torque{{0.3, -0.2, 0.1}, Frame::body, {0.5, 2}});
    pivoted.loads.push_back(Torque{{-0.1, 0.2, 0.4}, Frame::world, {}});
    pivoted.loads.push_back(Drag{{0.2, 0.3, 0.1}, 0, {}});
    pivoted.loads.push_back(Spring{1.3, {0.8, 0.6, 0, 0}, {}});
    pivoted.loads.push_back(Impulse{{0.5, -0.4, 0.3}, Frame::world, {0.3, 0.2, 0.1}, Frame::body, 1.25});
    for (const Scene& scene : {pivoted, everything(1)}) {
        Settings settings;
        settings.samples = 4;
        const Trajectory truth = solve(scene, *find_method("truth"), settings);
        EXPECT_LT(worst_error(with_tolerance(scene, GetParam(), 1e-12, 4), truth), 1e-10) << scene.name;
        EXPECT_LT(worst_error(with_tolerance(scene, GetParam(), 1e-14, 4), truth), 1e-12) << scene.name;
    }
}

/// Gravity about the pivot as a user-defined torque r x R^T F: the general code path against the vectorised one.
TEST_P(OwnTolerance, TakesAUsersTorque) {
    const Scene scene = heavy_top(3);
    Scene user = scene;
    user.loads = {UserTorque{"gravity",
                             [](const LoadState& s) {
                                 const Vector3<double> weight_B = rotate_back(s.q, Vector3<double>(0, 0, -9.80665));
                                 return (1 / squared_norm(s.q)) * cross(Vector3<double>(0, 0, 0.5), weight_B);
                             },
                             {}}};
    EXPECT_LT(worst_error(with_tolerance(user, GetParam(), 1e-12, 5), exact(scene, 5)), 1e-10);
}

TEST_P(OwnTolerance, StepsDoNotDependOnTheSamples) {
    for (const Scene& scene : {heavy_top(2), everything(1)}) {
        const Trajectory sparse = with_tolerance(scene, GetParam(), 1e-9, 1);
        const Trajectory dense = with_tolerance(scene, GetParam(), 1e-9, 1000);
        EXPECT_EQ(sparse.samples.back().q, dense.samples.back().q);
        EXPECT_EQ(sparse.steps, dense.steps);
        EXPECT_LT(worst_error(with_tolerance(scene, GetParam(), 1e-9, 50),
                              with_tolerance(scene, "odeint_fehlberg78", 1e-12, 50)),
                  1e-6);
    }
}

TEST_P(OwnTolerance, EndsInAResultOrANamedStatus) {
    Scene stiff = heavy_top(0.05);
    stiff.loads.push_back(Drag{{1000, 1000, 1000}, 0, {}});
    Scene resting = free_body(10);
    resting.initial.angular_velocity = {0, 0, 0};
    Scene quick = free_body(1e-6);
    quick.initial.angular_velocity = {1e8, 1e8, 1e8};
    Scene slow = free_body(1e12);
    slow.initial.angular_velocity = {1e-180, 1e-180, 1e-180};
    for (const Scene& scene : {stiff, resting, quick, slow, everything(0.5)})
        for (const double R : {1e-3, 1e-9, 1e-13, 1e-15, 2.3e-16, 1e-16, 1e-100, 1e-300, 5e-324}) {
            const Trajectory trajectory = with_tolerance(scene, GetParam(), R, 3);
            if (trajectory.status == Status::ok) {
                ASSERT_EQ(trajectory.samples.size(), 4U);
                for (const Sample& sample : trajectory.samples) ASSERT_TRUE(std::isfinite(sample.q.w + sample.q.x));
                EXPECT_GE(R, 0x1p-52);
            } else {
                EXPECT_EQ(trajectory.status, Status::tolerance_not_met) << trajectory.message;
                EXPECT_FALSE(trajectory.message.empty());
            }
        }
}

TEST_P(OwnTolerance, SaysWhenATorqueIsNoNumber) {
    Scene scene = free_body(10);
    scene.loads = {
        UserTorque{"breaks", [](const LoadState& s) { return Vector3<double>(std::sqrt(1 - s.t), 0, 0); }, {}}};
    const Trajectory trajectory = with_tolerance(scene, GetParam(), 1e-6, 10);
    EXPECT_EQ(trajectory.status, Status::diverged);
    EXPECT_FALSE(trajectory.message.empty());
}

/// In a long run the energy drifts by a random walk of round-off, not faster.
TEST(Extrapolation, KeepsEnergyForLong) {
    const double T = optimised_build ? 1e4 : 500;
    const Trajectory trajectory = with_tolerance(free_body(T), "extrapolation", 1e-14, 5);
    ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
    for (const Sample& sample : trajectory.samples) {
        const Vector3<double>& w = sample.angular_velocity_B;
        const double twice_energy = w[0] * w[0] + 2 * w[1] * w[1] + 3 * w[2] * w[2];
        EXPECT_NEAR(twice_energy, 6, 6 * 2e-14);  // measured 4e-15
    }
    EXPECT_LT(worst_error(trajectory, exact(free_body(T), 5)), 1e-10);  // measured 2e-11
}

}  // namespace
}  // namespace polhode
