// The texts that are built into the program: every experiments/scenes/NAME.json (NAME may be FOLDER/NAME) and
// experiments/NAME.json, and what scenes import.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace polhode {

struct BuiltinText {
    std::string_view name, text;
};

/// Sorted by name. Generated at configure time.
std::span<const BuiltinText> builtin_scenes();
std::span<const BuiltinText> builtin_experiments();

/// Robot descriptions that scenes import: every experiments/scenes/robots/FILE, by the name "robots/FILE".
std::span<const BuiltinText> builtin_robots();

/// What the directory of a built-in scene begins with, before the name of its folder: the files that it names are built
/// in as well.
inline constexpr std::string_view builtin_directory = "builtin:";

/// The names of the built-in robot descriptions, sorted.
std::vector<std::string> builtin_robot_names();

/// The text of a built-in robot description; empty if there is none of that name.
std::string_view builtin_robot_text(std::string_view name);

/// The names of the built-in experiments, sorted.
std::vector<std::string> builtin_experiment_names();

/// The text of a built-in experiment's file; empty if there is none of that name.
std::string_view builtin_experiment_text(std::string_view name);

}  // namespace polhode
