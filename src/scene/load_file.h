// What acts on a body or between bodies, in scene files.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"
#include "text/json_document.h"

namespace polhode {

/// The load that the object at `node` describes. A motor's key is its joint's matter: "torque" on a revolute one of
/// `joints`, "force" on a prismatic one. Throws InputError.
Load parse_load(const JsonNode& node, const std::vector<Joint>& joints);

/// As canonical JSON. Throws std::invalid_argument on a UserTorque.
std::string write_load(const Load& load, const std::vector<Joint>& joints);

}  // namespace polhode
