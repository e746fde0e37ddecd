// Scenes and methods given on the command line.
#pragma once

#include <string>
#include <vector>

#include "integrators/method.h"
#include "scene/scene.h"

namespace polhode {

/// The method of that name; throws UsageError, with near misses, if there is none.
const Method& method_named(const std::string& name);

std::vector<std::string> method_names();

/// The scene of that name or file. If it imports a robot with constructs that are not modelled, one line on stderr
/// names their kinds. Throws InputError.
Scene read_scene_with_notes(const std::string& name_or_path);

}  // namespace polhode
