// polhode check: verdicts, exit codes and formats.
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/program_fixture.h"
#include "bad_files.h"
#include "build_kind.h"
#include "motion/trajectory_csv.h"
#include "motion/written_tables.h"
#include "places.h"
#include "text/decimal.h"

namespace polhode {
namespace {

// A body that spins about its axis z at 2 rad/s, thrown at (1, 0, 0) m/s: q = (cos t, 0, 0, sin t), p = (t, 0, 0).
class Check : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        ::setenv("POLHODE_CACHE", (directory / "cache").c_str(), 1);
        write("spin.json", scene(""));
        write("judged.json", scene(R"(, "tolerated": {"attitude": 1e-3})"));
    }
    void TearDown() override {
        ::unsetenv("POLHODE_CACHE");
        Program::TearDown();
    }

    static std::string scene(const std::string& more) {
        return R"({"name": "spin", "duration": 4, "body": {"mass": 2, "inertia": [1, 2, 2.5], "center_of_mass": [0.5, 0, 0]},
                   "initial": {"angular_velocity": [0, 0, 2], "velocity": [1, 0, 0]})" +
               more + "}";
    }
    void write(const std::string& name, const std::string& text) const { std::ofstream(directory / name) << text; }

    // the motion at these times; the last attitude is rotated by `angle` relative to the truth
    static TrajectoryFile motion(const std::vector<double>& times, double angle = 0) {
        TrajectoryFile file;
        file.has_angular_velocity = file.has_position = file.has_velocity = true;
        for (const double t : times) {
            const double half = t + (t == times.back() ? angle / 2 : 0);
            file.rows.push_back({t, {std::cos(half), 0, 0, std::sin(half)}, {0, 0, 2}, {t, 0, 0}, {1, 0, 0}});
        }
        return file;
    }
    nlohmann::json checked(const TrajectoryFile& file) const {
        write("run.csv", write_trajectory(file));
        const Outcome outcome = run({"check", "spin.json", "run.csv", "--format", "json", "--report-only"});
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_EQ(without_notice(outcome.err), "");
        const auto report = nlohmann::json::parse(outcome.out, nullptr, false);
        return report.is_discarded() ? nlohmann::json() : report["trajectories"][0];
    }
};

const std::vector<double> odd_times{0.125, 0.3, 1, 1.0625, 3.9};

TEST_F(Check, MeasuresWhatTheFileIsWrongBy) {
    TrajectoryFile file = motion(odd_times, 1e-4);
    file.rows[2].angular_velocity_W[0] = 0.002;  // of 2 rad/s
    file.rows[1].position_W[1] = 0.25;
    file.rows[1].velocity_W[2] = -0.5;
    file.rows[3].q = {1.25 * std::cos(1.0625), 0, 0, 1.25 * std::sin(1.0625)};
    const auto report = checked(file);
    EXPECT_EQ(report["verdict"], "reported");
    EXPECT_EQ(report["samples"], 5);
    EXPECT_EQ(report["attitude_error_max_time"], 3.9);
    EXPECT_NEAR(report["attitude_error_max"], 1e-4, 1e-15);
    EXPECT_NEAR(report["attitude_error_final"], 1e-4, 1e-15);
    EXPECT_NEAR(report["omega_error_max"], 1e-3, 1e-15);
    EXPECT_NEAR(report["position_error_max"], 0.25, 1e-15);
    EXPECT_NEAR(report["velocity_error_max"], 0.5, 1e-15);
    EXPECT_NEAR(report["norm_error_max"], 0.25, 1e-15);
    // E = 5 J of rotation and 1 J of translation; the velocity error adds 2 (0.5)^2 / 2 J
    EXPECT_NEAR(report["energy_error_max"], 0.25 / 6, 1e-14);
    // L = 5 kg m^2/s along z; error I_xx' 0.002 in the rotated body axes, with I_xx' between 1 and 2 kg m^2
    EXPECT_GT(report["momentum_error_max"], 0.002 / 5);
    EXPECT_LT(report["momentum_error_max"], 0.004 / 5);
}

