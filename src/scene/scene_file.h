// Scene files (JSON with comments) in and out.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace polhode {

/// The scene that `text` describes; `file` is named in errors, the files it names are relative to `directory` (empty:
/// the working directory). Throws InputError.
Scene parse_scene(std::string_view text, const std::string& file, const std::string& directory = "");

/// Reads and parses a scene file. Throws InputError, also when the file cannot be read.
Scene read_scene(const std::string& path);

/// The scene as canonical JSON: every number as its shortest decimal that reads back to the same binary64, keys in
/// the contract's order; files it names keep their names, with the hash of their bytes in a comment, but a robot that
/// it imports stands as the bodies and joints that it became. Its hash is the scene's identity. Throws
/// std::invalid_argument on a UserTorque.
std::string write_scene(const Scene& scene);

/// A scene that is built into the program, by name, or else the file at that path. Throws InputError.
Scene find_scene(const std::string& name_or_path);

/// The names of the built-in scenes, sorted.
std::vector<std::string> builtin_scene_names();

/// The text of a built-in scene's file; empty if there is none of that name.
std::string_view builtin_scene_text(std::string_view name);

}  // namespace polhode
