// Converts the joints of an SDFormat file to a forest of links.
#pragma once

#include <string>
#include <vector>

#include "scene/sdf_tree.h"

namespace polhode {

/// A joint between links of a Robot; `child` may be the world (a static model).
struct SdfJoint {
    const XMLElement* at = nullptr;
    RobotJoint joint;
};

/// Reads a <joint> between two links, given as entities or SdfTree::world. Does not set the link indices of the
/// result. Throws InputError for unsupported joints.
RobotJoint read_sdf_joint(const RobotXml& xml, SdfTree& tree, const SdfEntity& entity, const std::string& name,
                          std::size_t parent, std::size_t child, Robot& robot);

/// The direction of an axis of a <joint> in the world if all coordinates are zero; `tag`: "axis" or "axis2". Throws
/// InputError.
Vector3<Wide> sdf_axis_in_world(const RobotXml& xml, SdfTree& tree, const SdfEntity& entity, const char* tag,
                                Robot& robot);

/// Directs all joints away from the world, or from the root of their tree; joints directed the other way in the file
/// are reversed. Throws InputError if joints close a loop.
std::vector<RobotJoint> direct_sdf_joints(const RobotXml& xml, std::vector<SdfJoint> joints, Robot& robot);

}  // namespace polhode