TEST_F(Check, AFileOfTheTruthIsExactToRounding) {
    const auto report = checked(motion(odd_times));
    for (const char* name : {"attitude_error_max", "omega_error_max", "energy_error_max", "momentum_error_max",
                             "position_error_max", "velocity_error_max", "norm_error_max"})
        EXPECT_LT(report[name], 1e-15) << name;
}

TEST_F(Check, ComparesOnlyBlocksInTheFile) {
    TrajectoryFile file = motion(odd_times);
    file.has_angular_velocity = file.has_position = file.has_velocity = false;
    const auto bare = checked(file);
    for (const char* name : {"omega_error_max", "energy_error_max", "momentum_error_max", "position_error_max"})
        EXPECT_TRUE(bare[name].is_null()) << name;
    EXPECT_LT(bare["attitude_error_max"], 1e-15);
    // the body's origin, at x = -0.5 m from the centre of mass in body axes
    file.has_origin = true;
    for (TrajectoryRow& row : file.rows)
        row.position_W = {row.t - 0.5 * std::cos(2 * row.t), -0.5 * std::sin(2 * row.t), 0};
    const auto with_origin = checked(file);
    EXPECT_LT(with_origin["position_error_max"], 1e-15);
    EXPECT_TRUE(with_origin["energy_error_max"].is_null());
}

TEST_F(Check, ALimitDecidesTheExitCode) {
    write("good.csv", write_trajectory(motion(odd_times, 1e-6)));
    write("bad.csv", write_trajectory(motion(odd_times, 2e-3)));
    EXPECT_EQ(run({"check", "spin.json", "bad.csv"}).exit_code, 0);
    write("worse.csv", write_trajectory(motion(odd_times, 0.1)));
    EXPECT_EQ(run({"check", "spin.json", "worse.csv"}).exit_code, 1);
    EXPECT_EQ(run({"check", "spin.json", "worse.csv", "--report-only"}).exit_code, 0);
    EXPECT_EQ(run({"check", "judged.json", "good.csv"}).exit_code, 0);
    const Outcome failed = run({"check", "judged.json", "good.csv", "bad.csv"});
    EXPECT_EQ(failed.exit_code, 1);
    EXPECT_NE(failed.out.find("good.csv: passed: "), std::string::npos) << failed.out;
    EXPECT_NE(failed.out.find(
                  "bad.csv: failed: attitude error 0.002 rad at t = 3.9 s exceeds the limit of 0.001 rad (tolerated by "
                  "the scene)"),
              std::string::npos)
        << failed.out;
    // the option goes before the scene
    EXPECT_EQ(run({"check", "judged.json", "bad.csv", "--max-attitude", "0.01"}).exit_code, 0);
    EXPECT_EQ(run({"check", "judged.json", "good.csv", "--max-attitude", "1e-9"}).exit_code, 1);
}

