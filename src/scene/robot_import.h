// Scenes of a whole robot: the member "import" in place of "bodies" and "joints".
#pragma once

#include "scene/scene.h"
#include "text/json_document.h"

namespace polhode {

/// The bodies and joints of the robot that the object at `node` names go into `scene`, each number rounded once to
/// binary64, with what is left out of the file. Throws InputError.
void parse_robot_import(const JsonNode& node, Scene& scene);

}  // namespace polhode
