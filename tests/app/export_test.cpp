// polhode export: golden data for the tests of engines.
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

TEST_F(Export, JsonContainsAllInputsOfATest) {
    const nlohmann::json data = exported_json();
    ASSERT_FALSE(data.is_discarded());
    EXPECT_EQ(data["body"]["mass"], 2);
    EXPECT_EQ(data["body"]["inertia"][0], (std::vector<double>{1, 0.1, 0}));
    EXPECT_EQ(data["body"]["center_of_mass"], (std::vector<double>{0.1, 0.2, 0.5}));
    EXPECT_EQ(data["pivot"], (std::vector<double>{0, 0, 0}));
    EXPECT_EQ(data["loads"][0]["type"], "gravity");
    EXPECT_EQ(data["tolerances"]["attitude"]["value"], 0.01);
    EXPECT_EQ(data["tolerances"].size(), 6u);
    EXPECT_EQ(data["tolerance"], 0.01);
    EXPECT_LT(data["bound"], 1e-15);
    EXPECT_GT(data["float32_floor"], data["float64_floor"]);
    EXPECT_EQ(data["columns"].size(), 14u);
    ASSERT_EQ(data["samples"].size(), 8u);
    const auto& start = data["samples"][0];
    EXPECT_EQ(start[1], 0.8);
    EXPECT_EQ(start[3], 0.6);
    // w in world axes: R(q) (0.3, 0.1, 2), with q a rotation by 2 acos 0.8 about y: cos 0.28, sin 0.96
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
    // the inertia tensor of a mirrored body: y and z exchanged
    const nlohmann::json unity = exported_json({"--convention", "unity"});
    EXPECT_EQ(unity["body"]["inertia"][0], (std::vector<double>{1, 0, 0.1}));
    EXPECT_EQ(unity["body"]["inertia"][1], (std::vector<double>{0, 2.5, 0}));
    EXPECT_EQ(unity["body"]["center_of_mass"], (std::vector<double>{0.1, 0.5, 0.2}));
    // a rotation by 90 degrees changes the sign of a product of inertia
    const nlohmann::json godot = exported_json({"--convention", "godot"});
    EXPECT_EQ(godot["body"]["inertia"][2], (std::vector<double>{-0.1, 0, 2}));
    EXPECT_EQ(godot["body"]["center_of_mass"], (std::vector<double>{0.1, 0.5, -0.2}));
}

// The header compiles as C and C++ without warnings, and its numbers are the same binary64.
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

// The exported scene, solved as it is, gives the exported samples. By components the equations are the same in left-
// and right-handed axes and in any unit of length.
TEST_F(Export, TheSceneExportedMovesAsExported) {
    for (const char* scene : {"every_load", "thrown_hammer", "heavy_asymmetric_top", "torsional_spring"})
        for (const char* words : {"unity", "unreal", "godot", "left-handed,inches"}) {
            const Outcome outcome = run({"export", scene, "--samples", "6", "--format", "json", "--convention", words});
            ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
            const nlohmann::json data = nlohmann::json::parse(outcome.out);
            const auto part = [&](const nlohmann::json& row, std::size_t from, std::size_t count) {
                return std::vector<double>(row.begin() + static_cast<long>(from),
                                           row.begin() + static_cast<long>(from + count));
            };
            const nlohmann::json& start = data["samples"][0];
            nlohmann::json given{{"name", "given"},
                                 {"duration", data["samples"][6][0]},
                                 {"body", data["body"]},
                                 {"loads", data["loads"]}};
            given["initial"] = {{"orientation", part(start, 1, 4)},
                                {"angular_velocity", part(start, 5, 3)},
                                {"angular_velocity_frame", "world"}};
            if (data["pivot"].is_null())
                given["initial"]["position"] = part(start, 8, 3), given["initial"]["velocity"] = part(start, 11, 3);
            else
                given["pivot"] = data["pivot"];
            write("given.json", given.dump());
            const Outcome truth = run({"truth", "given.json", "--samples", "6"});
            ASSERT_EQ(truth.exit_code, 0) << truth.err;
            const std::vector<TrajectoryRow> rows = parse_trajectory(truth.out, "truth").rows;
            for (std::size_t k = 0; k < rows.size(); ++k) {
                const TrajectoryRow& r = rows[k];
                const std::vector<double> found{r.q.w,
                                                r.q.x,
                                                r.q.y,
                                                r.q.z,
                                                r.angular_velocity_W[0],
                                                r.angular_velocity_W[1],
                                                r.angular_velocity_W[2],
                                                r.position_W[0],
                                                r.position_W[1],
                                                r.position_W[2],
                                                r.velocity_W[0],
                                                r.velocity_W[1],
                                                r.velocity_W[2]};
                for (std::size_t i = 0; i < found.size(); ++i) {
                    const double wanted = data["samples"][k][1 + i];
                    EXPECT_NEAR(found[i], wanted, 1e-9 * std::max(1.0, std::abs(wanted))) << scene << words << k << i;
                }
            }
        }
}

