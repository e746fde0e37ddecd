// Engines as methods, with shell scripts in place of engines: how the protocol handles every behaviour.
#include "integrators/engines/engine_methods.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "body/orientation.h"
#include "integrators/run/watch.h"
#include "places.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

constexpr const char* hello = R"(echo '{"version": "1.0", "settings": {"default": "what it does"}}' >&3; )";

std::string temporary(const char* pattern) { return (std::filesystem::temp_directory_path() / pattern).string(); }

/// A file with one engine that runs this script.
class ScriptedEngine {
  public:
    explicit ScriptedEngine(const std::string& script, const nlohmann::json& more = {}) {
        std::string name = temporary("polhode-engines-XXXXXX");
        const int file = mkstemp(name.data());
        close(file);
        path_ = name;
        nlohmann::json entry{{"name", "scripted"}, {"command", {"sh", "-c", script}}};
        entry.update(more.is_null() ? nlohmann::json::object() : more);
        std::ofstream(path_) << nlohmann::json{{"engines", {entry}}};
        engines_ = read_engines(path_);
    }
    ~ScriptedEngine() { unlink(path_.c_str()); }
    const EngineMethod& engine() const { return engines_.front(); }
    Trajectory solved(const Scene& scene, double seconds_limit = 60) const {
        Settings settings;
        settings.step = scene.duration / 10, settings.samples = 2, settings.seconds_limit = seconds_limit;
        return solve(scene, *engine().method, settings);
    }

  private:
    std::string path_;
    std::vector<EngineMethod> engines_;
};

std::string answering(const std::string& answer) {
    return std::string(hello) + "while read -r request; do echo '" + answer + "' >&3; done";
}

const std::string row_at_rest = "[1, 0, 0, 0, 0, 0, 0, 1, 2, 3, 0, 0, 0]";
const std::string sound = R"({"status": "ok", "seconds": 0.5, "steps": 10, "samples": [)" + row_at_rest + ", " +
                          row_at_rest + ", " + row_at_rest + R"(], "readback": {"mass": 2, "moments": [1, 2, 3.3]}})";

Scene simple_scene() {
    Scene scene;
    scene.name = "simple", scene.duration = 1;
    scene.body = {2, diagonal(Vector3<double>(1, 2, 3)), {}, nullptr};
    scene.initial.position_W = {1, 2, 3};
    return scene;
}

TEST(EngineMethods, AnAnswerIsATrajectory) {
    const ScriptedEngine scripted(answering(sound));
    const Trajectory run = scripted.solved(simple_scene());
    ASSERT_EQ(run.status, Status::ok) << run.message;
    ASSERT_EQ(run.samples.size(), 3u);
    EXPECT_EQ(run.steps, 10);
    EXPECT_EQ(run.seconds, 0.5);
    EXPECT_EQ(run.step, 0.1);
    EXPECT_EQ(run.samples.back().t, 1);
    EXPECT_EQ(run.samples.back().position_W, Vector3<double>(1, 2, 3));
}

// The engine's body is compared with the requested one: here a moment is a tenth too large.
TEST(EngineMethods, ReadsBackWhatTheEngineHas) {
    const ScriptedEngine scripted(answering(sound));
    const Problem problem = pose(simple_scene());
    const EngineReport report = scripted.engine().inspect(&problem);
    // the script returns three samples, but two are requested
    EXPECT_NE(report.fault.find("3 samples instead of 2"), std::string::npos) << report.fault;
    EXPECT_EQ(scripted.engine().inspect(nullptr).hello.version, "1.0");
    const EngineScene scene = engine_scene(problem);
    EngineReadback back;
    back.mass = 2, back.moments = Vector3<double>(1, 2, 3.3);
    EXPECT_NEAR(readback_difference(scene, back), 0.3 / std::sqrt(14.0), 1e-15);
    back.moments = Vector3<double>(1, 2, 3), back.mass = 2.5;
    EXPECT_NEAR(readback_difference(scene, back), 0.25, 1e-15);
    back.mass = 2, back.q = Quaternion<double>{std::cos(0.05), std::sin(0.05), 0, 0};
    EXPECT_NEAR(readback_difference(scene, back), 0.1, 1e-14);
}

