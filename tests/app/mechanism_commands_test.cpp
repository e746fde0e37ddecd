// The commands on scenes of several bodies.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/program_fixture.h"
#include "build_kind.h"
#include "integrators/truth/balls/certified.h"
#include "motion/trajectory_csv.h"
#include "text/npy.h"

namespace polhode {
namespace {

// Two bars on hinges along y, each 1 kg and 1 m long.
constexpr const char* chain = R"({"name": "chain", "duration": 1,
    "bodies": [{"name": "upper", "body": {"mass": 1, "inertia": [0.125, 0.125, 0.0625], "center_of_mass": [0, 0, -0.5]}},
               {"name": "lower", "body": {"mass": 2, "inertia": [0.125, 0.125, 0.0625], "center_of_mass": [0, 0, -0.5]}}],
    "joints": [{"name": "shoulder", "type": "revolute", "parent": "world", "child": "upper", "axis": [0, 1, 0]SHOULDER},
               {"name": "elbow", "type": "revolute", "parent": "upper", "parent_point": [0, 0, -1], "child": "lower",
                "axis": [0, 1, 0]ELBOW}],
    "loads": [{"type": "gravity", "acceleration": [0, 0, -9.75]}]})";

std::string chain_with(const std::string& shoulder, const std::string& elbow) {
    std::string text = chain;
    text.replace(text.find("SHOULDER"), 8, shoulder);
    return text.replace(text.find("ELBOW"), 5, elbow);
}

using CsvRow = std::map<std::string, std::string>;

// The lines of a CSV file, by column name.
std::vector<CsvRow> rows_of(const std::string& text) {
    std::vector<CsvRow> rows;
    std::vector<std::string> names;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        if (line.starts_with('#')) continue;
        std::vector<std::string> cells;
        for (std::size_t at = 0;;) {
            // the last cell is a quoted message
            const std::size_t comma = at < line.size() && line[at] == '"' ? line.npos : line.find(',', at);
            cells.push_back(line.substr(at, comma - at));
            if (comma == line.npos) break;
            at = comma + 1;
        }
        if (names.empty()) {
            names = cells;
            continue;
        }
        EXPECT_EQ(cells.size(), names.size()) << line;
        CsvRow& row = rows.emplace_back();
        for (std::size_t i = 0; i < std::min(names.size(), cells.size()); ++i) row[names[i]] = cells[i];
    }
    return rows;
}

double number(const CsvRow& row, const std::string& column) { return std::stod(row.at(column)); }

class Mechanisms : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        inputs = directory.string() + ".in";
        fs::create_directory(inputs);
        ::setenv("POLHODE_CACHE", (inputs / "cache").c_str(), 1);
        resting = write("resting.json", chain_with("", ""));
        swinging = write("swinging.json",
                         chain_with(R"(, "initial": {"angle": 1.25, "rate": 0.5})", R"(, "initial": {"angle": -0.5})"));
        one = write("one.json", R"({"name": "one", "duration": 1, "body": {"mass": 1, "inertia": [1, 1, 1]}})");
    }
    void TearDown() override {
        ::unsetenv("POLHODE_CACHE");
        fs::remove_all(inputs);
        Program::TearDown();
    }
    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(inputs / name) << text;
        return (inputs / name).string();
    }
    std::string written(const std::string& name) const { return read(directory / name); }
    int shell(const std::string& command) const {
        return std::system(("cd '" + directory.string() + "' && " + command).c_str());  // NOLINT(cert-env33-c)
    }

    fs::path inputs;
    std::string resting, swinging, one;
};

