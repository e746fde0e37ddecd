// The texts that are built into the program: every experiments/scenes/NAME.json (NAME may be FOLDER/NAME) and
// experiments/NAME.json.
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

/// The names of the built-in experiments, sorted.
std::vector<std::string> builtin_experiment_names();

/// The text of a built-in experiment's file; empty if there is none of that name.
std::string_view builtin_experiment_text(std::string_view name);

}  // namespace polhode
