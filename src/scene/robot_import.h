// Imports a whole robot into a scene: the member "import" in place of "bodies" and "joints".
#pragma once

#include "scene/scene.h"
#include "text/json_document.h"

namespace polhode {

/// Adds the bodies, joints and loads of the robot named by the object at `node` to `scene`, each number rounded once
/// to binary64, and notes on constructs that are not modelled. `scene_has_gravity`: the scene file has a gravity
/// load, which takes precedence over the robot file's. Throws InputError.
void parse_robot_import(const JsonNode& node, bool scene_has_gravity, Scene& scene);

}  // namespace polhode
