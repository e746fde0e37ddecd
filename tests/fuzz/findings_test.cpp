// Runs every seed of the fuzz targets and every input that once failed, in every build.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "fuzz/command_oracle.h"
#include "fuzz/folder_oracle.h"
#include "fuzz/oracles.h"
#include "places.h"

namespace polhode {
namespace {

namespace fs = std::filesystem;

struct Target {
    const char* name;
    void (*oracle)(std::string_view);
    std::vector<std::string> also;  // directories with further seeds
};

class Findings : public ::testing::TestWithParam<Target> {};

TEST_P(Findings, AreReproducible) {
    const std::string tests = source_dir() + "/tests/";
    std::vector<std::string> directories = GetParam().also;
    for (const char* kind : {"seeds", "findings"})
        directories.push_back(tests + "fuzz/" + kind + "/" + GetParam().name);
    int files = 0;
    for (const std::string& directory : directories) {
        if (!fs::exists(directory)) continue;
        for (const auto& entry : fs::directory_iterator(directory)) {
            if (!entry.is_regular_file()) continue;
            std::ifstream file(entry.path(), std::ios::binary);
            const std::string text(std::istreambuf_iterator<char>(file), {});
            EXPECT_NO_THROW(GetParam().oracle(text)) << entry.path();
            ++files;
        }
    }
    EXPECT_GT(files, 0);
}

std::string name_of(const ::testing::TestParamInfo<Target>& info) { return info.param.name; }

const std::string top = source_dir();

INSTANTIATE_TEST_SUITE_P(
    Fuzz, Findings,
    ::testing::Values(
        Target{"scene",
               oracles::scene,
               {top + "/experiments/scenes", top + "/experiments/scenes/mechanisms", top + "/tests/scene/bad"}},
        Target{"experiment", oracles::experiment, {top + "/experiments", top + "/tests/experiment/bad"}},
        Target{"body", oracles::body, {top + "/tests/scene/bodies"}},
        Target{"trajectory", oracles::trajectory, {top + "/tests/motion/bad"}},
        Target{"ensemble", oracles::ensemble, {top + "/tests/motion/ensemble/bad"}}, Target{"npy", oracles::npy, {}},
        Target{"engine", oracles::engine, {}}, Target{"table", oracles::table, {}}, Target{"tape", oracles::tape, {}},
        Target{"cache", oracles::cache, {}}, Target{"mechanisms", oracles::mechanisms, {}},
        Target{"columns", oracles::columns, {}}, Target{"words", oracles::words, {}},
        Target{"folder", oracles::folder, {}}, Target{"command", oracles::command, {}}),
    name_of);

}  // namespace
}  // namespace polhode
