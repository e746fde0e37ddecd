// Gears of SDFormat: gearbox joints and <mimic> elements as couplings of joint coordinates.
#pragma once

#include <array>
#include <string>

#include "scene/robot_parts.h"

namespace polhode {

/// A joint of type gearbox. theta2 = -ratio theta1, where theta1 is the rotation of the parent relative to the
/// reference body about `axis`, and theta2 that of the child about `axis2`.
struct SdfGearbox {
    std::string name;
    std::size_t parent = 0, child = 0, reference = 0;  ///< indices of links of the robot, or RobotJoint::world
    std::array<Vector3<Wide>, 2> axes_W;               ///< at coordinates zero
};

/// The ratio of a gearbox joint, by default 1. Throws InputError.
double sdf_gearbox_ratio(const RobotXml& xml, const XMLElement& at);

/// Adds the coupling of a gearbox to the robot, whose joints are known. Notes it as omitted if the reference body is
/// not connected to both links by revolute joints about the two axes.
void add_sdf_gearbox(const SdfGearbox& gearbox, double ratio, Robot& robot);

/// Adds the coupling of the <mimic> element of a joint's <axis>, if there is one. Notes it as omitted if it is not of
/// the first axis of a revolute or prismatic joint. Throws InputError.
void add_sdf_mimic(const RobotXml& xml, const XMLElement& joint, const std::string& name, RobotMotion motion,
                   Robot& robot);

}  // namespace polhode