// The comparison function reports a wrong block and its error, in every language that this machine compiles.
TEST_F(Export, TheComparisonNamesTheBlock) {
    const std::string name = "polhode_9_lives_of_a_top";
    const auto exported = [&](const std::string& format, const std::string& file, bool floats) {
        std::vector<std::string> arguments{"export", "spin.json",    "--samples",         "7",        "--format",
                                           format,   "--convention", "unity,scalar-last", "--output", file};
        if (floats) arguments.emplace_back("--floats");
        EXPECT_EQ(run(arguments).exit_code, 0);
    };
    // the truth passes; half a turn by 0.3 about the first axis and a velocity that is off by 3 do not
    const std::string told = "attitude error 0.3 at t = 4 s exceeds 0.01; velocity error 3 at t = 4 s";
    for (const bool floats : {false, true}) {
        const std::string real = floats ? "float" : "double";
        exported("c", "golden.h", floats), exported("cpp", "golden.hpp", floats);
        const std::string wrong =
            real + " q[4], v[3]; const double c = cos(0.15), s = sin(0.15);\n" + "    const " + real +
            "* e = &Q[7][0];\n" + "    q[3] = (" + real + ")(c * e[3] - s * e[0]); q[0] = (" + real +
            ")(c * e[0] + s * e[3]);\n" + "    q[1] = (" + real + ")(c * e[1] + s * e[2]); q[2] = (" + real +
            ")(c * e[2] - s * e[1]);\n" + "    v[0] = V[7][0] + 3; v[1] = V[7][1]; v[2] = V[7][2];\n";
        write("main.c", "#include \"golden.h\"\n#define Q " + name + "_q\n#define V " + name +
                            "_v\nint main(void) {\n    " + wrong +
                            "    char text[500]; int k, bad = 0;\n    for (k = 0; k < " + name +
                            "_samples; ++k) bad += " + name + "_compare(k, Q[k], " + name + "_w[k], " + name +
                            "_p[k], V[k], &" + name + "_energy[k], " + name +
                            "_momentum[k], text, sizeof text);\n    if (bad || text[0]) return 1;\n    bad = " + name +
                            "_compare(7, q, 0, 0, v, 0, 0, text, sizeof text);\n    puts(text);\n    return bad == 2 ? "
                            "0 : 2;\n}\n");
        write("main.cpp",
              "#include \"golden.hpp\"\nusing namespace " + name + ";\nconst auto& Q = " + name +
                  "::q;\nconst auto& V = " + name + "::v;\nint run() {\n    using std::cos, std::sin;\n    " + wrong +
                  "    for (int k = 0; k < samples; ++k) {\n        const auto i = static_cast<std::size_t>(k);\n      "
                  "  if (!compare(i, Q[i].data(), " +
                  name +
                  "::w[i].data(), p[i].data(), V[i].data()).empty()) return 1;\n    }\n    std::puts(compare(7, q, "
                  "nullptr, nullptr, v).c_str());\n    return 0;\n}\nint main() { return run(); }\n");
        ASSERT_EQ(shell("cc -std=c99 -Wall -Wextra -Werror -pedantic main.c -o in_c -lm && ./in_c > c.txt"), 0)
            << read(directory / "golden.h");
        ASSERT_EQ(shell("c++ -std=c++17 -Wall -Wextra -Werror -pedantic main.cpp -o in_cpp && ./in_cpp > cpp.txt"), 0)
            << read(directory / "golden.hpp");
        EXPECT_EQ(read(directory / "c.txt").find(told), 0u) << read(directory / "c.txt");
        EXPECT_EQ(read(directory / "c.txt"), read(directory / "cpp.txt"));
    }
    if (shell("command -v mcs mono >/dev/null") != 0) return;
    exported("cs", "Golden.cs", false);
    write("Main.cs",
          "public static class Program {\n    public static int Main() {\n        double[] v = { "
          "Polhode_9_lives_of_a_top.v[7, 0] + 3, "
          "Polhode_9_lives_of_a_top.v[7, 1], Polhode_9_lives_of_a_top.v[7, 2] };\n        System.Console.WriteLine("
          "Polhode_9_lives_of_a_top.compare(7, null, null, null, v));\n        return 0;\n    }\n}\n");
    ASSERT_EQ(shell("mcs -warnaserror -out:golden.exe Golden.cs Main.cs && mono golden.exe > cs.txt"), 0);
    EXPECT_EQ(read(directory / "cs.txt").find("velocity error 3 at t = 4 s"), 0u) << read(directory / "cs.txt");
}

