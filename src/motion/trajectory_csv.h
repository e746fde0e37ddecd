// Trajectories as CSV files: t,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz.
#pragma once

#include <string>

#include "motion/trajectory.h"

namespace polhode {

/// A header line, then one line a sample: t (s); q body to world as the method left it; w in world axes (rad/s); p, v
/// of the centre of mass (m, m/s). Shortest decimals that read back to the same binary64. A trajectory whose status is
/// not ok ends in a comment line that says so.
std::string trajectory_csv(const Trajectory& trajectory);

}  // namespace polhode