TEST(EngineMethods, ReportsEveryFailure) {
    const auto message = [](const std::string& script, Status status) {
        const Trajectory run = ScriptedEngine(script).solved(simple_scene(), 0.5);
        EXPECT_EQ(run.status, status) << run.message;
        return run.message;
    };
    EXPECT_EQ(message(answering(R"({"status": "unsupported", "message": "no planes"})"), Status::unsupported),
              "scripted: no planes");
    EXPECT_EQ(message(answering(R"({"status": "failed"})"), Status::failed), "scripted: failed without a message");
    EXPECT_EQ(message(answering("no JSON").c_str(), Status::failed).substr(0, 37),
              "scripted: the answer cannot be read: ");
    EXPECT_EQ(message(answering(R"({"status": "ok", "seconds": 1, "steps": 1, "samples": []})"), Status::failed),
              "scripted: the answer cannot be read: 0 samples instead of 3");
    EXPECT_EQ(message(std::string(hello) + "read -r request; kill -9 $$", Status::failed),
              "sh was terminated by signal 9");
    EXPECT_EQ(message(std::string(hello) + "read -r request; sleep 600", Status::failed),
              "sh was stopped: it did not answer within 0.5 s");
    EXPECT_EQ(message("echo nonsense >&3", Status::failed), "sh did not send a JSON object as its first line");
    EXPECT_EQ(message(R"(echo '{"missing": "the package is not installed"}' >&3)", Status::unsupported),
              "scripted is not available: the package is not installed");
}

TEST(EngineMethods, ReportsTheRequirementsOfAMissingEngine) {
    const ScriptedEngine none("", {{"command", {"/no/such/engine"}}, {"needs", "Debian's libnone-dev"}});
    const Trajectory run = none.solved(simple_scene());
    EXPECT_EQ(run.status, Status::unsupported);
    EXPECT_EQ(run.message, "scripted is not available: it needs Debian's libnone-dev");
    EXPECT_EQ(none.engine().inspect(nullptr).fault, "it needs Debian's libnone-dev");
}

// JSON represents a number that is not finite as null.
TEST(EngineMethods, WhatIsNotFiniteHasDiverged) {
    const ScriptedEngine scripted(answering(R"({"status": "ok", "seconds": 1, "steps": 10, "samples": [)" +
                                            row_at_rest + R"(, [null, 0, 0, 0, 0, 0, 0, 1, 2, 3, 0, 0, 0], )" +
                                            row_at_rest + "]}"));
    const Trajectory run = scripted.solved(simple_scene());
    EXPECT_EQ(run.status, Status::diverged);
    EXPECT_EQ(run.samples.size(), 1u);
    EXPECT_NE(run.message.find("t = 0.5 s"), std::string::npos) << run.message;
}

// An engine that crashed is restarted; one that did not crash is reused.
TEST(EngineMethods, ACrashCostsOneRun) {
    std::string counter = temporary("polhode-starts-XXXXXX");
    close(mkstemp(counter.data()));
    const std::string count = std::string("echo start >> ") + counter + "; ";
    const ScriptedEngine scripted(count + hello + "read -r a; echo '" + sound + "' >&3; read -r b; kill -9 $$");
    EXPECT_EQ(scripted.solved(simple_scene()).status, Status::ok);
    EXPECT_EQ(scripted.solved(simple_scene()).status, Status::failed);
    EXPECT_EQ(scripted.solved(simple_scene()).status, Status::ok);
    std::ifstream file(counter);
    EXPECT_EQ(std::distance(std::istream_iterator<std::string>(file), {}), 2);
    unlink(counter.c_str());
}

// After two time-outs a hanging engine is not called again; an answer in between resets the count.
TEST(EngineMethods, AHangCostsTwoTimeOuts) {
    const ScriptedEngine hung(std::string(hello) + "read -r a; exec sleep 600");
    for (int run = 0; run < 4; ++run) {
        const Trajectory failed = hung.solved(simple_scene(), 0.2);
        EXPECT_EQ(failed.status, Status::failed);
        EXPECT_TRUE(failed.limit_reached);
        EXPECT_EQ(failed.message, run < 2 ? "sh was stopped: it did not answer within 0.2 s"
                                          : "sh received no request: its last requests timed out");
    }
    const ScriptedEngine slow(std::string(hello) + "read -r a; echo '" + sound + "' >&3; read -r b; exec sleep 600");
    for (int run = 0; run < 6; ++run)
        EXPECT_EQ(slow.solved(simple_scene(), run % 2 == 0 ? 60 : 0.2).status,
                  run % 2 == 0 ? Status::ok : Status::failed);
}

