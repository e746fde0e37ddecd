// Euler angles as state: the motion away from gimbal lock and near it.
#include "integrators/game/euler_angles.h"

#include <gtest/gtest.h>

#include <numbers>

#include "body/orientation.h"
#include "integrators/game/game_scenes.h"

namespace polhode {
namespace {

using namespace polhode::testing;

constexpr double pi = std::numbers::pi;

/// A sphere rotating at 1 rad/s about its y axis, which is tilted by `distance` out of the horizontal plane. Its x
/// axis rises to 90 degrees minus this distance at t = pi/2; the duration is pi.
Scene passing(double distance) {
    Scene scene;
    scene.name = "passing", scene.duration = pi;
    scene.initial.orientation = quaternion_from_euler(EulerSequence::zyx, {0, 0, distance});
    scene.initial.angular_velocity = {0, 1, 0};
    return scene;
}
Quaternion<double> passed(double distance) {
    return quaternion_from_euler(EulerSequence::zyx, {0, 0, distance}) * quaternion_from_axis_angle({{0, 1, 0}, pi});
}

TEST(EulerAngles, ConvergeWithOrderOneUnderEveryLoad) {
    expect_convergence(everything_level(0.8), "euler_angles", 1e-4, 1, 0.02);
    expect_convergence(held(0.5), "euler_angles", 1e-4, 1, 0.05);
}

TEST(EulerAnglesCvode, KeepToTheToleranceAwayFromLock) {
    for (const Scene& scene : {everything_level(0.8), held(0.5)}) {
        const Sample truth = with_tolerance(scene, "odeint_fehlberg78", 1e-13).samples.back();
        for (const double tolerance : {1e-6, 1e-9}) {
            const Trajectory trajectory = with_tolerance(scene, "euler_angles_cvode", tolerance);
            ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
            EXPECT_LT(attitude_error(trajectory.samples.back().q, truth.q), 100 * tolerance) << scene.name;
        }
    }
}

/// Roll and yaw change by pi within a time of about d: CVODE follows with steps proportional to d and succeeds.
TEST(EulerAnglesCvode, PassLockWithStepsLikeTheDistance) {
    for (const double d : {1e-2, 1e-4, 1e-6}) {
        LockPassage passage;
        Settings settings;
        settings.tolerance = 1e-8, settings.samples = 1;
        const Trajectory trajectory = solve_euler_angles_cvode(pose(passing(d), Formulation::full), settings, &passage);
        ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
        EXPECT_NEAR(passage.nearest / d, 1, 0.2);
        EXPECT_GT(passage.largest_angle_rate, 0.8 / d);
        EXPECT_LT(passage.largest_angle_rate, 1.01 / d);
        EXPECT_LT(passage.smallest_step, d);
        EXPECT_GT(passage.smallest_step, 1e-3 * d);
        EXPECT_LT(attitude_error(trajectory.samples.back().q, passed(d)), 1e-5) << d;

        // quaternions need no short steps for the same motion
        LockPassage none;
        const Trajectory quaternion = solve_quaternion_cvode(pose(passing(d), Formulation::full), settings, &none);
        ASSERT_EQ(quaternion.status, Status::ok) << quaternion.message;
        EXPECT_GT(none.smallest_step, 1e-3);
        EXPECT_LT(10 * quaternion.steps, 9 * trajectory.steps);
    }
}

/// Fixed steps much shorter than the passage follow it. Longer steps end with a failure at the first step that would
/// change an angle by more than pi.
TEST(EulerAngles, FailByNameWhereAStepIsTooLongForTheLock) {
    const double h = pi / 2e4;
    const Trajectory far = with_step(passing(0.1), "euler_angles", h);
    ASSERT_EQ(far.status, Status::ok) << far.message;
    EXPECT_LT(attitude_error(far.samples.back().q, passed(0.1)), 0.01);
    // at d = h/100 the pitch comes within h of a right angle, where roll changes by about 100 rad per step
    const Trajectory near = with_step(passing(h / 100), "euler_angles", h);
    EXPECT_EQ(near.status, Status::failed);
    EXPECT_NE(near.message.find("from gimbal lock"), std::string::npos) << near.message;
}

/// At gimbal lock the rates do not exist: both methods fail early.
TEST(EulerAngles, StartingInLockIsANamedFailure) {
    const Scene scene = everything(1);  // pitch of 90 degrees
    const Trajectory fixed = with_step(scene, "euler_angles", 1e-3);
    EXPECT_EQ(fixed.status, Status::failed);
    EXPECT_NE(fixed.message.find("from gimbal lock"), std::string::npos) << fixed.message;
    Settings settings;
    settings.tolerance = 1e-8, settings.samples = 1, settings.max_steps = 100000;
    const Trajectory adaptive = solve(scene, *find_method("euler_angles_cvode"), settings);
    EXPECT_NE(adaptive.status, Status::ok);
    EXPECT_NE(adaptive.message.find("gimbal lock"), std::string::npos) << adaptive.message;
}

}  // namespace
}  // namespace polhode
