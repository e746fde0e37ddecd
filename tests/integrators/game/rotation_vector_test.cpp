#include <gtest/gtest.h>

#include "integrators/game/game_scenes.h"

namespace polhode {
namespace {

using namespace polhode::testing;

TEST(RotationVector, ConvergesWithOrderFourUnderEveryLoad) {
    expect_convergence(everything(2), "rotation_vector", 2e-2, 4, 1e-4);
    expect_convergence(held(1), "rotation_vector", 1e-2, 4, 1e-4);
}

/// With constant w the rotation vector moves on a straight line and its equation is exact: only rounding errors
/// remain, for any number of rotations and any step.
TEST(RotationVector, IsExactWhereTheAxisStands) {
    Scene scene;
    scene.name = "ball", scene.duration = 100;
    scene.initial.angular_velocity = {1, -2, 2};
    for (const double h : {0.5, 0.01}) {
        const Trajectory trajectory = with_step(scene, "rotation_vector", h, 10);
        ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
        for (const Sample& s : trajectory.samples) {
            const double half = 3 * s.t / 2, c = std::sin(half) / 3;
            EXPECT_LT(attitude_error(s.q, {std::cos(half), c, -2 * c, 2 * c}), 1e-11) << h;
            EXPECT_NEAR(squared_norm(s.q), 1, 1e-15);
        }
    }
}

/// The recentred vector never reaches its singularity at a full rotation, so the error keeps growing slowly. Compared
/// with the closed form of a symmetric body.
TEST(RotationVector, PassesManyTurns) {
    const Scene scene = symmetric_body(200);
    const Trajectory trajectory = with_step(scene, "rotation_vector", 0.01, 20);
    ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
    // 45 rotations; order 4 leaves 1e-8 of the angle
    for (const Sample& s : trajectory.samples) EXPECT_LT(attitude_error(s.q, symmetric_attitude(scene, s.t)), 1e-6);
}

}  // namespace
}  // namespace polhode
