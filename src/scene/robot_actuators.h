// Actuators of robot files as loads.
#pragma once

#include <string>

#include "scene/robot_tree.h"

namespace polhode {

/// Adds the actuators of joints of the scene: a constant motor if the force does not depend on the state, else a motor
/// by a formula. Removes their notes in robot.omitted. Throws InputError for a control without an actuator.
void add_actuators(Robot& robot, const RobotOptions& options, const std::string& path, Scene& scene);

}  // namespace polhode