TEST(EngineMethods, StepsBeyondTheLimitAreNotBegun) {
    const ScriptedEngine scripted(answering(sound));
    Settings settings;
    settings.step = 1e-9, settings.max_steps = 1000;
    const Trajectory run = solve(simple_scene(), *scripted.engine().method, settings);
    EXPECT_EQ(run.status, Status::failed);
    EXPECT_EQ(run.message, "needs more than the limit of 1000 steps");
    EXPECT_TRUE(run.limit_reached);
}

// A user-defined engine from one line in a file: here polhode itself, which reads a scene and prints a trajectory.
TEST(EngineMethods, AProgramThatPrintsATrajectoryIsAnEngine) {
    const ScriptedEngine itself(
        "", {{"command",
              {program_path(), "solve", "/dev/stdin", "--method", "gyroscopic_implicit", "--samples", "{samples}"}},
             {"by_step", {"--step", "{step}"}}});
    const Scene scene = find_scene("mujoco_box");
    Settings settings;
    settings.step = 0.01, settings.samples = 10;
    const Trajectory own = solve(scene, *find_method("gyroscopic_implicit"), settings);
    const Trajectory run = solve(scene, *itself.engine().method, settings);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    EXPECT_EQ(run.samples.back().q, own.samples.back().q);
}

TEST(EngineMethods, AFilesFaultsAreNamed) {
    const auto fault = [](const std::string& text) -> std::string {
        std::string name = temporary("polhode-engines-XXXXXX");
        close(mkstemp(name.data()));
        std::ofstream(name) << text;
        std::string what = "none";
        try {
            read_engines(name);
        } catch (const InputError& error) {
            what = std::string(error.what()).substr(name.size());
        }
        unlink(name.c_str());
        return what;
    };
    EXPECT_NE(fault(R"({"engines": [{"name": "a b", "command": ["x"]}]})").find("/engines/0/name"), std::string::npos);
    EXPECT_NE(fault(R"({"engines": [{"name": "a"}]})").find("command"), std::string::npos);
    EXPECT_NE(fault(R"({"engines": [{"name": "a", "command": []}]})").find("is empty"), std::string::npos);
    EXPECT_NE(fault(R"({"engines": [{"name": "a", "command": ["x"], "speed": 1}]})").find("speed"), std::string::npos);
    EXPECT_NE(fault(R"({"engines": [{"name": "a", "command": ["x"], "precision": "half"}]})").find("binary32"),
              std::string::npos);
    const std::string twice = R"({"name": "a", "command": ["x"]})";
    EXPECT_NE(fault("{\"engines\": [" + twice + ", " + twice + "]}").find("twice"), std::string::npos);
}

// The request describes the same motion in the body's principal axes: the truth of both is the same.
TEST(EngineScene, IsTheSameMotion) {
    for (const char* name : {"l_shape", "towed_body", "torsional_spring", "struck_bar", "pushed_box_with_sphere"}) {
        const Scene scene = find_scene(name);
        const Problem problem = pose(scene);
        const EngineScene known = engine_scene(problem);
        ASSERT_FALSE(known.pivot) << name;
        Settings settings;
        settings.samples = 5, settings.tolerance = 1e-12;
        const Trajectory own = solve(scene, *find_method("dop853"), settings);
        const Trajectory other = solve(known.free, *find_method("dop853"), settings);
        ASSERT_EQ(other.status, Status::ok) << name << ": " << other.message;
        for (std::size_t k = 0; k < own.samples.size(); ++k) {
            const Quaternion<double> q = other.samples[k].q * conjugate(known.q_BP);
            EXPECT_LT(rotation_angle_between(own.samples[k].q, q), 1e-7) << name << " " << k;
            EXPECT_LT(hypotenuse(own.samples[k].position_W - other.samples[k].position_W),
                      1e-8 * (1 + hypotenuse(own.samples[k].position_W)))
                << name << " " << k;
        }
    }
}

TEST(EngineScene, SaysWhatItCannotSay) {
    Scene scene = find_scene("every_load");
    EXPECT_THROW(engine_scene(pose(scene)), std::invalid_argument);
    Scene own = simple_scene();
    own.loads.push_back(UserTorque{"mine", [](const LoadState&) { return Vector3<double>(); }, {}});
    EXPECT_THROW(engine_scene(pose(own)), std::invalid_argument);
    EXPECT_THROW(engine_scene(pose(find_scene("capsule_bounce"))), std::invalid_argument);
    EXPECT_EQ(engine_scene(pose(find_scene("tumbling_box_bounce"))).hull.size(), 8u);
    EXPECT_TRUE(engine_scene(pose(find_scene("bouncing_ball"))).ball.has_value());
}

}  // namespace
}  // namespace polhode
