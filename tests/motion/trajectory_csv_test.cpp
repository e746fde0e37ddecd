#include "motion/trajectory_csv.h"

#include <gtest/gtest.h>

namespace polhode {
namespace {

TEST(TrajectoryCsv, WritesTheGoldenText) {
    Trajectory trajectory;
    Sample first;
    first.q = {1, 0, 0, 0}, first.angular_velocity_B = {1, 2, 3};
    Sample second;
    second.t = 0.1;
    second.q = {0, 2, 0, 0};  // half a turn about x, not normalised: written as it is, w turned by it normalised
    second.angular_velocity_B = {1, 2, 3};
    second.position_W = {1.0 / 3, 1e-300, -0.5};
    second.velocity_W = {1e22, 5e-324, 0.1};
    trajectory.samples = {first, second};
    const std::string golden =
        "t,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz\n"
        "0,1,0,0,0,1,2,3,0,0,0,0,0,0\n"
        "0.1,0,2,0,0,1,-2,-3,0.3333333333333333,1e-300,-0.5,1e+22,5e-324,0.1\n";
    EXPECT_EQ(trajectory_csv(trajectory), golden);
    trajectory.status = Status::diverged, trajectory.message = "not finite\nat t = 0.2 s";
    EXPECT_EQ(trajectory_csv(trajectory), golden + "# diverged: not finite at t = 0.2 s\n");
}

}  // namespace
}  // namespace polhode
