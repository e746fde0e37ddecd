// Equality constraints of MJCF: couplings and locked joints, loops, and welds of free bodies.
#pragma once

#include "scene/robot_parts.h"

namespace polhode {

/// Adds the active equality constraints of a model to the robot that was read from it: <joint> as a coupling or a fixed
/// joint, <connect> of two bodies as a spherical loop, and <weld> of a free body as a fixed joint. Notes all others as
/// omitted. The joints and links of the robot must have their final names. Throws InputError.
void add_mjcf_equalities(const RobotXml& xml, const XMLElement& root, Robot& robot);

/// Notes all active equality constraints of a model as omitted.
void omit_mjcf_equalities(const RobotXml& xml, const XMLElement& root, Robot& robot);

}  // namespace polhode
