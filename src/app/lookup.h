// Scenes and methods given on the command line.
#pragma once

#include <string>
#include <vector>

#include "integrators/method.h"
#include "scene/scene.h"

namespace polhode {

/// Returns the method of this name. Throws UsageError with similar names if there is none.
const Method& method_named(const std::string& name);

std::vector<std::string> method_names();

/// Reads the scene of this name or file. If it imports a robot with constructs that are not modelled, one line on
/// stderr lists their kinds. Throws InputError.
Scene read_scene_with_notes(const std::string& name_or_path);

}  // namespace polhode