TEST_F(Mechanisms, SolveWritesALineForEachBody) {
    const Outcome outcome = run({"solve", swinging, "--samples", "4"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(outcome.out.starts_with("t,body,qw,"));
    const std::vector<CsvRow> rows = rows_of(outcome.out);
    ASSERT_EQ(rows.size(), 10u);
    for (std::size_t k = 0; k < rows.size(); ++k) EXPECT_EQ(rows[k].at("body"), k % 2 == 0 ? "upper" : "lower");
    // at t = 0, 1.25 rad from hanging: the centre of the upper bar is at half its length
    EXPECT_NEAR(number(rows[0], "px"), -0.5 * std::sin(1.25), 1e-15);
    EXPECT_NEAR(number(rows[0], "pz"), -0.5 * std::cos(1.25), 1e-15);
    EXPECT_NE(outcome.err.find("joint_gap_max"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("joint_turn_max"), std::string::npos) << outcome.err;
}

// At rest each joint carries the weight below it, and all numbers are exact.
TEST_F(Mechanisms, ReactionsAtRestAreWeights) {
    for (const char* command : {"solve", "truth"}) {
        const Outcome outcome =
            run({command, resting, "--samples", "2", "--reactions", "r.csv", "--output", "trajectory.csv"});
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        const std::string text = written("r.csv");
        EXPECT_TRUE(text.starts_with("t,joint,fx,fy,fz,tx,ty,tz\n")) << text;
        const std::vector<CsvRow> rows = rows_of(text);
        ASSERT_EQ(rows.size(), 6u) << command;
        for (std::size_t k = 0; k < rows.size(); ++k) {
            EXPECT_EQ(rows[k].at("joint"), k % 2 == 0 ? "shoulder" : "elbow");
            EXPECT_EQ(number(rows[k], "t"), 0.5 * static_cast<double>(k / 2));
            EXPECT_NEAR(number(rows[k], "fz"), (k % 2 == 0 ? 3 : 2) * 9.75, 1e-13);
            for (const char* zero : {"fx", "fy", "tx", "ty", "tz"}) EXPECT_NEAR(number(rows[k], zero), 0, 1e-13);
        }
    }
}

// Newton's law for the whole system: the force at the shoulder is the rate of the momentum minus the weight.
TEST_F(Mechanisms, ReactionsAccountForTheMomentum) {
    ASSERT_EQ(run({"truth", swinging, "--samples", "2000", "--reactions", "r.csv", "--output", "t.csv"}).exit_code, 0);
    const std::vector<CsvRow> motion = rows_of(written("t.csv")), reactions = rows_of(written("r.csv"));
    ASSERT_EQ(motion.size(), 4002u);
    ASSERT_EQ(reactions.size(), 4002u);
    const auto momentum = [&](std::size_t k, const char* v) {
        return number(motion[2 * k], v) + 2 * number(motion[2 * k + 1], v);
    };
    for (std::size_t k = 100; k < 2000; k += 300)
        for (const auto& [v, f] : {std::pair("vx", "fx"), std::pair("vy", "fy"), std::pair("vz", "fz")}) {
            const double rate = (momentum(k + 1, v) - momentum(k - 1, v)) / (2 * 5e-4);
            EXPECT_NEAR(number(reactions[2 * k], f), rate + (f[1] == 'z' ? 3 * 9.75 : 0), 1e-2) << k << f;
        }
    // solve gives the same reactions
    ASSERT_EQ(run({"solve", swinging, "--samples", "2000", "--reactions", "s.csv", "--output", "s"}).exit_code, 0);
    const std::vector<CsvRow> solved = rows_of(written("s.csv"));
    ASSERT_EQ(solved.size(), reactions.size());
    for (std::size_t k = 0; k < solved.size(); k += 97)
        for (const char* f : {"fx", "fz", "ty"}) EXPECT_NEAR(number(solved[k], f), number(reactions[k], f), 1e-8);
}

// A motor by a formula gives the reactions of the same motor with a constant torque.
TEST_F(Mechanisms, ReactionsIncludeFormulas) {
    const auto with_motor = [&](const std::string& name, const std::string& law) {
        std::string text = chain_with(R"(, "initial": {"angle": 1.25, "rate": 0.5})", "");
        const std::size_t place = text.find(R"("loads": [)") + 10;
        return write(name, text.insert(place, R"({"type": "motor", "joint": "elbow", )" + law + "},"));
    };
    const std::string constant = with_motor("constant.json", R"("torque": 2)"),
                      formula = with_motor("formula.json", R"json("formula": "2*(sin(t)^2 + cos(t)^2)")json");
    const auto reactions = [&](const std::string& scene, const char* method) {
        const Outcome outcome = run({"solve", scene, "--method", method, "--tolerance", "1e-11", "--samples", "8",
                                     "--reactions", "r.csv", "--output", "t.csv"});
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return rows_of(written("r.csv"));
    };
    const std::vector<CsvRow> expected = reactions(constant, "taylor");
    ASSERT_EQ(expected.size(), 18u);
    for (const char* method : {"taylor", "dop853", "cvode_bdf"}) {
        const std::vector<CsvRow> rows = reactions(formula, method);
        ASSERT_EQ(rows.size(), expected.size()) << method;
        for (std::size_t k = 0; k < rows.size(); ++k)
            for (const char* f : {"fx", "fz", "ty"})
                EXPECT_NEAR(number(rows[k], f), number(expected[k], f), 2e-6) << method << " " << k << " " << f;
    }
}

// The positions of the bars, computed from the angles, are those of the trajectory.
TEST_F(Mechanisms, JointCoordinatesDetermineTheMotion) {
    for (const char* command : {"solve", "truth"}) {
        ASSERT_EQ(run({command, swinging, "--samples", "5", "--joints", "j.csv", "--output", "t.csv"}).exit_code, 0);
        const std::vector<CsvRow> motion = rows_of(written("t.csv")), joints = rows_of(written("j.csv"));
        ASSERT_EQ(joints.size(), 12u);
        EXPECT_TRUE(written("j.csv").starts_with("t,joint,coordinate,rate\n0,shoulder,1.25"));
        EXPECT_NEAR(number(joints[0], "rate"), 0.5, 1e-15);
        EXPECT_NEAR(number(joints[1], "coordinate"), -0.5, 1e-15);
        for (std::size_t k = 0; k < 6; ++k) {
            EXPECT_EQ(joints[2 * k].at("joint"), "shoulder");
            EXPECT_EQ(number(joints[2 * k + 1], "t"), static_cast<double>(k) / 5);
            const double a = number(joints[2 * k], "coordinate"), b = a + number(joints[2 * k + 1], "coordinate");
            const double a_rate = number(joints[2 * k], "rate"), b_rate = a_rate + number(joints[2 * k + 1], "rate");
            const CsvRow& lower = motion[2 * k + 1];
            EXPECT_NEAR(number(lower, "px"), -std::sin(a) - std::sin(b) / 2, 1e-14);
            EXPECT_NEAR(number(lower, "pz"), -std::cos(a) - std::cos(b) / 2, 1e-14);
            EXPECT_NEAR(number(lower, "vz"), a_rate * std::sin(a) + b_rate * std::sin(b) / 2, 1e-13);
        }
    }
}

// A rotor without load: its angle is 1000 t, however few the samples, and to all digits of the truth.
TEST_F(Mechanisms, JointAnglesCountRevolutionsBetweenSamples) {
    const std::string rotor = write("rotor.json", R"({"name": "rotor", "duration": 2,
        "bodies": [{"name": "r", "body": {"mass": 1, "inertia": [1, 1, 1]}}],
        "joints": [{"name": "j", "type": "revolute", "parent": "world", "child": "r", "axis": [0, 0, 1],
                    "initial": {"angle": 0.25, "rate": 1000}}]})");
    for (const char* command : {"solve", "truth"}) {
        const Outcome outcome = run({command, rotor, "--samples", "2", "--joints", "j.csv", "--output", "t.csv"});
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        const std::vector<CsvRow> rows = rows_of(written("j.csv"));
        ASSERT_EQ(rows.size(), 3u);
        for (const CsvRow& row : rows) EXPECT_NEAR(number(row, "coordinate"), 0.25 + 1000 * number(row, "t"), 1e-6);
    }
    ASSERT_EQ(run({"truth", rotor, "--samples", "2", "--digits", "25", "--joints", "j.json", "--output", "t.json",
                   "--format", "json"})
                  .exit_code,
              0);
    const nlohmann::json file = nlohmann::json::parse(written("j.json"));
    ASSERT_EQ(file["joints"].size(), 3u);
    // 27 digits, the last ones round-off of 2000.25 = 2000 + 1/4 in the attitude
    EXPECT_EQ(file["joints"][2][2].get<std::string>().substr(0, 25), "2.00025000000000000000000");
    EXPECT_EQ(file["joints"][2][3], "1.00000000000000000000000000e3");
}

// A four-bar linkage: the file has its joints and not its loop, and rates are the derivatives of coordinates.
TEST_F(Mechanisms, JointFilesOmitLoops) {
    for (const char* command : {"solve", "truth"}) {
        std::vector<std::string> arguments{command, "mechanisms/four_bar", "--samples", "200", "--joints", "j.csv"};
        arguments.insert(arguments.end(), {"--output", "t.csv", "--duration", "0.5"});
        const Outcome outcome = run(arguments);
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        const std::vector<CsvRow> rows = rows_of(written("j.csv"));
        ASSERT_EQ(rows.size(), 3 * 201u);
        for (std::size_t k = 3; k + 3 < rows.size(); ++k) {
            EXPECT_EQ(rows[k].at("joint"), rows[k - 3].at("joint"));
            // central differences over 5 ms
            const double rate = (number(rows[k + 3], "coordinate") - number(rows[k - 3], "coordinate")) / 5e-3;
            EXPECT_NEAR(rate, number(rows[k], "rate"), 1e-2 * (1 + std::abs(rate))) << rows[k].at("joint");
        }
    }
}

TEST_F(Mechanisms, JointsAreRefusedWhereThereAreNone) {
    for (const char* command : {"solve", "truth"}) {
        expect_refused({command, one, "--joints", "j.csv"}, "--joints: the scene has no joints");
        expect_refused({command, resting, "--joints", "j.csv", "--output", "j.csv"}, "name the same file");
        expect_refused({command, resting, "--joints", "j.csv", "--reactions", "j.csv"}, "name the same file");
        expect_refused({command, resting, "--joints", "no/such/place.csv"}, "no/such/place.csv");
    }
    expect_refused({"truth", resting, "--certified", "--joints", "j.csv"}, "certified joint coordinates");
    expect_refused({"truth", resting, "--digits", "40", "--joints", "j.csv"}, "give at most 28");
}

TEST_F(Mechanisms, ReactionsAreRefusedWhereThereAreNone) {
    for (const char* command : {"solve", "truth"}) {
        expect_refused({command, one, "--reactions", "r.csv"}, "--reactions: the scene has neither joints nor loops");
        expect_refused({command, resting, "--reactions", "r.csv", "--output", "r.csv"}, "name the same file");
        expect_refused({command, resting, "--reactions", "no/such/place.csv"}, "no/such/place.csv");
    }
    const std::string free_body = write(
        "free.json",
        R"({"name": "free", "duration": 1, "bodies": [{"name": "a", "body": {"mass": 1, "inertia": [1, 1, 1]}}], "joints": []})");
    expect_refused({"solve", free_body, "--reactions", "r.csv"}, "neither joints nor loops");
}

TEST_F(Mechanisms, OneBodyMethodsReportUnsupported) {
    const Outcome outcome = run({"solve", resting, "--method", "splitting4"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.err.find("unsupported: splitting4 supports only scenes of one body"), std::string::npos)
        << outcome.err;
}

TEST_F(Mechanisms, CertifiedDigitsHaveALineForEachBody) {
    if (ball_arithmetic_version().empty()) GTEST_SKIP() << "built without Arb";
    const std::vector<std::string> asked{"truth", swinging, "--samples", "2", "--digits", "20"};
    std::vector<std::string> proven = asked;
    proven.emplace_back("--certified");
    const Outcome agreed = run(asked), certified = run(proven);
    ASSERT_EQ(certified.exit_code, 0) << certified.err;
    EXPECT_NE(certified.err.find("proven"), std::string::npos) << certified.err;
    const std::vector<CsvRow> a = rows_of(agreed.out), b = rows_of(certified.out);
    ASSERT_EQ(a.size(), 6u);
    ASSERT_EQ(b.size(), 6u);
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].at("body"), b[i].at("body"));
        for (const char* name : {"t", "qw", "qy", "wy", "px", "vz"})
            EXPECT_NEAR(number(a[i], name), number(b[i], name), 1e-13) << name;
        EXPECT_LE(number(b[i], "bound"), 1e-20);
    }
    proven.insert(proven.end(), {"--format", "json"});
    const nlohmann::json told = nlohmann::json::parse(run(proven).out);
    EXPECT_EQ(told["columns"][1], "body");
    ASSERT_EQ(told["samples"].size(), 6u);
    EXPECT_EQ(told["samples"][1][1], "lower");
    EXPECT_EQ(told["samples"][1].size(), told["columns"].size());
}