TEST_F(Export, ContainsAllInputsOfABody) {
    const Outcome outcome = run({"export", "tumbling_box_bounce", "--samples", "5", "--format", "json", "--convention",
                                 "unity", "--duration", "1"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const nlohmann::json data = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(data["planes"][0]["normal"], (std::vector<double>{0, 1, 0}));  // y is up
    EXPECT_EQ(data["shape"].size(), 8u);                                     // the corners of a box
    EXPECT_GT(data["float32_floor"], 0);
}

TEST_F(Export, ToleranceIsReachableInFloat) {
    // without "tolerated": the default of check, or ten times the error caused by rounding the initial state
    const auto tolerance = [&](const char* scene) {
        const Outcome outcome = run({"export", scene, "--samples", "2", "--format", "json"});
        return nlohmann::json::parse(outcome.out);
    };
    const nlohmann::json calm = tolerance("free_asymmetric");
    EXPECT_EQ(calm["tolerance"], 0.05);
    const nlohmann::json wild = tolerance("chaotic_top");
    EXPECT_DOUBLE_EQ(wild["tolerance"], std::min(10 * wild["float32_floor"].get<double>(), std::acos(-1.0)));
    EXPECT_GT(wild["tolerance"], 0.05);
}

// Events with their impulses, and the coefficients of the plane. A ball of 1 kg that falls at v rebounds with 2 v for
// restitution 1: the impulse is along the normal.
TEST_F(Export, ContactScenesHaveEventsAndCoefficients) {
    write("ball.json", R"({"name": "bounce", "duration": 1,
        "body": {"shape": {"type": "sphere", "radius": 0.5}, "mass": 1},
        "initial": {"position": [0, 0, 1.75]},
        "planes": [{"name": "floor", "normal": [0, 0, 1], "offset": 0, "restitution": 1, "friction": 0.25,
                    "rolling_friction": 0.5}],
        "loads": [{"type": "gravity", "acceleration": [0, 0, -10]}]})");
    const auto exported = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"export", "ball.json", "--samples", "2"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return outcome.out;
    };
    const nlohmann::json data = nlohmann::json::parse(exported({"--format", "json"}), nullptr, false);
    ASSERT_EQ(data["events"].size(), 1u);
    const auto& event = data["events"][0];
    EXPECT_EQ(event["event"], "impact");
    EXPECT_EQ(event["other"], "floor");
    EXPECT_EQ(event["t"], 0.5);
    EXPECT_EQ(event["normal_impulse"], 10);
    EXPECT_EQ(data["planes"][0]["friction"], 0.25);
    EXPECT_EQ(data["planes"][0]["rolling_friction"], 0.5);
    EXPECT_EQ(data["shape"][0]["radius"], 0.5);
    EXPECT_NEAR(data["event_time_tolerance"].get<double>(), 1.0 / 60, 1e-15);
    // lengths in cm: the impulse and the coefficient of rolling friction are 100 times as large
    const nlohmann::json in_cm =
        nlohmann::json::parse(exported({"--format", "json", "--convention", "centimetres"}), nullptr, false);
    EXPECT_EQ(in_cm["events"][0]["normal_impulse"], 1000);
    EXPECT_EQ(in_cm["planes"][0]["rolling_friction"], 50);
    write("golden.h", exported({"--format", "c"}));
    write("golden.c", R"(#include "golden.h"
int main(void) {
    return polhode_bounce_events == 1 && polhode_bounce_event_t[0] == 0.5 &&
           polhode_bounce_event_normal_impulse[0] == 10 && polhode_bounce_plane_0_friction == 0.25 ? 0 : 1;
})");
    EXPECT_EQ(shell("cc -std=c99 -Wall -Werror golden.c -o golden -lm && ./golden"), 0);
}

