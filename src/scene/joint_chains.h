// Joint types that are chains of revolute and prismatic joints: compound, cylindrical, screw, planar, and free.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "text/json_document.h"

namespace polhode {

/// A joint as a chain: each of its joints except the last moves a massless body in the frame of the child.
struct JointChain {
    std::vector<Joint> joints;
    std::vector<NamedBody> bodies;        ///< massless
    std::vector<Coupling> couplings;      ///< screw: of its two joints
    std::string free_child;               ///< free: the child, which has no joint
    std::optional<Initial> free_initial;  ///< free: its initial state
};

/// Parses the element `index` of "joints" if it has one of these types. Nothing if it has another type.
std::optional<JointChain> parse_joint_chain(const JsonNode& node, std::size_t index);

}  // namespace polhode