// Each block in the file is compared: a file with a correct attitude fails because of its other blocks.
TEST_F(Check, EveryBlockIsCompared) {
    write("thrown.json", R"({"name": "thrown", "duration": 2, "body": {"mass": 2, "inertia": [0.4, 0.7, 1]},
        "initial": {"orientation": [0.8, 0.48, 0, 0.36], "angular_velocity": [1.1, 2.3, 0.7], "velocity": [3, -1, 6],
        "position": [0.5, 0.2, 1]}, "loads": [{"type": "gravity", "acceleration": [0, 0, -9.81]}]})");
    write("up.json", R"({"name": "up", "duration": 2, "body": {"mass": 2, "inertia": [0.4, 0.7, 1]},
        "initial": {"orientation": [0.8, 0.48, 0, 0.36], "angular_velocity": [1.1, 2.3, 0.7], "velocity": [3, -1, 6],
        "position": [0.5, 0.2, 1]}, "loads": [{"type": "gravity", "acceleration": [0, 0, 9.81]}]})");
    const auto solved = [&](const std::string& name) {
        EXPECT_EQ(run({"solve", name, "--samples", "120", "--output", "made.csv"}).exit_code, 0);
        return read_trajectory((directory / "made.csv").string());
    };
    const auto expect = [&](const TrajectoryFile& file, const std::string& block, const std::string& words) {
        write("wrong.csv", write_trajectory(file));
        const Outcome outcome = run({"check", "thrown.json", "wrong.csv"});
        EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
        EXPECT_EQ(outcome.out.find("wrong.csv: failed: " + block), 0u) << outcome.out;
        EXPECT_NE(outcome.out.find("diagnosis: " + words), std::string::npos) << outcome.out;
        EXPECT_EQ(outcome.out.find("as accurate as binary64"), std::string::npos) << outcome.out;
    };
    const TrajectoryFile good = solved("thrown.json");
    expect(solved("up.json"), "position error ", "gravity has the opposite sign");
    TrajectoryFile file = good;
    for (TrajectoryRow& row : file.rows)
        row.position_W = 100.0 * row.position_W, row.velocity_W = 100.0 * row.velocity_W;
    expect(file, "position error ", "positions and velocities are in centimetres");
    file = good;
    for (TrajectoryRow& row : file.rows) row.angular_velocity_W = -row.angular_velocity_W;
    expect(file, "angular velocity error ", "wx,wy,wz have the opposite sign");
    file = good;
    for (TrajectoryRow& row : file.rows) row.angular_velocity_W = (30 / std::acos(-1.0)) * row.angular_velocity_W;
    expect(file, "angular velocity error ", "wx,wy,wz are in revolutions per minute");
    // and the good one passes, and says what is not in it
    file = good;
    file.has_position = file.has_velocity = false;
    write("part.csv", write_trajectory(file));
    const Outcome part = run({"check", "thrown.json", "part.csv"});
    EXPECT_EQ(part.exit_code, 0) << part.out;
    EXPECT_NE(part.out.find("not in the file and not evaluated: position; velocity"), std::string::npos) << part.out;
}

