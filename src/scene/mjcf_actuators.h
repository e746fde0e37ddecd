// Actuators of MJCF.
#pragma once

#include <vector>

#include "scene/robot_parts.h"

namespace polhode {

/// Whether an attribute `range` limits something, by the attribute `limited`.
bool has_mjcf_range(const XMLElement& at, const char* limited, const char* range);

/// Adds the drives of hinges and slides whose force is an affine function of length and velocity: <motor>, <position>,
/// <velocity>, <damper>, and <general> without activation. All others stay in the notes about omissions. `references`:
/// the `ref` of each joint of the robot. The joints must have their final names. Throws InputError.
void add_mjcf_actuators(const RobotXml& xml, const XMLElement& root, const std::vector<Wide>& references, Robot& robot);

}  // namespace polhode
