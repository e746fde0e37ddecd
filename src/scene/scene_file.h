// Reads and writes scene files (JSON with comments).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace polhode {

/// Parses a scene. `file` is named in errors; files that the scene names are relative to `directory` (empty: the
/// working directory). Throws InputError.
Scene parse_scene(std::string_view text, const std::string& file, const std::string& directory = "");

/// Reads and parses a scene file. Throws InputError, also if the file cannot be read.
Scene read_scene(const std::string& path);

/// The scene as canonical JSON, whose hash identifies the scene. Every number is the shortest decimal that reads back
/// to the same binary64; keys are in the documented order. Files that it names keep their names, with the
/// hash of their bytes in a comment. An imported robot is written as its bodies and joints. Throws
/// std::invalid_argument for a UserTorque.
std::string write_scene(const Scene& scene);

/// The built-in scene with this name, or else the file at this path. Throws InputError.
Scene find_scene(const std::string& name_or_path);

/// The names of the built-in scenes, sorted.
std::vector<std::string> builtin_scene_names();

/// The text of a built-in scene file; empty if it does not exist.
std::string_view builtin_scene_text(std::string_view name);

}  // namespace polhode