TEST_F(Mechanisms, RefusesOneBodyOptions) {
    expect_refused({"describe", resting, "--picture", "p.svg"}, "a polhode is drawn for one body");
    expect_refused({"solve", resting, "--full"}, "--full: the full formulation supports one body");
    expect_refused({"truth", resting, "--certified", "--reactions", "r.csv"},
                   "--reactions: certified reactions are not available");
    const std::string experiment =
        write("e.json", R"({"name": "e", "about": "", "kind": "conservation", "methods": ["taylor"], "scenes": [")" +
                            resting + R"("], "settings": {"evaluations_per_revolution": [100]}})");
    expect_refused({"run", experiment, "--dry-run"}, "experiments of kind conservation support only one");
}

TEST_F(Mechanisms, DescribeDrawsTheTree) {
    const Outcome outcome = run({"describe", swinging});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string& text = outcome.out;
    for (const char* part : {"  world\n    shoulder: revolute about (0, 1, 0) -> upper, 1 kg; at 1.25 rad, 0.5 rad/s\n"
                             "      elbow: revolute about (0, 1, 0) -> lower, 2 kg; at -0.5 rad, 0 rad/s\n",
                             "degrees of freedom          2\n", "several bodies, 4 variables",
                             "the third dimension         all bodies move in planes", "p and v of the base",
                             "22 variables", "\n  energy   ", "\n  kappa(T)", "floor in binary32"})
        EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
    EXPECT_EQ(text.find("angular momentum"), std::string::npos) << text;
}

