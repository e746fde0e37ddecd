// Reader and writer of loads in scene files.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"
#include "text/json_document.h"

namespace polhode {

/// Parses the load at `node`. The key of a motor depends on its joint in `joints`: "torque" for a revolute joint,
/// "force" for a prismatic one. Throws InputError.
Load parse_load(const JsonNode& node, const std::vector<Joint>& joints);

/// The load as canonical JSON. Throws std::invalid_argument for a UserTorque.
std::string write_load(const Load& load, const std::vector<Joint>& joints);

}  // namespace polhode
