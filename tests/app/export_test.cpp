// polhode export: golden data that engines' own tests can be built on.
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "app/program_fixture.h"
#include "motion/trajectory_csv.h"

namespace polhode {
namespace {

class Export : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        ::setenv("POLHODE_CACHE", (directory / "cache").c_str(), 1);
        write("spin.json", R"({"name": "9 lives! */ ??/ \"of\" a_top", "about": "one // two", "duration": 4,
            "body": {"mass": 2, "inertia": [[1, 0.1, 0], [0.1, 2, 0], [0, 0, 2.5]], "center_of_mass": [0.1, 0.2, 0.5]},
            "initial": {"orientation": [0.8, 0, 0.6, 0], "angular_velocity": [0.3, 0.1, 2]}, "pivot": [0, 0, 0],
            "loads": [{"type": "gravity", "acceleration": [0, 0, -9.75]}], "tolerated": {"attitude": 0.01}})");
    }
    void TearDown() override {
        ::unsetenv("POLHODE_CACHE");
        Program::TearDown();
    }
    void write(const std::string& name, const std::string& text) const { std::ofstream(directory / name) << text; }
    nlohmann::json exported_json(const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments{"export", "spin.json", "--samples", "7", "--format", "json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return nlohmann::json::parse(outcome.out, nullptr, false);
    }
    int shell(const std::string& command) const {
        return std::system(("cd '" + directory.string() + "' && " + command).c_str());  // NOLINT(cert-env33-c)
    }
};

TEST_F(Export, JsonHoldsAllThatATestNeeds) {
    const nlohmann::json data = exported_json();
    ASSERT_FALSE(data.is_discarded());
    EXPECT_EQ(data["body"]["mass"], 2);
    EXPECT_EQ(data["body"]["inertia"][0], (std::vector<double>{1, 0.1, 0}));
    EXPECT_EQ(data["body"]["center_of_mass"], (std::vector<double>{0.1, 0.2, 0.5}));
    EXPECT_EQ(data["pivot"], (std::vector<double>{0, 0, 0}));
    EXPECT_EQ(data["loads_z_up"][0]["type"], "gravity");
    EXPECT_EQ(data["tolerance"], 0.01);
    EXPECT_LT(data["bound"], 1e-15);
    EXPECT_GT(data["float32_floor"], data["float64_floor"]);
    EXPECT_EQ(data["columns"].size(), 14u);
    ASSERT_EQ(data["samples"].size(), 8u);
    const auto& start = data["samples"][0];
    EXPECT_EQ(start[1], 0.8);
    EXPECT_EQ(start[3], 0.6);
    // w in world axes: R(q) (0.3, 0.1, 2), with q a turn by 2 acos 0.8 about y: cos 0.28, sin 0.96
    EXPECT_NEAR(start[5], 0.28 * 0.3 + 0.96 * 2, 1e-15);
    EXPECT_NEAR(start[7], -0.96 * 0.3 + 0.28 * 2, 1e-15);
    EXPECT_EQ(data["samples"][7][0], 4);
}

