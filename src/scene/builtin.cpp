#include "scene/builtin.h"

#include "scene/scene_file.h"

namespace polhode {
namespace {

std::vector<std::string> names_of(std::span<const BuiltinText> texts) {
    std::vector<std::string> names;
    for (const BuiltinText& one : texts) names.emplace_back(one.name);
    return names;
}

std::string_view text_of(std::span<const BuiltinText> texts, std::string_view name) {
    for (const BuiltinText& one : texts)
        if (one.name == name) return one.text;
    return {};
}

}  // namespace

std::vector<std::string> builtin_scene_names() { return names_of(builtin_scenes()); }
std::string_view builtin_scene_text(std::string_view name) { return text_of(builtin_scenes(), name); }
std::vector<std::string> builtin_experiment_names() { return names_of(builtin_experiments()); }
std::string_view builtin_experiment_text(std::string_view name) { return text_of(builtin_experiments(), name); }

std::vector<std::string> builtin_robot_names() { return names_of(builtin_robots()); }
std::string_view builtin_robot_text(std::string_view name) { return text_of(builtin_robots(), name); }

}  // namespace polhode