TEST_F(Mechanisms, DescribePrintsInvariants) {
    // a hinge along gravity through the origin conserves L about it; a damper conserves neither L nor the energy
    const auto table = [&](const std::string& more) {
        const std::string scene = write("table.json", R"({"name": "table", "duration": 1,
            "bodies": [{"name": "disc", "body": {"mass": 2, "inertia": [1, 1, 1.5]}},
                       {"name": "bead", "body": {"mass": 1, "inertia": [0.5, 0.5, 0.5]}}],
            "joints": [{"name": "post", "type": "revolute", "parent": "world", "child": "disc", "axis": [0, 0, 1],
                        "initial": {"rate": 2})" + more + R"(},
                       {"name": "slot", "type": "prismatic", "parent": "disc", "child": "bead", "axis": [1, 0, 0],
                        "initial": {"displacement": 1}}],
            "loads": [{"type": "gravity", "acceleration": [0, 0, -9.75]}]})");
        const Outcome outcome = run({"describe", scene});
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return outcome.out;
    };
    const std::string kept = table("");
    // L = (1.5 + 0.5 + 1 1^2) 2 about the post, E = 3 2^2 / 2
    EXPECT_NE(kept.find("angular momentum along u    6; L . u about the world's origin"), std::string::npos) << kept;
    EXPECT_NE(kept.find("energy                      6; E"), std::string::npos) << kept;
    const std::string lost = table(R"(, "damping": 0.5)");
    EXPECT_NE(lost.find("none known"), std::string::npos) << lost;
    EXPECT_NE(lost.find("damping 0.5"), std::string::npos) << lost;
}

TEST_F(Mechanisms, DescribeCountsWhatLoopsTake) {
    const Outcome outcome = run({"describe", "mechanisms/four_bar"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("5 conditions: 2 independent at the start, 3 redundant"), std::string::npos)
        << outcome.out;
    EXPECT_NE(outcome.out.find("mobility                    1: 3 of the tree minus 2 independent loop conditions"),
              std::string::npos)
        << outcome.out;
}

// Two point masses on massless strings and a rod fixed by a massless bracket work with every command.
TEST_F(Mechanisms, EveryCommandTakesPointMassesAndMasslessBodies) {
    const std::string scene = write("points.json", R"({"name": "points", "duration": 1,
        "bodies": [{"name": "upper", "body": {"points": [[1, 0, 0, -1]]}},
                   {"name": "lower", "body": {"mass": 0.5, "inertia": [0, 0, 0], "center_of_mass": [0, 0, -0.75]}},
                   {"name": "bracket", "body": {"mass": 0}},
                   {"name": "bar", "body": {"shape": {"type": "rod", "length": 0.5}, "mass": 0.25}}],
        "joints": [{"name": "shoulder", "type": "revolute", "parent": "world", "child": "upper", "axis": [0, 1, 0],
                    "initial": {"angle": 1}},
                   {"name": "elbow", "type": "revolute", "parent": "upper", "parent_point": [0, 0, -1], "child": "lower",
                    "axis": [0, 1, 0], "initial": {"rate": 1}},
                   {"name": "mount", "type": "fixed", "parent": "upper", "child": "bracket"},
                   {"name": "pin", "type": "revolute", "parent": "bracket", "parent_point": [0.25, 0, -0.5],
                    "child": "bar", "axis": [0, 1, 0], "child_point": [0, 0, 0.25]}],
        "loads": [{"type": "gravity", "acceleration": [0, 0, -9.75]}]})");
    const Outcome page = run({"describe", scene});
    ASSERT_EQ(page.exit_code, 0) << page.err;
    for (const char* words : {"total mass 1.75 kg", "0 kg", "kappa(T)"})
        EXPECT_NE(page.out.find(words), std::string::npos) << words << page.out;
    for (const char* not_a_number : {"nan", "inf,"}) EXPECT_EQ(page.out.find(not_a_number), std::string::npos);
    ASSERT_EQ(run({"truth", scene, "--samples", "4", "--output", "truth.csv"}).exit_code, 0);
    for (const char* method : {"auto", "taylor", "dop853", "radau", "ida_index1", "variational_tree"}) {
        const Outcome solved = run({"solve", scene, "--method", method, "--samples", "4", "--output", "t.csv"});
        ASSERT_EQ(solved.exit_code, 0) << method << solved.err;
        const Outcome checked = run({"check", scene, "t.csv", "--max-attitude", "1e-4"});
        EXPECT_EQ(checked.exit_code, 0) << method << checked.out << checked.err;
    }
    const Outcome engine = run({"solve", scene, "--method", "soft_step_4", "--samples", "4"});
    EXPECT_EQ(engine.exit_code, 1);
    EXPECT_NE(engine.err.find("body \"upper\" has a moment of inertia of zero, and the method divides by it"),
              std::string::npos)
        << engine.err;
    ASSERT_EQ(run({"export", scene, "--samples", "4", "--output", "golden.csv"}).exit_code, 0);
    EXPECT_EQ(run({"check", scene, "golden.csv", "--max-attitude", "1e-14"}).exit_code, 0);
    const Outcome json = run({"export", scene, "--samples", "4", "--format", "json"});
    ASSERT_EQ(json.exit_code, 0) << json.err;
    EXPECT_EQ(json.out.find("nan"), std::string::npos);
    EXPECT_FALSE(nlohmann::json::parse(json.out).empty());
}

