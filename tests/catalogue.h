// The names of built-in scenes, for tests over all of them.
#pragma once

#include <string>
#include <vector>

#include "scene/scene_family.h"
#include "scene/scene_file.h"

namespace polhode {

/// The names of the built-in scenes in this folder, by default of those outside any folder.
inline std::vector<std::string> scenes_in(const std::string& folder = "") {
    std::vector<std::string> names;
    for (const std::string& name : builtin_scene_names())
        if (family_member(name).folder == folder) names.push_back(name);
    return names;
}

/// The scene's name as a valid GoogleTest name.
inline std::string test_name(std::string scene_name) {
    for (char& c : scene_name)
        if (c == '/' || c == '-' || c == '.' || c == '+') c = '_';
    return scene_name;
}

}  // namespace polhode
