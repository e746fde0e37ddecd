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
    second.q = {0, 2, 0, 0};  // rotated by pi about x, not normalised: w uses the normalised q
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

TEST(TrajectoryCsv, WritesALineForEachBody) {
    Trajectory trajectory;
    Sample arm, leg;
    arm.q = {1, 0, 0, 0}, leg.q = {0, 1, 0, 0}, leg.velocity_W = {1, 2, 3};
    trajectory.append(std::vector<Sample>{arm, leg});
    arm.t = leg.t = 0.5;
    trajectory.append(std::vector<Sample>{arm, leg});
    const std::vector<std::string> names{"arm", "leg"}, joints{"hip", "knee", "loop"};
    EXPECT_EQ(trajectory_csv(trajectory, names),
              "t,body,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz\n"
              "0,arm,1,0,0,0,0,0,0,0,0,0,0,0,0\n0,leg,0,1,0,0,0,0,0,0,0,0,1,2,3\n"
              "0.5,arm,1,0,0,0,0,0,0,0,0,0,0,0,0\n0.5,leg,0,1,0,0,0,0,0,0,0,0,1,2,3\n");
    for (int k = 0; k < 6; ++k) trajectory.reactions.push_back({{k + 0.5, 0, 0}, {0, 0, -1.0 * k}});
    EXPECT_EQ(reactions_csv(trajectory, joints),
              "t,joint,fx,fy,fz,tx,ty,tz\n0,hip,0.5,0,0,0,0,-0.0\n0,knee,1.5,0,0,0,0,-1\n0,loop,2.5,0,0,0,0,-2\n"
              "0.5,hip,3.5,0,0,0,0,-3\n0.5,knee,4.5,0,0,0,0,-4\n0.5,loop,5.5,0,0,0,0,-5\n");
}

}  // namespace
}  // namespace polhode