TEST_F(Mechanisms, CheckPassesWhatSolveWrites) {
    ASSERT_EQ(run({"solve", swinging, "--samples", "10", "--output", "t.csv"}).exit_code, 0);
    const Outcome outcome = run({"check", swinging, "t.csv", "--max-attitude", "1e-10"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
}

TEST_F(Mechanisms, EnsembleSolvesEachStart) {
    const std::string table = write("starts.csv",
                                    "id,shoulder.angle,shoulder.rate,elbow.angle,lower.mass\na,1.25,0.5,-0.5,2\n"
                                    "b,x,0,0,1\nc,0,0,0,-1\nd,0.25,0,0,3\n");
    const Outcome outcome = run({"ensemble", swinging, "--initial", table, "--samples", "2"});
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    const std::vector<CsvRow> rows = rows_of(outcome.out);
    ASSERT_EQ(rows.size(), 10u) << outcome.out;
    // the first row equals the scene
    const Outcome alone = run({"solve", swinging, "--samples", "2"});
    const std::vector<CsvRow> solved = rows_of(alone.out);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(rows[i].at("row") + rows[i].at("id") + rows[i].at("status"), "1aok");
        EXPECT_EQ(rows[i].at("body"), solved[2 + i].at("body"));
        for (const char* column : {"t", "qw", "qy", "wy", "px", "pz", "vx", "vz"})
            EXPECT_NEAR(number(rows[i], column), number(solved[2 + i], column), 1e-12) << column;
    }
    EXPECT_EQ(rows[4].at("row") + rows[4].at("status"), "2failed");
    EXPECT_NE(rows[4].at("message").find("line 3"), std::string::npos) << rows[4].at("message");
    EXPECT_EQ(rows[5].at("row") + rows[5].at("status"), "3failed");
    // a different mass, compared with a scene that has this mass
    std::string text = chain_with(R"(, "initial": {"angle": 0.25})", R"(, "initial": {"angle": 0})");
    text.replace(text.find("\"mass\": 2"), 9, "\"mass\": 3");
    const std::vector<CsvRow> heavy = rows_of(run({"solve", write("heavy.json", text), "--samples", "1"}).out);
    EXPECT_EQ(rows[9].at("row") + rows[9].at("id") + rows[9].at("body"), "4dlower");
    for (const char* column : {"qw", "qy", "wy", "px", "pz"})
        EXPECT_NEAR(number(rows[9], column), number(heavy[3], column), 1e-9) << column;
    // the result is the same for any number of threads
    EXPECT_EQ(run({"ensemble", swinging, "--initial", table, "--samples", "2", "--threads", "3"}).out, outcome.out);
}

// Rows that differ only in their initial states share one right-hand side, one row per lane. Each row equals the scene
// with this initial state.
TEST_F(Mechanisms, EnsembleOfStartsAlone) {
    const std::string scene = write("struck.json", [] {
        std::string text = chain_with(R"(, "initial": {"angle": 0.5})", R"(, "initial": {"angle": 0.25})");
        text.replace(
            text.find(R"("loads": [)"), 10,
            R"("loads": [{"type": "impulse", "body": "lower", "vector": [0.25, 0, 0.125], "frame": "world", "point": [0, 0, -0.25], "at": 0.4},
                         {"type": "force", "body": "upper", "vector": [0.5, 0, 0.25], "frame": "world", "point": [0, 0, -0.5], "from": 0.2, "until": 0.7}, )");
        return text;
    }());
    std::string table = "shoulder.angle,shoulder.rate,elbow.angle\n0.5,0,0.25\n";
    for (int k = 0; k < 20; ++k) table += fmt::format("{},{},{}\n", 0.1 * k - 1, 0.05 * k, 1 - 0.1 * k);
    const std::string starts = write("starts.csv", table);
    const Outcome outcome = run({"ensemble", scene, "--initial", starts, "--samples", "3"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::vector<CsvRow> rows = rows_of(outcome.out);
    ASSERT_EQ(rows.size(), 21u * 3 * 2);
    const std::vector<CsvRow> solved = rows_of(run({"solve", scene, "--samples", "3"}).out);
    for (std::size_t i = 0; i < 6; ++i)
        for (const char* column : {"t", "qw", "qy", "wy", "px", "pz", "vx", "vz"})
            EXPECT_NEAR(number(rows[i], column), number(solved[2 + i], column), 1e-8) << column << i;
    // with a further column, all rows are solved one by one
    std::string other = table;
    other.replace(0, other.find('\n'), "shoulder.angle,shoulder.rate,elbow.angle,lower.mass");
    for (std::size_t at = other.find('\n', other.find('\n') + 1); at != std::string::npos;
         at = other.find('\n', at + 3))
        other.insert(at, ",2");
    const Outcome alone = run({"ensemble", scene, "--initial", write("other.csv", other), "--samples", "3"});
    ASSERT_EQ(alone.exit_code, 0) << alone.err;
    const std::vector<CsvRow> apart = rows_of(alone.out);
    ASSERT_EQ(apart.size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (const char* column : {"qw", "qy", "wy", "px", "pz"})
            EXPECT_NEAR(number(rows[i], column), number(apart[i], column), 1e-7) << column << i;
    EXPECT_EQ(run({"ensemble", scene, "--initial", starts, "--samples", "3", "--threads", "3"}).out, outcome.out);
}

// Initial states of the swinging chain as CSV or NumPy structured array; in every `bad`-th row the angle is infinite.
std::string table_of_starts(bool npy, int rows, int bad) {
    std::string text = "id,elbow.angle,shoulder.angle\n";
    if (npy)
        text = write_npy_header({{"id", "|S7"}, {"elbow.angle", "<f8"}, {"shoulder.angle", "<f8"}},
                                static_cast<std::uint64_t>(rows));
    for (int k = 1; k <= rows; ++k) {
        std::string id = fmt::format("s{}", k);
        const double angles[2] = {k % bad == 0 ? HUGE_VAL : 1 - 0.625 * k / rows, 0.3 * k / rows - 1};
        if (!npy) {
            text += fmt::format("{},{},{}\n", id, angles[0], angles[1]);
            continue;
        }
        id.resize(7);
        text.append(id).append(reinterpret_cast<const char*>(angles), sizeof angles);
    }
    return text;
}

// Both input and output formats give the same motions bit for bit.
TEST_F(Mechanisms, EnsembleReadsAndWritesNumpysFormat) {
    const std::string csv = write("t.csv", table_of_starts(false, 300, 100)),
                      npy = write("t.npy", table_of_starts(true, 300, 100));
    const Outcome from_csv = run({"ensemble", swinging, "--initial", csv, "--samples", "2"});
    const Outcome from_npy = run({"ensemble", swinging, "--initial", npy, "--samples", "2"});
    ASSERT_EQ(from_csv.exit_code, 1);
    ASSERT_EQ(from_npy.exit_code, 1);
    std::vector<CsvRow> rows = rows_of(from_csv.out);
    ASSERT_EQ(rows.size(), 297u * 4 + 3);
    EXPECT_EQ(rows[99 * 4].at("message"),
              "\"" + csv + ": line 101, column elbow.angle: inf is not finite; give a finite number\"");
    const std::vector<CsvRow> others = rows_of(from_npy.out);
    ASSERT_EQ(others.size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows[i].at("status") == "failed") rows[i]["message"] = others[i].at("message");
        EXPECT_EQ(rows[i], others[i]) << i;
    }
    ASSERT_EQ(run({"ensemble", swinging, "--initial", npy, "--samples", "2", "--output", "o.npy"}).exit_code, 1);
    const std::string out = written("o.npy");
    const NpyHeader header = parse_npy_header(out, out.size(), "o.npy");
    std::vector<std::string> fields;
    for (const NpyField& field : header.fields) fields.push_back(field.name + field.type);
    EXPECT_EQ(fmt::format("{}", fmt::join(fields, " ")),
              "row<i8 status<i8 t<f8 qw<f8 qx<f8 qy<f8 qz<f8 wx<f8 wy<f8 wz<f8 px<f8 py<f8 pz<f8 vx<f8 vy<f8 vz<f8 "
              "body|S5 id|S7");
    ASSERT_EQ(header.rows, rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (const NpyField& field : header.fields) {
            const char* const at = out.data() + header.data_offset + i * header.record_size + field.offset;
            const std::string& cell = rows[i].at(field.name);
            double real = 0;
            std::int64_t whole = 0;
            std::memcpy(&real, at, std::min(sizeof real, field.size)),
                std::memcpy(&whole, at, std::min(sizeof whole, field.size));
            if (field.type == "<f8")
                EXPECT_TRUE(cell.empty() ? std::isnan(real) : real == std::stod(cell)) << i << field.name;
            else if (field.name == "status")
                EXPECT_EQ(name_of(static_cast<Status>(whole)), cell) << i;
            else
                EXPECT_EQ(field.type == "<i8" ? std::to_string(whole) : std::string(at, ::strnlen(at, field.size)),
                          cell)
                    << i;
        }
}

TEST_F(Mechanisms, EnsembleHasTheSameBytesInPiecesAndParts) {
    for (const bool npy : {false, true}) {
        const std::string ending = npy ? ".npy" : ".csv", table = write("t" + ending, table_of_starts(npy, 700, 69));
        const auto solve = [&](const std::string& output, const std::vector<std::string>& more) {
            std::vector<std::string> arguments{"ensemble",  swinging, "--initial", table,
                                               "--samples", "2",      "--output",  output + ending};
            arguments.insert(arguments.end(), more.begin(), more.end());
            EXPECT_EQ(run(arguments).exit_code, 1);
        };
        solve("whole", {"--threads", "1"});
        solve("pieces", {"--threads", "3", "--rows-at-once", "1"});
        EXPECT_EQ(written("pieces" + ending), written("whole" + ending));
        for (const char* shard : {"2/3", "1/3", "3/3"}) solve("parts", {"--shard", shard, "--rows-at-once", "500"});
        const Outcome merged = run({"merge", directory.string(), "--output", "merged" + ending});
        EXPECT_EQ(merged.exit_code, 1) << merged.err;
        EXPECT_EQ(written("merged" + ending), written("whole" + ending));
        for (const auto& file : fs::directory_iterator(directory)) fs::remove(file);
    }
}

// 22 MiB of output, whose samples and text would need twice as much memory: only pieces of the table are kept.
TEST_F(Mechanisms, EnsembleTakesTablesOfAnyLength) {
    if (!optimised_build) GTEST_SKIP() << "sanitizers need additional memory";
    const std::string table = write("t.npy", table_of_starts(true, 80'000, 1'000'000));
    const Outcome outcome = run({"ensemble", swinging, "--initial", table, "--duration", "1e-3", "--tolerance", "1e-3",
                                 "--threads", "1", "--output", "o.npy"},
                                [] {
                                    const rlimit small{24 << 20, 24 << 20};
                                    ::setrlimit(RLIMIT_DATA, &small);
                                });
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string out = written("o.npy");
    EXPECT_EQ(parse_npy_header(out, out.size(), "o.npy").rows, 160'000u);
}

TEST_F(Mechanisms, EnsembleRefusesOtherColumns) {
    expect_refused({"ensemble", swinging, "--initial", write("t.csv", "wx,wy,wz\n1,2,3\n")}, "t.csv");
    expect_refused({"ensemble", swinging, "--initial", write("t.csv", "shoulder.speed\n1\n")}, "shoulder.speed");
    expect_refused({"ensemble", swinging, "--initial", write("t.csv", "shoulder.angle\n")}, "has a header but no rows");
}

TEST_F(Mechanisms, EnsembleReportsOpenLoops) {
    const Outcome outcome = run({"ensemble", "mechanisms/four_bar", "--initial",
                                 write("t.csv", "main_bearing.angle\n0\n0.5\n"), "--duration", "0.5"});
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    const std::vector<CsvRow> rows = rows_of(outcome.out);
    ASSERT_EQ(rows.size(), 4u) << outcome.out;
    EXPECT_EQ(rows[2].at("status"), "ok");
    EXPECT_EQ(rows[3].at("status"), "failed");
    EXPECT_NE(rows[3].at("message"), "");
}

// Every type of joint, with springs, dampers or motors.
constexpr const char* all_joints = R"({"name": "all joints", "about": "every kind", "duration": 0.5,
    "bodies": [{"name": "a", "body": {"mass": 1, "inertia": [[0.5, 0.05, 0], [0.05, 0.5, 0], [0, 0, 0.625]], "center_of_mass": [0, 0.25, -0.5]}},
               {"name": "b", "body": {"mass": 2, "inertia": [0.5, 0.75, 0.625], "center_of_mass": [0.25, 0, -0.5]}},
               {"name": "c", "body": {"mass": 1, "inertia": [0.5, 0.75, 0.625], "center_of_mass": [0, 0, -0.25]}},
               {"name": "d", "body": {"mass": 1, "inertia": [0.5, 0.75, 0.625], "center_of_mass": [0, 0.25, 0]}}],
    "joints": [{"name": "hinge", "type": "revolute", "parent": "world", "child": "a", "axis": [0, 0.6, 0.8],
                "parent_point": [0.5, 0.25, 0], "stiffness": 2, "rest": 0.25, "damping": 0.125,
                "initial": {"angle": 0.5, "rate": 1}},
               {"name": "slide", "type": "prismatic", "parent": "a", "child": "b", "axis": [0.6, 0, 0.8],
                "parent_point": [0, 0, -1], "stiffness": 20, "rest": 0.125, "damping": 0.5,
                "initial": {"displacement": 0.25, "speed": -0.5}},
               {"name": "ball", "type": "spherical", "parent": "b", "child": "c", "parent_point": [0, 0.25, -1],
                "stiffness": 3, "damping": 0.25, "rest": [0.8, 0, 0.6, 0],
                "initial": {"orientation": [0.8, 0.6, 0, 0], "angular_velocity": [0.25, 0.5, 1]}},
               {"name": "cross", "type": "universal", "parent": "c", "child": "d", "parent_point": [0, 0, -0.5],
                "parent_orientation": [0.6, 0, 0, 0.8], "axes": [[1, 0, 0], [0, 1, 0]], "stiffness": [2, 3],
                "rest": [0.5, 0], "damping": [0.125, 0.25], "initial": {"angles": [0.25, -0.5], "rates": [1, 0.5]}}],
    "loads": [{"type": "gravity", "acceleration": [0, 0.5, -9.75]},
              {"type": "motor", "joint": "hinge", "torque": 0.75}, {"type": "motor", "joint": "slide", "force": 1.5},
              {"type": "torque", "body": "b", "vector": [0.5, 0.25, 1], "frame": "body"},
              {"type": "force", "body": "d", "vector": [0, 0.5, 1], "frame": "world", "point": [0.25, 0, 0.5]},
              {"type": "drag", "body": "c", "rotational": [0.125, 0.25, 0.5], "translational": 0.25},
              {"type": "spring", "body": "d", "stiffness": 1.5, "rest_orientation": [0.8, 0, 0, 0.6]},
              {"type": "point_spring", "first": "a", "first_point": [0, 0.5, 0], "second": "world",
               "second_point": [1, 0, 0.5], "stiffness": 5, "rest_length": 0.25}]})";

// The exported scene, in any axes and unit of length, solved as it is, gives the exported samples.
TEST_F(Mechanisms, TheExportedSceneMovesAsExported) {
    const std::string scene = write("all.json", all_joints);
    for (const char* words : {"y-up", "unity", "unreal", "left-handed,inches"}) {
        const Outcome outcome = run({"export", scene, "--samples", "3", "--format", "json", "--convention", words});
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        const nlohmann::json data = nlohmann::json::parse(outcome.out);
        ASSERT_EQ(data["samples"].size(), 16u);
        ASSERT_EQ(data["energy"].size(), 4u);
        ASSERT_EQ(data["reaction_forces"].size(), 16u);
        nlohmann::json given{{"name", "given"},
                             {"duration", 0.5},
                             {"bodies", data["bodies"]},
                             {"joints", data["joints"]},
                             {"loads", data["loads"]}};
        // quaternions in scene files start with the scalar
        const bool last = data["columns"][5] == "qw";
        ASSERT_EQ(data["columns"][1], "body");
        if (last)
            for (nlohmann::json* list : {&given["joints"], &given["loads"]})
                for (nlohmann::json& entry : *list) {
                    const auto turn = [](nlohmann::json& q) {
                        if (q.is_array() && q.size() == 4) std::rotate(q.begin(), q.begin() + 3, q.end());
                    };
                    for (const char* key : {"parent_orientation", "rest", "rest_orientation"})
                        if (entry.contains(key)) turn(entry[key]);
                    if (entry.contains("initial") && entry["initial"].contains("orientation"))
                        turn(entry["initial"]["orientation"]);
                }
        const std::string again = write("given.json", given.dump());
        const Outcome truth = run({"truth", again, "--samples", "3"});
        ASSERT_EQ(truth.exit_code, 0) << truth.err << given.dump();
        const std::vector<CsvRow> rows = rows_of(truth.out);
        for (std::size_t k = 0; k < rows.size(); ++k) {
            // q and -q are the same attitude
            double same = 0;
            for (std::size_t i = 2; i < 6; ++i) {
                const std::string column = data["columns"][i];
                same += number(rows[k], column) * data["samples"][k][i].get<double>();
            }
            EXPECT_NEAR(std::abs(same), 1, 1e-12) << words << k;
            for (std::size_t i = 9; i < 15; ++i) {
                const std::string column = data["columns"][i];
                const double expected = data["samples"][k][i];
                EXPECT_NEAR(number(rows[k], column), expected, 1e-11 * std::max(1.0, std::abs(expected)))
                    << words << k << column;
            }
        }
    }
}

TEST_F(Mechanisms, ExportedCsvPasses) {
    ASSERT_EQ(run({"export", swinging, "--samples", "9", "--output", "golden.csv"}).exit_code, 0);
    EXPECT_TRUE(rows_of(written("golden.csv"))[1].at("body") == "lower");
    const Outcome outcome = run({"check", swinging, "golden.csv", "--max-attitude", "1e-14"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
}

// The headers compile without warnings. The sample of a body passes; the sample of another body does not.
TEST_F(Mechanisms, HeadersCompileAndCompare) {
    const std::string scene = write("all.json", all_joints);
    for (const auto& [format, file] : {std::pair("c", "golden.h"), std::pair("cpp", "golden.hpp")})
        ASSERT_EQ(run({"export", scene, "--samples", "3", "--format", format, "--output", file}).exit_code, 0);
    std::ofstream(directory / "main.c") << R"(
#include "golden.h"
#define P(x) polhode_all_joints_##x
int main(void) {
    char message[1000];
    int k, body, failed = 0;
    for (k = 0; k < P(samples); ++k)
        for (body = 0; body < P(bodies); ++body) {
            const int row = k * P(bodies) + body;
            failed += P(compare)((size_t)k, (size_t)body, P(q)[row], P(w)[row], P(p)[row], P(v)[row], &P(energy)[k],
                                 P(momentum)[k], message, sizeof message);
        }
    if (failed != 0) return 1;
    if (P(compare)(1, P(body_a), P(q)[P(body_d)], 0, P(p)[P(body_d)], 0, 0, 0, message, sizeof message) != 2) return 2;
    if (P(bodies) != 4 || P(joints) != 4 || (int)P(joint_slide_parent) != (int)P(body_a) || P(joint_hinge_parent) != -1) return 3;
    if (P(mass)[P(body_b)] != 2 || P(joint_slide_initial_displacement) != 0.25 || P(motor_1_joint) != 0) return 4;
    if (P(joint_cross_axes)[1][1] != 1 || P(inertia)[0][1] != 0.05) return 5;
    return sizeof P(reaction_force) / sizeof P(reaction_force)[0] == 16 ? 0 : 6;
}
)";
    std::ofstream(directory / "main.cpp") << R"(
#include "golden.hpp"
int main() {
    namespace g = polhode_all_joints;
    for (std::size_t k = 0; k < g::samples; ++k)
        for (std::size_t body = 0; body < g::bodies; ++body) {
            const std::size_t row = k * g::bodies + body;
            if (!g::compare(k, body, g::q[row].data(), g::w[row].data(), g::p[row].data()).empty()) return 1;
        }
    return g::compare(1, g::body_a, g::q[g::body_d].data()).empty() ? 2 : 0;
}
)";
    EXPECT_EQ(shell("cc -std=c99 -Wall -Wextra -Werror -pedantic main.c -lm -o in_c && ./in_c"), 0)
        << read(directory / "golden.h");
    EXPECT_EQ(shell("c++ -std=c++17 -Wall -Wextra -Werror -pedantic main.cpp -o in_cpp && ./in_cpp"), 0)
        << read(directory / "golden.hpp");
    const Outcome sharp = run({"export", scene, "--samples", "3", "--format", "cs"});
    ASSERT_EQ(sharp.exit_code, 0) << sharp.err;
    EXPECT_NE(sharp.out.find("compare(int k, int body, double[] own_q"), std::string::npos);
    EXPECT_EQ(sharp.out.find("q[k, "), std::string::npos);
}

}  // namespace
}  // namespace polhode
