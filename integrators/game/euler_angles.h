// Euler angles as integrated state, and what a run meets on its way past gimbal lock.
#pragma once

#include <limits>

#include "integrators/method.h"

namespace polhode {

/// Of a run's steps: those that end in the first tenth of the run, where a solver finds its pace, and those cut short
/// by an event or the end, are left out.
struct LockPassage {
    double smallest_step = std::numeric_limits<double>::infinity();  ///< s
    double largest_angle_rate = 0;  ///< rad/s, of roll, pitch or yaw, at the steps' ends; 0 where there are no angles
    double nearest = std::numeric_limits<double>::infinity();  ///< rad, least distance of the pitch from a right angle
};

/// The methods `euler_angles` and `euler_angles_cvode`, of a problem posed in full; `passage` may be nullptr.
Trajectory solve_euler_angles(const Problem& problem, const Settings& settings, LockPassage* passage);
Trajectory solve_euler_angles_cvode(const Problem& problem, const Settings& settings, LockPassage* passage);

/// The method `cvode_adams` on quaternions, by all 13 variables in body axes: of a problem posed in full too, and
/// watched likewise.
Trajectory solve_quaternion_cvode(const Problem& problem, const Settings& settings, LockPassage* passage);

}  // namespace polhode