TEST_F(Check, ChecksAllFilesOfADirectory) {
    std::filesystem::create_directory(directory / "runs");
    for (int i = 0; i < 3; ++i)
        write("runs/" + std::to_string(i) + ".csv", write_trajectory(motion(odd_times, i == 1 ? 0.2 : 0)));
    write("runs/notes.txt", "no trajectory");
    const Outcome outcome = run({"check", "spin.json", "runs", "--format", "junit"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.out.find("<testsuites tests=\"3\" failures=\"1\">"), std::string::npos) << outcome.out;
    std::filesystem::create_directory(directory / "empty");
    EXPECT_EQ(run({"check", "spin.json", "empty"}).exit_code, 2);
}

TEST_F(Check, TakesColumnsOfAnyName) {
    write("engine.csv",
          "frame,Time,Rotation.x,Rotation.y,Rotation.z,Rotation.w\n0,0,0,0,0,1\n1,1,0,0,0.8414709848078965,0."
          "5403023058681398\n");
    const Outcome known = run({"check", "spin.json", "engine.csv"});
    EXPECT_EQ(known.exit_code, 0) << known.out << known.err;
    EXPECT_NE(known.out.find("columns ignored: frame"), std::string::npos) << known.out;
    EXPECT_EQ(run({"check", "spin.json", "engine.csv", "--columns",
                   "time=Time,rotation=Rotation.x:Rotation.y:Rotation.z:Rotation.w"})
                  .exit_code,
              0);
    EXPECT_EQ(run({"check", "spin.json", "engine.csv", "--columns", "time=Time,rotation=a:b:c:d"}).exit_code, 2);
    EXPECT_EQ(run({"check", "spin.json", "engine.csv", "--columns", "time"}).exit_code, 2);
}

// The commands of the page and the output printed under them; ".." stands for omitted text.
struct PrintedSession {
    std::string command, printed;
};
std::vector<PrintedSession> worked_example() {
    std::ifstream page(source_dir() + "/experiments/debug_your_engine/README.md");
    std::vector<PrintedSession> sessions;
    for (std::string line; std::getline(page, line);) {
        if (!line.starts_with("    ")) continue;
        if (line.starts_with("    $ "))
            sessions.push_back({line.substr(6), ""});
        else if (!sessions.empty())
            sessions.back().printed += line.substr(4) + "\n";
    }
    return sessions;
}
std::string in_one_line(const std::string& text) {
    std::istringstream words(text);
    std::string line;
    for (std::string word; words >> word;) line += word + " ";
    return line;
}

// The sessions in experiments/debug_your_engine/README.md are the output of these commands.
TEST_F(Check, PrintsTheOutputOfTheWorkedExample) {
    fs::create_directory_symlink(source_dir() + "/experiments", directory / "experiments");
    const std::string path = "PATH=" + fs::path(program_path()).parent_path().string() + ":$PATH; ";
    const auto succeeds = [](const char* command) { return std::system(command) == 0; };
    const bool has_node = succeeds("command -v node >/dev/null"),
               has_bullet = succeeds("pkg-config --exists bullet-float64 2>/dev/null");
    // the Node packages of the engines are the versions that npm would install
    const fs::path packages = fs::path(program_path()).parent_path() / "engines/node_modules";
    const bool has_cannon = has_node && fs::exists(packages / "cannon-es");
    if (has_cannon) fs::create_directory_symlink(packages, directory / "node_modules");
    int judged = 0;
    for (PrintedSession session : worked_example()) {
        const auto says = [&](const char* word) { return session.command.find(word) != std::string::npos; };
        if (says("cannon") && !has_cannon) continue;
        if (says("bullet") && !has_bullet) continue;
        if (says("js") && !has_node) continue;
        if (const std::string install = "npm install cannon-es && "; session.command.starts_with(install))
            session.command.erase(0, install.size());
        const int status =
            std::system(("cd " + directory.string() + "; " + path + "(" + session.command + ") >told 2>fault").c_str());
        const bool is_check = session.command.starts_with("polhode check");
        EXPECT_EQ(WEXITSTATUS(status), is_check ? 1 : 0) << session.command << read(directory / "fault");
        const std::string told = in_one_line(read(directory / "told")), printed = in_one_line(session.printed);
        for (std::size_t begin = 0, end = 0; begin < printed.size(); begin = end + 2) {
            end = std::min(printed.find("..", begin), printed.size());
            // a part at the end of a line ends in a blank
            const std::string part = printed.substr(begin, end - begin);
            EXPECT_NE(told.find(part.substr(part.starts_with(' '))), std::string::npos)
                << session.command << ": " << part << "\n"
                << told;
        }
        judged += is_check;
    }
    EXPECT_EQ(judged, 4 + has_node + 2 * has_bullet + has_cannon);
    const std::string picture = read(directory / "engine.svg");
    for (const char* part : {"attitude", "float32 floor", "first_order_quaternion at 240 Hz", "limit"})
        EXPECT_NE(picture.find(part), std::string::npos) << part;
}

TEST_F(Check, APictureIsOfOneFile) {
    write("a.csv", write_trajectory(motion(odd_times)));
    for (const std::vector<std::string>& more : {std::vector<std::string>{"--picture", "a.png"},
                                                 {"a.csv", "--picture", "a.svg"},
                                                 {"--picture", "none/a.svg"},
                                                 {"--length-unit", "ell"}}) {
        std::vector<std::string> arguments{"check", "spin.json", "a.csv"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
        EXPECT_EQ(lines(without_notice(outcome.err)), 1) << outcome.err;
    }
}

TEST_F(Check, UnitsAndEulerAngles) {
    // the rotation as yaw in degrees, positions in centimetres
    std::string table = "t,roll,pitch,yaw,x,y,z\n";
    for (const double t : odd_times)
        table += shortest_decimal(t) + ",0,0," + shortest_decimal(360 * t / std::acos(-1.0)) + "," +
                 shortest_decimal(100 * t) + ",0,0\n";
    write("yaw.csv", table);
    const std::vector<std::string> arguments{"check", "spin.json", "yaw.csv", "--columns",
                                             "time=t,euler_zyx=yaw:pitch:roll,position=x:y:z"};
    std::vector<std::string> with_units = arguments;
    with_units.insert(with_units.end(), {"--length-unit", "cm", "--angle-unit", "deg", "--max-attitude", "1e-12"});
    EXPECT_EQ(run(arguments).exit_code, 1);
    const Outcome good = run(with_units);
    EXPECT_EQ(good.exit_code, 0) << good.out;
}

TEST_F(Check, LimitsOfBlocks) {
    TrajectoryFile file = motion(odd_times);
    file.rows[1].position_W[1] = 0.1;  // of 3.9 m
    write("off.csv", write_trajectory(file));
    EXPECT_EQ(run({"check", "spin.json", "off.csv"}).exit_code, 0);
    EXPECT_EQ(run({"check", "spin.json", "off.csv", "--max-position", "0.09"}).exit_code, 1);
    EXPECT_EQ(run({"check", "spin.json", "off.csv", "--max-position", "2.5%"}).exit_code, 1);
    EXPECT_EQ(run({"check", "spin.json", "off.csv", "--max-position", "2.6%"}).exit_code, 0);
    write("strict.json", scene(R"(, "tolerated": {"position": 0.05})"));
    EXPECT_EQ(run({"check", "strict.json", "off.csv"}).exit_code, 1);
    for (const char* limit : {"-1", "0", "x", "1e999", "%"}) {
        const Outcome outcome = run({"check", "spin.json", "off.csv", "--max-velocity=" + std::string(limit)});
        EXPECT_EQ(outcome.exit_code, 2) << limit;
        EXPECT_EQ(lines(without_notice(outcome.err)), 1) << outcome.err;
    }
    EXPECT_EQ(run({"check", "spin.json", "off.csv", "--max-attitude", "5%"}).exit_code, 2);
}

// For an engine without faults the report names its update and the error at a smaller step.
TEST_F(Check, NamesTheUpdateOfASoundEngine) {
    ASSERT_EQ(run({"solve", "t_handle", "--method", "gyroscopic_explicit", "--step", "0.0083333333333333333",
                   "--duration", "2", "--samples", "240", "--output", "engine.csv"})
                  .exit_code,
              0);
    const Outcome outcome = run({"check", "t_handle", "engine.csv", "--explain"});
    EXPECT_EQ(outcome.out.find("diagnosis:"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("update: the file matches the "), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("Error with half the step: "), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("gyroscopic_term_missing: the gyroscopic term is missing"), std::string::npos)
        << outcome.out;
}

TEST_F(Check, WritesTestReports) {
    write("good.csv", write_trajectory(motion(odd_times)));
    write("a&b<c>.csv", write_trajectory(motion(odd_times, 2e-3)));
    const Outcome outcome = run({"check", "judged.json", "good.csv", "a&b<c>.csv", "--format", "junit"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.out.find("<testsuites tests=\"2\" failures=\"1\">"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("name=\"a&amp;b&lt;c&gt;.csv\">\n      <failure message=\"attitude error 0.002"),
              std::string::npos)
        << outcome.out;
}

TEST_F(Check, TakesWhatSolveAndTruthWrite) {
    ASSERT_EQ(run({"solve", "spin.json", "--samples", "7", "--output", "solved.csv"}).exit_code, 0);
    ASSERT_EQ(run({"truth", "spin.json", "--samples", "7", "--output", "true.csv"}).exit_code, 0);
    const Outcome outcome = run({"check", "spin.json", "solved.csv", "true.csv", "--max-attitude", "1e-9"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
    EXPECT_EQ(run({"check", "spin.json", "true.csv", "--max-attitude", "1e-15"}).exit_code, 0);
}

TEST_F(Check, RefusesWhatItCannotJudge) {
    // rows after the scene's end are refused, except for the rounding of a clock that accumulates steps
    write("longer.csv", write_trajectory(motion({0, 4.1})));
    write("rounded.csv", write_trajectory(motion({0, 4.000000000000002})));
    const Outcome longer = run({"check", "spin.json", "longer.csv"});
    EXPECT_EQ(longer.exit_code, 2);
    EXPECT_EQ(longer.out, "");
    EXPECT_NE(longer.err.find("longer.csv: column t: ends at 4.1 s"), std::string::npos) << longer.err;
    EXPECT_EQ(run({"check", "spin.json", "rounded.csv"}).exit_code, 0);
    // with one bad file among good ones, no file is evaluated
    write("torn.csv", "t,qw,qx,qy,qz\n0,1,0");
    const Outcome torn = run({"check", "spin.json", "rounded.csv", "torn.csv"});
    EXPECT_EQ(torn.exit_code, 2);
    EXPECT_EQ(torn.out, "");
    for (const char* value : {"0", "-1", "nan", "inf", "x", ""})
        EXPECT_EQ(run({"check", "spin.json", "rounded.csv", "--max-attitude", value}).exit_code, 2) << value;
    EXPECT_EQ(run({"check", "spin.json"}).exit_code, 2);
    EXPECT_EQ(run({"check", "spin.json", "rounded.csv", "--format", "xml"}).exit_code, 2);
    EXPECT_EQ(run({"check", "no_such_scene", "rounded.csv"}).exit_code, 2);
}

// free_asymmetric in an engine without the gyroscopic term: w in world axes stays (1, 1, 1)
TrajectoryFile without_gyroscopic_term(int rows, double duration) {
    TrajectoryFile file;
    file.has_angular_velocity = true;
    for (int k = 0; k <= rows; ++k) {
        const double t = duration * k / rows, half = std::sqrt(3.0) * t / 2, s = std::sin(half) / std::sqrt(3.0);
        file.rows.push_back({t, {std::cos(half), s, s, s}, {1, 1, 1}, {}, {}});
    }
    return file;
}

TEST_F(Check, ReportsTheFaultAndItsTime) {
    write("run.csv", write_trajectory(without_gyroscopic_term(200, 10)));
    const Outcome outcome = run({"check", "free_asymmetric", "run.csv", "--max-attitude", "0.1"});
    EXPECT_EQ(outcome.exit_code, 1);
    for (const char* part : {"diagnosis: the gyroscopic term is missing; enable",
                             "relative prediction error of w per step: ", "float32 floor", "float64 floor",
                             "largest up to t", "angular momentum "})
        EXPECT_NE(outcome.out.find(part), std::string::npos) << part << "\n" << outcome.out;
    const auto report =
        nlohmann::json::parse(run({"check", "free_asymmetric", "run.csv", "--format", "json"}).out)["trajectories"][0];
    EXPECT_EQ(report["diagnoses"][0]["fault"], "gyroscopic_term_missing");
    EXPECT_LT(report["diagnoses"][0]["explained"], 1e-6);
    EXPECT_EQ(report["over_time"].size(), 10u);
    EXPECT_EQ(report["over_time"][9]["until"], 10);
    EXPECT_GT(report["float32_floor"], 1e6 * report["float64_floor"].get<double>());
    const std::string junit =
        run({"check", "free_asymmetric", "run.csv", "--format", "junit", "--max-attitude", "1"}).out;
    EXPECT_NE(junit.find("the gyroscopic term is missing"), std::string::npos) << junit;
}

TEST_F(Check, ReportsWhenFloatIsTheLimit) {
    ASSERT_EQ(run({"truth", "free_asymmetric", "--samples", "50", "--output", "true.csv"}).exit_code, 0);
    TrajectoryFile file = read_trajectory((directory / "true.csv").string());
    // an error of half of that caused by rounding the initial state to binary32
    const auto report = nlohmann::json::parse(run({"check", "free_asymmetric", "true.csv", "--format", "json"}).out);
    const double floor = report["trajectories"][0]["float32_floor"];
    for (TrajectoryRow& row : file.rows) row.q = row.q * Quaternion<double>{1, floor / 4, 0, 0};
    write("float.csv", write_trajectory(file));
    EXPECT_NE(run({"check", "free_asymmetric", "true.csv"}).out.find("at the float64 floor"), std::string::npos);
    EXPECT_NE(run({"check", "free_asymmetric", "float.csv"}).out.find("as accurate as binary32 allows"),
              std::string::npos);
    // in a chaotic motion the rounding of the initial state grows beyond the limit
    ASSERT_EQ(run({"truth", "chaotic_top", "--samples", "50", "--output", "top.csv"}).exit_code, 0);
    EXPECT_NE(run({"check", "chaotic_top", "top.csv"}).out.find("a binary32 engine cannot be evaluated"),
              std::string::npos);
}

TEST_F(Check, TakesOtherConventions) {
    TrajectoryFile file = motion({0, 0.5, 1, 2});
    // Unity: y up, left-handed, so that rotations about the vertical have the opposite sense; degrees; scalar last
    std::string text = "t,qw,qx,qy,qz,wx,wy,wz,px,py,pz\n";
    for (const TrajectoryRow& row : file.rows) {
        const std::string t = shortest_decimal(row.t);
        text += t + ",0," + shortest_decimal(-row.q.z) + ",0," + shortest_decimal(row.q.w) + ",0," +
                shortest_decimal(-2 * 180 / std::acos(-1.0)) + ",0," + t + ",0,0\n";
    }
    write("unity.csv", text);
    const Outcome outcome =
        run({"check", "spin.json", "unity.csv", "--convention", "unity,scalar-last,degrees", "--format", "json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto report = nlohmann::json::parse(outcome.out)["trajectories"][0];
    for (const char* name : {"attitude_error_max", "omega_error_max", "momentum_error_max", "position_error_max"})
        EXPECT_LT(report[name], 1e-14) << name;
    const Outcome bad = run({"check", "spin.json", "unity.csv", "--convention", "unity,z-up"});
    EXPECT_EQ(bad.exit_code, 2);
    EXPECT_EQ(bad.err, "polhode: --convention: z-up contradicts unity; give one of them\n");
}

TEST_F(Check, TakesABinary32Clock) {
    std::vector<double> times;
    for (int k = 0; k <= 240; ++k) times.push_back(k / 60.0);
    TrajectoryFile file = motion(times);
    for (TrajectoryRow& row : file.rows) row.t = static_cast<double>(static_cast<float>(row.t));
    const auto report = checked(file);
    EXPECT_LT(report["attitude_error_max"], 1e-14);
    EXPECT_NE(report["remarks"][0].get<std::string>().find("multiples of 0.016666666666666666 s"), std::string::npos)
        << report["remarks"][0];
}

TEST_F(Check, ManyRowsGiveTheSameResultAsFew) {
    const TrajectoryFile many = without_gyroscopic_term(100000, 10);
    TrajectoryFile few = many;
    few.rows.clear();
    for (std::size_t k = 0; k < many.rows.size(); k += 1000) few.rows.push_back(many.rows[k]);
    write("many.csv", write_trajectory(many)), write("few.csv", write_trajectory(few));
    const Outcome outcome = run({"check", "free_asymmetric", "many.csv", "few.csv", "--format", "json"});
    ASSERT_EQ(outcome.exit_code, 1) << outcome.err;
    const auto report = nlohmann::json::parse(outcome.out)["trajectories"];
    EXPECT_EQ(report[0]["samples"], 100001);
    EXPECT_NEAR(report[0]["attitude_error_final"], report[1]["attitude_error_final"], 2e-15);
    EXPECT_NEAR(report[0]["momentum_error_final"], report[1]["momentum_error_final"], 2e-15);
    for (int i = 0; i < 2; ++i) EXPECT_EQ(report[i]["diagnoses"][0]["fault"], "gyroscopic_term_missing");
    // 10^5 rows, two truths, two diagnoses: 10^6 rows in two seconds leave a margin
    EXPECT_LT(outcome.seconds, optimised_build ? 2 : 60);
}

TEST_F(Check, EveryBadFileGetsOneLine) {
    for (const BadFile& bad : bad_files("motion", ".csv")) {
        if (is_read_by_check(bad)) continue;
        const Outcome outcome = run({"check", "spin.json", bad.path});
        EXPECT_EQ(outcome.exit_code, 2) << bad.path;
        EXPECT_EQ(outcome.out, "");
        EXPECT_EQ(lines(without_notice(outcome.err)), 1) << outcome.err;
        expect_one_line(bad, outcome.err.substr(0, outcome.err.size() - 1));
    }
}

}  // namespace
}  // namespace polhode