TEST_F(Export, CsvIsATrajectoryThatPasses) {
    ASSERT_EQ(run({"export", "spin.json", "--samples", "9", "--output", "golden.csv"}).exit_code, 0);
    const Outcome outcome = run({"check", "spin.json", "golden.csv", "--max-attitude", "1e-15"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
}

TEST_F(Export, ConventionsGoThereAndBack) {
    for (const char* words : {"y-up", "left-handed", "unity,scalar-last,degrees", "godot,scalar-first"}) {
        ASSERT_EQ(run({"export", "spin.json", "--convention", words, "--output", "there.csv"}).exit_code, 0);
        EXPECT_EQ(run({"check", "spin.json", "there.csv", "--convention", words, "--max-attitude", "1e-15"}).exit_code,
                  0);
        EXPECT_EQ(run({"check", "spin.json", "there.csv", "--max-attitude", "1e-3"}).exit_code, 1) << words;
    }
    // the tensor of a mirrored body: y and z exchanged
    const nlohmann::json unity = exported_json({"--convention", "unity"});
    EXPECT_EQ(unity["body"]["inertia"][0], (std::vector<double>{1, 0, 0.1}));
    EXPECT_EQ(unity["body"]["inertia"][1], (std::vector<double>{0, 2.5, 0}));
    EXPECT_EQ(unity["body"]["center_of_mass"], (std::vector<double>{0.1, 0.5, 0.2}));
    // a quarter turn changes the sign of a product of inertia
    const nlohmann::json godot = exported_json({"--convention", "godot"});
    EXPECT_EQ(godot["body"]["inertia"][2], (std::vector<double>{-0.1, 0, 2}));
    EXPECT_EQ(godot["body"]["center_of_mass"], (std::vector<double>{0.1, 0.5, -0.2}));
}

// the header compiles as both languages without a warning, and its numbers are the same binary64
TEST_F(Export, TheHeaderCompilesAndReadsBack) {
    ASSERT_EQ(run({"export", "spin.json", "--samples", "7", "--format", "c", "--output", "golden.h"}).exit_code, 0);
    const std::string prefix = "polhode_9_lives_of_a_top_";
    std::string program =
        "#include \"golden.h\"\n#include \"golden.h\"\n#include <stdio.h>\nint main(void) {\n    int i, k;\n";
    const auto name = [&](const std::string& what) { return prefix + what; };
    program += "    printf(\"%a %a %a %d\\n\", " + name("mass") + ", " + name("bound") + ", " + name("tolerance") +
               ", " + name("has_pivot") + ");\n    printf(\"%a %a\\n\", " + name("float32_floor") + ", " +
               name("pivot") + "[0]);\n";
    program += "    for (i = 0; i < 3; ++i) printf(\"%a \", " + name("center_of_mass") + "[i]);\n";
    program += "    for (i = 0; i < 3; ++i) for (k = 0; k < 3; ++k) printf(\"%a \", " + name("inertia") + "[i][k]);\n";
    program += "    for (i = 0; i < " + name("samples") + "; ++i) {\n        printf(\"%a \", " + name("t") + "[i]);\n";
    for (const auto& [block, size] :
         {std::pair("q", "4"), std::pair("w", "3"), std::pair("p", "3"), std::pair("v", "3")})
        program +=
            std::string("        for (k = 0; k < ") + size + "; ++k) printf(\"%a \", " + name(block) + "[i][k]);\n";
    program += "    }\n    return 0;\n}\n";
    write("main.c", program), write("main.cpp", program);
    ASSERT_EQ(shell("cc -std=c99 -Wall -Wextra -Werror -pedantic main.c -o in_c && ./in_c > c.txt"), 0)
        << read(directory / "golden.h");
    ASSERT_EQ(shell("c++ -std=c++11 -Wall -Wextra -Werror -pedantic main.cpp -o in_cpp && ./in_cpp > cpp.txt"), 0);
    EXPECT_EQ(read(directory / "c.txt"), read(directory / "cpp.txt"));
    const nlohmann::json data = exported_json();
    std::vector<double> expected{data["body"]["mass"], data["bound"], data["tolerance"], 1, data["float32_floor"], 0};
    for (const auto& x : data["body"]["center_of_mass"]) expected.push_back(x);
    for (const auto& row : data["body"]["inertia"])
        for (const auto& x : row) expected.push_back(x);
    for (const auto& sample : data["samples"])
        for (const auto& x : sample) expected.push_back(x);
    std::ifstream words(directory / "c.txt");
    std::vector<double> found;
    for (std::string word; words >> word;) found.push_back(std::strtod(word.c_str(), nullptr));
    EXPECT_EQ(found, expected);
}

TEST_F(Export, ToleranceIsWhatAFloatEngineCanHold) {
    // no word of the scene's: 1e-3 rad, or ten times what rounding the start leads to
    const auto tolerance = [&](const char* scene) {
        const Outcome outcome = run({"export", scene, "--samples", "2", "--format", "json"});
        return nlohmann::json::parse(outcome.out);
    };
    const nlohmann::json calm = tolerance("free_asymmetric");
    EXPECT_EQ(calm["tolerance"], 1e-3);
    const nlohmann::json wild = tolerance("chaotic_top");
    EXPECT_DOUBLE_EQ(wild["tolerance"], std::min(10 * wild["float32_floor"].get<double>(), std::acos(-1.0)));
    EXPECT_GT(wild["tolerance"], 1e-3);
}

TEST_F(Export, RefusesBadUsage) {
    fs::remove(directory / "spin.json");
    expect_refused({"export", "no_such_scene"}, "no_such_scene");
    expect_refused({"export", "symmetric", "--samples", "0"}, "--samples");
    expect_refused({"export", "symmetric", "--format", "xml"}, "xml");
    expect_refused({"export", "symmetric", "--convention", "x-up"}, "x-up");
    expect_refused({"export", "symmetric", "--duration", "nan"}, "--duration");
}

}  // namespace
}  // namespace polhode
