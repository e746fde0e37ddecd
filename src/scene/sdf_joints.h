// The joints of an SDFormat file as a forest of links.
#pragma once

#include <string>
#include <vector>

#include "scene/sdf_tree.h"

namespace polhode {

/// A joint of the file between links of a Robot; `child` may be the world (a static model).
struct SdfJoint {
    const XMLElement* at = nullptr;
    RobotJoint joint;
};

/// The RobotJoint of a <joint> between two links, each an entity or SdfTree::world, without the indices of its links.
/// Throws InputError at joints that are not supported.
RobotJoint read_sdf_joint(const RobotXml& xml, SdfTree& tree, const SdfEntity& entity, const std::string& name,
                          std::size_t parent, std::size_t child, Robot& robot);

/// The joints with parents nearer to the world, or to the root of their tree: joints that the file directs the other
/// way are reversed. Throws InputError where joints close a loop.
std::vector<RobotJoint> direct_sdf_joints(const RobotXml& xml, std::vector<SdfJoint> joints, Robot& robot);

}  // namespace polhode
