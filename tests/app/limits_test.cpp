// The table of limits in src/README.md against the constants that hold them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <string>

#include "check/check_files.h"
#include "experiment/plan/plan_limits.h"
#include "places.h"
#include "scene/scene_limits.h"
#include "text/json_limits.h"

namespace polhode {
namespace {

std::map<std::string, std::string> limits_of_readme() {
    std::map<std::string, std::string> limits;
    std::ifstream file(source_dir() + "/src/README.md");
    bool inside = false;
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("| what | limit")) inside = true;
        if (inside && !line.starts_with("|")) break;
        if (!inside || line.starts_with("| what") || line.starts_with("| ---")) continue;
        const std::size_t first = line.find(" | "), second = line.find(" | ", first + 3);
        const std::string what = line.substr(2, first - 2), of = line.substr(second + 3, line.rfind(" |") - second - 3);
        limits[fmt::format("{} of {}", what, of)] = line.substr(first + 3, second - first - 3);
    }
    return limits;
}

TEST(Limits, AreThoseOfTheReadme) {
    const auto mebibytes = [](double bytes) { return fmt::format("{:.0f} MiB", bytes / (1 << 20)); };
    const auto count = [](double value, const char* unit = "") { return fmt::format("{:.0f}{}", value, unit); };
    const std::map<std::string, std::string> expected{
        {"JSON text of scene, experiment", mebibytes(largest_json)},
        {"JSON values of scene, experiment", count(most_json_values)},
        {"JSON nesting of scene, experiment", count(deepest_json)},
        {"name of scene, body, joint, loop", count(longest_scene_name, " bytes")},
        {"about and source of scene", count(longest_about, " bytes")},
        {"bodies of scene, robot", count(most_bodies)},
        {"loads of scene", count(most_loads)},
        {"planes of scene", count(most_planes)},
        {"mesh file of mesh", mebibytes(largest_mesh_file)},
        {"triangles of mesh", count(most_triangles)},
        {"vertices of mesh", count(most_vertices)},
        {"corners of a face of mesh", count(most_corners)},
        {"robot file of robot", mebibytes(largest_robot_file)},
        {"samples times bodies of solve, truth, experiment", count(most_states)},
        {"scenes, methods of experiment", count(most_entries)},
        {"varied pointers of experiment", count(most_varied)},
        {"variants of a scene of experiment", count(most_variants)},
        {"scenes and meshes of all variants of experiment", mebibytes(largest_plan)},
        {"cases of experiment", count(most_cases)},
        {"values of a range of experiment", count(most_range_values)},
        {"samples of experiment", count(most_experiment_samples)},
        {"repeats of experiment", count(most_repeats)},
        {"seconds_per_run of experiment", count(most_seconds_per_run, " s")},
        {"about of experiment", count(longest_experiment_about, " bytes")},
        {"regular expression of experiment, --filter", count(longest_expression, " characters")},
        {"parentheses in one another of experiment, --filter", count(deepest_parentheses)},
        {"repetitions multiplied of experiment, --filter", count(most_unrolled)},
        {"trajectory of check, plot", mebibytes(largest_file)},
    };
    EXPECT_EQ(limits_of_readme(), expected);
}

}  // namespace
}  // namespace polhode