TEST_F(Export, SpheresHaveRadiiAndContacts) {
    write("two.json", R"({"name": "two", "duration": 1,
        "bodies": [{"name": "a", "body": {"shape": {"type": "sphere", "radius": 0.5}, "mass": 1},
                    "initial": {"position": [-1, 0, 0], "velocity": [2, 0, 0]}},
                   {"name": "b", "body": {"shape": {"type": "sphere", "radius": 0.25}, "mass": 1},
                    "initial": {"position": [0.75, 0, 0]}}],
        "contacts": [{"first": "a", "second": "b", "restitution": 1, "friction": 0}]})");
    const Outcome outcome = run({"export", "two.json", "--samples", "2", "--format", "json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const nlohmann::json data = nlohmann::json::parse(outcome.out, nullptr, false);
    EXPECT_EQ(data["bodies"][1]["shape"][0]["radius"], 0.25);
    EXPECT_EQ(data["contacts"][0]["restitution"], 1);
    ASSERT_EQ(data["events"].size(), 1u);
    EXPECT_EQ(data["events"][0]["t"], 0.5);
    EXPECT_EQ(data["events"][0]["normal_impulse"], 2);
    ASSERT_EQ(run({"export", "two.json", "--samples", "2", "--format", "cpp", "--output", "two.h"}).exit_code, 0);
    write("two.cpp",
          "#include \"two.h\"\nstatic_assert(polhode_two::radius[1] == 0.25 && "
          "polhode_two::contact_0_second == 1);\nint main() {}\n");
    EXPECT_EQ(shell("c++ -std=c++17 -Wall -Werror -fsyntax-only two.cpp"), 0);
}

// Rounding to binary32 lets a body that touches a plane penetrate it. The body is moved back to the plane.
TEST_F(Export, RollingBodiesHaveABinary32Floor) {
    const Outcome outcome =
        run({"export", "contact/tippe_top", "--duration", "0.25", "--samples", "2", "--format", "json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const nlohmann::json data = nlohmann::json::parse(outcome.out, nullptr, false);
    EXPECT_GT(data["float32_floor"], 1e-9);
    EXPECT_LT(data["float32_floor"], 0.1);
}

// Formulas are exported as text, with the names that they use: a scene of the exported parts has the same motion.
TEST_F(Export, FormulasAreText) {
    write("formula.json", R"json({"name": "formula", "duration": 2, "body": {"mass": 2, "inertia": [1, 2, 2.5]},
        "initial": {"angular_velocity": [0.3, 0.1, 2], "position": [1, 0, 0]}, "parameters": {"k": 0.75},
        "tables": {"gain": {"x": [0, 1, 2], "y": [1, 2, 1], "between": "linear"}}, "let": {"F": "-k*table(gain, t)*p"},
        "loads": [{"type": "force", "frame": "world", "formula": "F"},
                  {"type": "torque", "frame": "body", "formula": "-k*w", "from": 0.5}]})json");
    const Outcome outcome = run({"export", "formula.json", "--samples", "2", "--format", "json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const nlohmann::json data = nlohmann::json::parse(outcome.out, nullptr, false);
    ASSERT_FALSE(data.is_discarded());
    nlohmann::json scene{{"name", "again"}, {"duration", 2}};
    scene["initial"] = {{"angular_velocity", {0.3, 0.1, 2}}, {"position", {1, 0, 0}}};
    for (const char* key : {"body", "parameters", "tables", "let", "loads"}) {
        ASSERT_TRUE(data.contains(key)) << key;
        scene[key] = data[key];
    }
    write("again.json", scene.dump());
    const Outcome again = run({"export", "again.json", "--samples", "2", "--format", "json"});
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(nlohmann::json::parse(again.out)["samples"], data["samples"]);
    EXPECT_NE(data["samples"][2], data["samples"][0]);
    EXPECT_NE(run({"export", "formula.json", "--format", "cpp"}).err.find("which the format cpp cannot represent"),
              std::string::npos);
    EXPECT_NE(
        run({"export", "formula.json", "--format", "json", "--convention", "unity"}).err.find("other axes or units"),
        std::string::npos);
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
