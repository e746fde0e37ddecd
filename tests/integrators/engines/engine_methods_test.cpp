// Engines as methods, with shell scripts in place of engines: how the protocol handles every behaviour.
#include "integrators/engines/engine_methods.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "body/orientation.h"
#include "integrators/run/watch.h"
#include "places.h"
#include "scene/body_hull.h"
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

// An engine must list formulas in its hello to receive them.
TEST(EngineMethods, RefusesFormulasThatTheEngineDoesNotEvaluate) {
    Scene scene = simple_scene();
    FormulaLoad load;
    load.formula = "-w";
    scene.loads.push_back(load);
    const Trajectory refused = ScriptedEngine(answering(sound)).solved(scene);
    EXPECT_EQ(refused.status, Status::unsupported);
    EXPECT_EQ(refused.message, "scripted: its driver does not support loads given by formulas");
    const ScriptedEngine evaluates(R"(echo '{"formulas": true}' >&3; while read -r request; do echo ')" + sound +
                                   "' >&3; done");
    EXPECT_EQ(evaluates.solved(scene).status, Status::ok);
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

void give_shape(Scene& scene, const Shape& shape) {
    auto source = std::make_shared<BodySource>(*scene.body.source);
    source->definition = ShapedBody{shape, std::get<ShapedBody>(source->definition).amount};
    scene.body.source = source;
    scene = parse_scene(write_scene(scene), "given");
}

std::string reason_against(const char* name, const std::function<void(Scene&)>& change) {
    Scene scene = find_scene(name);
    change(scene);
    try {
        engine_scene(pose(scene));
    } catch (const std::invalid_argument& reason) {
        return reason.what();
    }
    return "none";
}

TEST(EngineScene, SaysWhatItCannotSay) {
    Scene scene = find_scene("every_load");
    EXPECT_THROW(engine_scene(pose(scene)), std::invalid_argument);
    Scene own = simple_scene();
    own.loads.push_back(UserTorque{"mine", [](const LoadState&) { return Vector3<double>(); }, {}});
    EXPECT_THROW(engine_scene(pose(own)), std::invalid_argument);
    EXPECT_EQ(reason_against("contact/ball_and_wall", [](Scene&) {}),
              "the engine protocol does not support planes with different coefficients");
    EXPECT_EQ(reason_against("contact/bowling_ball", [](Scene& s) { s.planes[0].rolling_friction = 0.001; }),
              "the engine protocol does not support torsional and rolling friction");
    EXPECT_EQ(reason_against("contact/bowling_ball",
                             [](Scene& s) {
                                 give_shape(s, Torus{0.5, 0.1});
                             }),
              "engines do not support tori on planes");
}

// n.x of the furthest point of a shape along -n, from its definition.
double lowest_of(const EngineShape& shape, const Vector3<double>& n) {
    const Vector3<double> in_shape = rotate_back(shape.q, n);
    const double across = std::hypot(in_shape[0], in_shape[1]), center = dot(n, shape.position);
    if (shape.type == "ball") return center - shape.radius;
    if (shape.type == "capsule") return center - shape.radius - shape.half_height * std::abs(in_shape[2]);
    if (shape.type == "ellipsoid")
        return center - hypotenuse(Vector3<double>(shape.half[0] * in_shape[0], shape.half[1] * in_shape[1],
                                                   shape.half[2] * in_shape[2]));
    if (shape.type == "box")
        return center - shape.half[0] * std::abs(in_shape[0]) - shape.half[1] * std::abs(in_shape[1]) -
               shape.half[2] * std::abs(in_shape[2]);
    return center - shape.radius * across - shape.half_height * std::abs(in_shape[2]);
}

// The shapes in principal axes touch a plane of any direction where the hull in the scene's axes does.
TEST(EngineScene, HasTheHullOfTheBody) {
    for (const char* name : {"contact/capsule_lands", "contact/tippe_top", "contact/rolling_coin", "contact/rattleback",
                             "contact/ellipsoid_bounces", "contact/block_on_ramp", "contact/bowling_ball"}) {
        const Scene scene = find_scene(name);
        const EngineScene known = engine_scene(pose(scene));
        ASSERT_EQ(known.shapes.size(), 1u) << name;
        for (const Vector3<double>& direction : {Vector3<double>(0, 0, 1), Vector3<double>(0.6, 0, -0.8),
                                                 Vector3<double>(-0.48, 0.6, 0.64), Vector3<double>(0, -1, 0)}) {
            double lowest = 0;
            for (const auto& piece : hull<double>(*scene.body.source))
                lowest = std::min(lowest, piece.lowest(direction) - dot(direction, scene.body.center_of_mass));
            EXPECT_NEAR(lowest_of(known.shapes[0], rotate_back(known.q_BP, direction)), lowest, 1e-13) << name;
        }
    }
    EXPECT_EQ(polyhedron_corners(engine_scene(pose(find_scene("tumbling_box_bounce"))).shapes).size(), 8u);
    EXPECT_TRUE(engine_scene(pose(find_scene("bouncing_ball"))).shapes.front().is_centered_ball());
    EXPECT_FALSE(engine_scene(pose(find_scene("contact/tippe_top"))).shapes.front().is_centered_ball());
}

TEST(EngineScene, IsWrittenWithItsShapes) {
    const EngineScene known = engine_scene(pose(find_scene("contact/capsule_lands")));
    const auto request = nlohmann::json::parse(engine_request(known, "default", {}, 1));
    ASSERT_EQ(request["shapes"].size(), 1u);
    EXPECT_EQ(request["shapes"][0]["type"], "capsule");
    EXPECT_EQ(request["shapes"][0]["radius"], 0.5);
    EXPECT_EQ(request["shapes"][0]["half_height"], 0.25);
    EXPECT_FALSE(request.contains("ball"));
    EXPECT_TRUE(request["hull"].empty());
    const EngineScene ball = engine_scene(pose(find_scene("contact/bowling_ball")));
    EXPECT_EQ(nlohmann::json::parse(engine_request(ball, "default", {}, 1))["ball"], 0.109);
}

// The hello decides which shapes an engine receives. An engine that lists none receives balls about the centre of mass
// and polyhedra.
TEST(EngineMethods, RefuseShapesThatTheEngineDoesNotList) {
    const auto outcome = [](const char* shapes, const char* scene) {
        const std::string greeting = R"(echo '{"version": "1.0", "settings": {"default": "d"}, "shapes": [)" +
                                     std::string(shapes) + R"(]}' >&3; )";
        const ScriptedEngine scripted(greeting + "while read -r request; do echo '" + sound + "' >&3; done",
                                      {{"planes", true}});
        const Trajectory run = scripted.solved(find_scene(scene));
        EXPECT_EQ(run.status, run.message.empty() ? Status::ok : Status::unsupported);
        return run.message;
    };
    EXPECT_EQ(outcome("", "contact/bowling_ball"), "");
    EXPECT_EQ(outcome("", "contact/block_on_ramp"), "");
    EXPECT_EQ(outcome(R"("polyhedron")", "contact/block_on_ramp"), "");
    EXPECT_EQ(outcome(R"("capsule")", "contact/capsule_lands"), "");
    EXPECT_EQ(outcome("", "contact/capsule_lands"),
              "scripted: its driver supports only polyhedra and balls about the centre of mass on planes");
    EXPECT_EQ(outcome(R"("ball")", "contact/capsule_lands"), "scripted: it does not support capsules on planes");
    EXPECT_EQ(outcome(R"("ball")", "contact/block_on_ramp"), "scripted: it does not support boxes on planes");
}

}  // namespace
}  // namespace polhode
