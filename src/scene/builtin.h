// Texts that are compiled into the program: every experiments/scenes/NAME.json (NAME may be FOLDER/NAME), every
// experiments/NAME.json, and the robot descriptions that scenes import.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace polhode {

/// A built-in text and its name.
struct BuiltinText {
    std::string_view name, text;
};

/// Sorted by name. Generated at configure time.
std::span<const BuiltinText> builtin_scenes();
std::span<const BuiltinText> builtin_experiments();

/// Robot descriptions imported by scenes: every experiments/scenes/robots/FILE, named "robots/FILE".
std::span<const BuiltinText> builtin_robots();

/// Prefix of the directory of a built-in scene, before the name of its folder. Files named by such a scene are built
/// in as well.
inline constexpr std::string_view builtin_directory = "builtin:";

/// Lessons of the report page: every experiments/lessons/NAME.json.
std::span<const BuiltinText> builtin_lessons();

/// The names of the built-in robot descriptions, sorted.
std::vector<std::string> builtin_robot_names();

/// The text of a built-in robot description; empty if it does not exist.
std::string_view builtin_robot_text(std::string_view name);

/// The names of the built-in experiments, sorted.
std::vector<std::string> builtin_experiment_names();

/// The text of a built-in experiment file; empty if it does not exist.
std::string_view builtin_experiment_text(std::string_view name);

}  // namespace polhode
