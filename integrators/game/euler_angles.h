// Euler angles as integrated state, and what a run records as it passes gimbal lock.
#pragma once

#include <limits>

#include "integrators/method.h"

namespace polhode {

/// Statistics of a run's steps. Steps that end in the first tenth of the run, where a solver adapts its step size,
/// and steps shortened by an event or the end are excluded.
struct LockPassage {
    double smallest_step = std::numeric_limits<double>::infinity();  ///< s
    double largest_angle_rate = 0;  ///< rad/s, of roll, pitch or yaw, at the ends of steps; 0 for quaternions
    double nearest = std::numeric_limits<double>::infinity();  ///< rad, smallest distance of the pitch from a right
                                                               ///< angle
};

/// The methods `euler_angles` and `euler_angles_cvode`, for problems with Formulation::full. `passage` may be
/// nullptr.
Trajectory solve_euler_angles(const Problem& problem, const Settings& settings, LockPassage* passage);
Trajectory solve_euler_angles_cvode(const Problem& problem, const Settings& settings, LockPassage* passage);

/// The method `cvode_adams` on quaternions, with all 13 variables in body axes, for problems with Formulation::full.
/// `passage` may be nullptr.
Trajectory solve_quaternion_cvode(const Problem& problem, const Settings& settings, LockPassage* passage);

}  // namespace polhode
