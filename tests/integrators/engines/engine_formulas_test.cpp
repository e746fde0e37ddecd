// Loads given by formulas in every available engine: the same motion as the built-in load in the same engine, closed
// forms of sampled control, and the reference solution as the step decreases.
#include "integrators/engines/engine_formulas.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>

#include "body/orientation.h"
#include "integrators/engines/engine_mechanism.h"
#include "integrators/method.h"
#include "scene/scene_file.h"
#include "tests/integrators/engines/engines_here.h"

namespace polhode {
namespace {

bool is_binary32(const EngineMethod& engine) { return engine.method->precision == Precision::binary32; }
bool is_gyroscopic(const EngineMethod& engine) {
    return engine.engine != "havok" && engine.engine != "cannon_es" && engine.engine != "oimo";
}
// Havok loses part of small velocity changes (real_engines_test.cpp), and Rapier solves in four substeps, whose
// rounding in binary32 grows as the step decreases.
bool is_coarse(const EngineMethod& engine) { return engine.engine == "havok" || engine.engine == "rapier"; }

/// Engines that neither damp nor sleep, with one setting each, and settings with another integrator.
std::vector<const EngineMethod*> engines_tested() {
    std::vector<const EngineMethod*> all;
    std::set<std::string> with_best;
    for (const EngineMethod& engine : engines_here())
        if (engine.setting == "best") with_best.insert(engine.engine);
    for (const EngineMethod& engine : engines_here())
        if (engine.setting == "best" || engine.setting == "rk4" ||
            (engine.setting == "default" && !with_best.contains(engine.engine)))
            all.push_back(&engine);
    return all;
}

Trajectory run_loads(const EngineMethod& engine, const Scene& scene, double step, long samples = 8) {
    Settings settings;
    settings.step = step, settings.samples = samples, settings.seconds_limit = 60;
    return solve(scene, *engine.method, settings);
}

Trajectory solve_reference(const Scene& scene, long samples = 8) {
    Settings settings;
    settings.samples = samples;
    Trajectory run = solve(scene, *find_method("taylor"), settings);
    EXPECT_EQ(run.status, Status::ok) << run.message;
    return run;
}

// Oimo.js supports neither external loads nor several bodies; some engines lack a joint type or a law.
bool is_unsupported(const EngineMethod& engine, const Trajectory& run) {
    if (run.status != Status::unsupported) return false;
    EXPECT_NE(run.message.find(engine.engine), std::string::npos) << run.message;
    EXPECT_EQ(run.message.find("formula"), std::string::npos) << run.message;
    return true;
}

struct Distance {
    double attitude = 0, position = 0;
};
// The largest differences over all samples and bodies.
Distance find_distance(const Trajectory& a, const Trajectory& b) {
    Distance worst;
    EXPECT_EQ(a.samples.size(), b.samples.size());
    for (std::size_t k = 0; k < std::min(a.samples.size(), b.samples.size()); ++k) {
        worst.attitude = std::max(worst.attitude, rotation_angle_between(a.samples[k].q, b.samples[k].q));
        worst.position = std::max(worst.position, hypotenuse(a.samples[k].position_W - b.samples[k].position_W));
    }
    return worst;
}

// A body whose centre of mass is not its origin and whose axes are not principal axes, so that a formula that refers to
// other axes or another point than the built-in load differs. All numbers are binary fractions.
Scene loaded_body(const std::string& loads, const std::string& more = "") {
    return parse_scene(fmt::format(R"({{"name": "loaded", "duration": 1, {}
        "body": {{"mass": 2, "inertia": [[1.5, 0.25, -0.125], [0.25, 2, 0.25], [-0.125, 0.25, 2.5]],
          "center_of_mass": [0.25, -0.5, 0.125]}},
        "initial": {{"orientation": [0.5, 0.5, -0.5, 0.5], "angular_velocity": [0.5, -0.25, 1],
          "velocity": [1, 0, 0.5]}}, "loads": [{}]}})",
                                   more, loads),
                       "loaded");
}
Scene loaded_pendulum(const std::string& loads) {
    return parse_scene(fmt::format(R"({{"name": "loaded", "duration": 1,
        "body": {{"mass": 2, "inertia": [[1.5, 0.25, -0.125], [0.25, 2, 0.25], [-0.125, 0.25, 2.5]],
          "center_of_mass": [0.25, -0.5, 0.125]}}, "pivot": [0, 0, 0.5],
        "initial": {{"orientation": [0.5, 0.5, -0.5, 0.5], "angular_velocity": [0.5, -0.25, 1]}},
        "loads": [{}]}})",
                                   loads),
                       "loaded");
}

void expect_same_motion(const Scene& built_in, const Scene& formula) {
    int completed = 0;
    for (const EngineMethod* engine : engines_tested()) {
        SCOPED_TRACE(engine->method->name);
        const Trajectory expected = run_loads(*engine, built_in, 1. / 256), run = run_loads(*engine, formula, 1. / 256);
        if (is_unsupported(*engine, expected)) continue;
        ASSERT_EQ(expected.status, Status::ok) << expected.message;
        ASSERT_EQ(run.status, Status::ok) << run.message;
        EXPECT_EQ(run.steps, expected.steps);
        const Distance distance = find_distance(run, expected);
        // sums in another order; Simbody's default integrator ends its step a little later
        const double bound = is_coarse(*engine) ? 1e-3 : is_binary32(*engine) ? 2e-5 : 1e-11;
        EXPECT_LT(distance.attitude, bound);
        EXPECT_LT(distance.position, bound);
        ++completed;
    }
    EXPECT_GT(completed, 3);
}

TEST(EngineFormulas, MoveABodyAsBuiltInLoadsDo) {
    SKIP_WITHOUT_ENGINES();
    const std::string gravity = R"({"type": "gravity", "acceleration": [0, 0, -9.75]}, )";
    expect_same_motion(loaded_body(gravity + R"({"type": "torque", "vector": [0.5, -1, 2], "frame": "body"},
            {"type": "torque", "vector": [1, 0.25, -0.5], "frame": "world", "from": 0.25, "until": 0.75},
            {"type": "force", "vector": [2, -4, 1], "frame": "body", "point": [0.5, 0.25, -1], "point_frame": "body"},
            {"type": "force", "vector": [-1, 2, 4], "frame": "world", "point": [1, 0, 2], "point_frame": "world"},
            {"type": "drag", "rotational": [0.5, 0.5, 0.5], "translational": 0.25}, {"type": "impulse",
            "vector": [1, 2, -1], "frame": "world", "point": [0, 0, 1], "point_frame": "body", "at": 0.5})"),
                       loaded_body(gravity + R"({"type": "torque", "formula": "[a, -2*a, 4*a]", "frame": "body"},
            {"type": "torque", "formula": "[1, a/2, -a]", "frame": "world", "from": 0.25, "until": 0.75},
            {"type": "force", "formula": ["2 + 0*t", -4, 1], "frame": "body", "point": [0.5, 0.25, -1],
             "point_frame": "body"},
            {"type": "force", "formula": "[-1, 2, 4]", "frame": "world", "point": [1, 0, 2], "point_frame": "world"},
            {"type": "torque", "formula": "-a*w", "frame": "body"},
            {"type": "force", "formula": "-a/2*v", "frame": "world"}, {"type": "impulse",
            "vector": [1, 2, -1], "frame": "world", "point": [0, 0, 1], "point_frame": "body", "at": 0.5})",
                                   R"("parameters": {"a": 0.5}, )"));
}

TEST(EngineFormulas, MoveAPendulumAsBuiltInLoadsDo) {
    SKIP_WITHOUT_ENGINES();
    expect_same_motion(loaded_pendulum(R"({"type": "torque", "vector": [0.5, -1, 2], "frame": "body"},
            {"type": "force", "vector": [2, -4, 1], "frame": "body", "point": [0.5, 0.25, -1], "point_frame": "body"},
            {"type": "force", "vector": [-1, 2, 4], "frame": "world", "point": [1, 0, 2], "point_frame": "world"})"),
                       loaded_pendulum(R"({"type": "torque", "formula": "[0.5, -1, 2 + 0*w.x]", "frame": "body"},
            {"type": "force", "formula": "[2, -4, 1]", "frame": "body", "point": [0.5, 0.25, -1], "point_frame": "body"},
            {"type": "force", "formula": "[-1, 2, 4]", "frame": "world", "point": [1, 0, 2], "point_frame": "world"})"));
}

// A potential acts as its force and torque, here written by hand: springs from the centre of mass to the origin, and
// from the direction e of the body to the z axis: U = -b (R e).z has the torque b e x R^T z.
TEST(EngineFormulas, MoveAsThePotentialSays) {
    SKIP_WITHOUT_ENGINES();
    const std::string direction = R"("let": {"e": "[0.5, 0.25, 1]"}, )";
    expect_same_motion(loaded_body(R"json({"type": "force", "frame": "world", "formula": "-4*p"},
                        {"type": "torque", "frame": "body", "formula": "2*cross(e, to_body([0, 0, 1]))"})json",
                                   direction),
                       loaded_body(R"({"type": "potential", "formula": "2*dot(p, p) - 2*to_world(e).z"})", direction));
}

// The error of a body regulated by proportional and derivative feedback of its attitude is proportional to the step.
// All functions of the language occur: each is an operation of the driver.
TEST(EngineFormulas, RegulateABodyAtFirstOrder) {
    SKIP_WITHOUT_ENGINES();
    const Scene scene = loaded_body(
        R"json({"type": "torque", "frame": "body", "formula": "-4*rotation_error([1, 0, 0, 0]) - inertia(3*w)"},
           {"type": "force", "frame": "world",
            "formula": ["-4*tanh(p.x) + cbrt(8 + sinh(p.z)) - exp(-t)", "-clamp(8*p.y, -1, 1) + log(1 + t)*abs(p.y)",
              "if(p.z > 0.25, 0.5 - 2*p.z, p.z - 0.25) - sqrt(1 + p.z^2) + asin(p.z/4) + acos(p.x/4) + atan2(p.y, 1) + (1 + t)^0.3 + sin(t)*cos(t)"]})json");
    const Trajectory truth = solve_reference(scene);
    int completed = 0;
    for (const EngineMethod* engine : engines_tested()) {
        SCOPED_TRACE(engine->method->name);
        const Trajectory coarse = run_loads(*engine, scene, 1. / 128);
        if (is_unsupported(*engine, coarse)) continue;
        const Trajectory fine = run_loads(*engine, scene, 1. / 512);
        ASSERT_EQ(coarse.status, Status::ok) << coarse.message;
        ASSERT_EQ(fine.status, Status::ok) << fine.message;
        const Distance of_coarse = find_distance(coarse, truth), of_fine = find_distance(fine, truth);
        EXPECT_LT(of_coarse.position, 2e-2);
        if (is_gyroscopic(*engine)) {
            EXPECT_LT(of_coarse.attitude, 2e-2);
        }
        if (!is_binary32(*engine)) {
            EXPECT_NEAR(of_coarse.position / of_fine.position, 4, 0.4);
            if (is_gyroscopic(*engine)) {
                EXPECT_NEAR(of_coarse.attitude / of_fine.attitude, 4, 0.4);
            }
        }
        ++completed;
    }
    EXPECT_GT(completed, 3);
}

// A point mass with F = -k p - c v sampled every fifth step of h and held. In a period of n steps the velocity changes
// by n h a. The position changes by n h v + (n h)^2 a / 2, with semi-implicit Euler by n h v + n (n + 1) h^2 a / 2.
TEST(EngineFormulas, HoldSampledForces) {
    SKIP_WITHOUT_ENGINES();
    constexpr double k = 16, c = 4, m = 2, h = 1. / 64, period = 5 * h;
    constexpr int periods = 8, n = 5;
    Scene scene = parse_scene(fmt::format(R"({{"name": "sampled", "duration": {}, "body": {{"mass": 2,
        "inertia": [1, 1, 1]}}, "initial": {{"position": [1, 0, 0], "velocity": [0.5, 0, 0]}},
        "loads": [{{"type": "force", "frame": "world", "formula": "-16*p - 4*v", "hold": {}}}]}})",
                                          periods * period, period),
                              "sampled");
    const auto advance = [&](double square) {
        std::vector<double> x{1};
        double v = 0.5;
        for (int i = 0; i < periods; ++i) {
            const double a = (-k * x.back() - c * v) / m;
            x.push_back(x.back() + n * h * v + square * h * h * a), v += n * h * a;
        }
        return x;
    };
    const std::vector<double> semi_implicit = advance(0.5 * n * (n + 1)), exact = advance(0.5 * n * n);
    const Trajectory truth = solve_reference(scene, periods);
    for (int i = 0; i <= periods; ++i)
        EXPECT_NEAR(truth.samples[std::size_t(i)].position_W[0], exact[std::size_t(i)], 1e-14);
    int completed = 0;
    for (const EngineMethod* engine : engines_tested()) {
        SCOPED_TRACE(engine->method->name);
        const Trajectory run = run_loads(*engine, scene, h, periods);
        if (is_unsupported(*engine, run)) continue;
        ASSERT_EQ(run.status, Status::ok) << run.message;
        EXPECT_EQ(run.steps, n * periods);
        double from_semi_implicit = 0, from_exact = 0;
        for (std::size_t i = 0; i <= periods; ++i) {
            const double x = run.samples[i].position_W[0];
            from_semi_implicit = std::max(from_semi_implicit, std::abs(x - semi_implicit[i]));
            from_exact = std::max(from_exact, std::abs(x - exact[i]));
        }
        // Rapier solves in four substeps: between the two
        const double bound = engine->engine == "rapier" ? 5e-3
                             : is_coarse(*engine)       ? 1e-3
                             : is_binary32(*engine)     ? 1e-5
                                                        : 1e-12;
        EXPECT_LT(std::min(from_semi_implicit, from_exact), bound);
        EXPECT_GT(find_distance(run, solve_reference(
                                         [&] {
                                             Scene continuous = scene;
                                             std::get<FormulaLoad>(continuous.loads[0]).formula = "-16*p - 4*v";
                                             return continuous;
                                         }(),
                                         periods))
                      .position,
                  1e-2);
        ++completed;
    }
    EXPECT_GT(completed, 3);
}

// A step in which a value is sampled or a load begins is split there: methods that integrate a constant force exactly
// reach the reference although no such time is a multiple of the step.
TEST(EngineFormulas, SplitStepsAtSamplingTimes) {
    SKIP_WITHOUT_ENGINES();
    const Scene free = parse_scene(R"({"name": "sampled", "duration": 2, "body": {"mass": 2, "inertia": [1, 1, 1]},
        "initial": {"position": [1, 0, 0], "velocity": [0.5, 0, 0]},
        "loads": [{"type": "force", "frame": "world", "formula": "-16*p - 4*v", "hold": 0.07},
                  {"type": "force", "frame": "world", "formula": "[0, 3, 0]", "from": 0.333, "until": 1.777}]})",
                                   "sampled");
    const Scene slider = parse_scene(R"({"name": "sampled", "duration": 2, "bodies": [{"name": "cart",
        "body": {"mass": 2, "inertia": [1, 1, 1]}}], "joints": [{"name": "rail", "type": "prismatic", "parent": "world",
        "child": "cart", "axis": [1, 0, 0], "initial": {"displacement": 1, "speed": 0.5}}],
        "loads": [{"type": "motor", "joint": "rail", "formula": "-16*rail.displacement - 4*rail.speed", "hold": 0.07},
                  {"type": "force", "body": "cart", "frame": "world", "formula": "[3, 0, 0]", "from": 0.333,
                   "until": 1.777}]})",
                                     "sampled");
    int completed = 0;
    for (const Scene& scene : {free, slider}) {
        const Trajectory truth = solve_reference(scene);
        for (const EngineMethod* engine : engines_tested()) {
            const bool is_exact = (engine->setting == "rk4" && engine->engine != "bullet_multibody") ||
                                  (engine->engine == "simbody" && engine->setting == "best");
            if (!is_exact) continue;
            SCOPED_TRACE(fmt::format("{} {} bodies", engine->method->name, scene.bodies.size()));
            const Trajectory run = run_loads(*engine, scene, 1. / 32);
            ASSERT_EQ(run.status, Status::ok) << run.message;
            // 64 steps, of which 27 + 2 are split; 25 * 0.07 is the start of a step. C++ counts whole steps for one
            // body
            if (!scene.bodies.empty()) {
                EXPECT_EQ(run.steps, 64 + 29);
            }
            EXPECT_LT(find_distance(run, truth).position, 1e-12);
            ++completed;
        }
    }
    if (completed == 0) GTEST_SKIP() << "no engine here integrates a constant force exactly";
}

// x'' = 16 (10 - x) - 4 x' for a wheel that rotates by 10 rad: the angle counts full revolutions. The exact motion is
// x = 10 (1 - e^(-2 t) (cos b t + 2/b sin b t)), b^2 = 12.
TEST(EngineFormulas, ServeAJointBeyondOneRevolution) {
    SKIP_WITHOUT_ENGINES();
    const auto make_scene = [](const std::string& more) {
        return parse_scene(R"json({"name": "servo", "duration": 4, "bodies": [{"name": "wheel", "body": {"mass": 1,
            "inertia": [0.3125, 0.3125, 0.5]}}], "joints": [{"name": "axle", "type": "revolute", "parent": "world",
            "child": "wheel", "axis": [0, 0, 1], "initial": {"angle": 1}}], "loads": [{"type": "motor", "joint": "axle",
            "formula": "0.5*(16*(11 - axle.angle) - 4*axle.rate)")json" +
                               more + "}]}",
                           "servo");
    };
    int completed = 0;
    for (const bool is_held : {false, true}) {
        const Scene scene = make_scene(is_held ? R"(, "hold": 0.0625)" : "");
        const Trajectory truth = solve_reference(scene);
        if (!is_held) {
            const double t = 2, b = std::sqrt(12.0);
            const double x = 11 - 10 * std::exp(-2 * t) * (std::cos(b * t) + 2 / b * std::sin(b * t));
            EXPECT_LT(
                std::abs(std::remainder(2 * std::atan2(truth.samples[4].q.z, truth.samples[4].q.w) - x, 2 * M_PI)),
                1e-12);
        }
        for (const EngineMethod* engine : engines_tested()) {
            SCOPED_TRACE(fmt::format("{} {}", engine->method->name, is_held));
            const Trajectory coarse = run_loads(*engine, scene, 1. / 128);
            if (is_unsupported(*engine, coarse)) continue;
            const Trajectory fine = run_loads(*engine, scene, 1. / 512);
            ASSERT_EQ(coarse.status, Status::ok) << coarse.message;
            ASSERT_EQ(fine.status, Status::ok) << fine.message;
            const double of_coarse = find_distance(coarse, truth).attitude,
                         of_fine = find_distance(fine, truth).attitude;
            EXPECT_LT(of_coarse, 0.15);
            EXPECT_LT(of_fine, 0.04);
            if (!is_binary32(*engine) && of_coarse > 1e-6) {
                EXPECT_NEAR(of_coarse / of_fine, 4, 1);
            }
            ++completed;
        }
    }
    EXPECT_GT(completed, 6);
}

// A motor with a constant formula moves the joint as a constant motor does, also one between two bodies whose joint
// coordinate is not zero at the start.
TEST(EngineFormulas, MoveJointsAsMotorsDo) {
    SKIP_WITHOUT_ENGINES();
    for (const char* type : {"revolute", "prismatic"}) {
        const auto make_scene = [&](const std::string& amount) {
            const bool turns = std::string(type) == "revolute";
            return parse_scene(fmt::format(R"({{"name": "pair", "duration": 1, "bodies": [
                {{"name": "b", "body": {{"mass": 2, "inertia": [0.5, 0.75, 1], "center_of_mass": [0.5, 0.25, 0]}}}},
                {{"name": "a", "body": {{"mass": 3, "inertia": [1, 1.5, 2], "center_of_mass": [0.25, 0, 0.5]}}}}],
                "joints": [{{"name": "j", "type": "{0}", "parent": "a", "child": "b", "axis": [0, 1, 0],
                    "parent_point": [0.25, 0, 0.5], "initial": {{"{1}": 0.25, "{2}": 0.5}}}},
                  {{"name": "base", "type": "{0}", "parent": "world", "child": "a", "axis": [0, 0, 1],
                    "initial": {{"{1}": -0.5, "{2}": 1}}}}],
                "loads": [{{"type": "motor", "joint": "j", {3}, "from": 0.25, "until": 0.75}}]}})",
                                           type, turns ? "angle" : "displacement", turns ? "rate" : "speed", amount),
                               "pair");
        };
        const char* x = std::string(type) == "revolute" ? "angle" : "displacement";
        const Scene built_in = make_scene(std::string(type) == "revolute" ? R"("torque": 0.5)" : R"("force": 0.5)");
        const Scene formula = make_scene(fmt::format(R"("formula": "0.5 + 0*base.{} + 0*j.{}")", x, x));
        for (const EngineMethod* engine : engines_tested()) {
            SCOPED_TRACE(fmt::format("{} {}", engine->method->name, type));
            const Trajectory expected = run_loads(*engine, built_in, 1. / 256);
            if (is_unsupported(*engine, expected)) continue;
            const Trajectory run = run_loads(*engine, formula, 1. / 256);
            ASSERT_EQ(run.status, Status::ok) << run.message;
            const Distance distance = find_distance(run, expected);
            // opposite loads on two bodies instead of a generalized force: rounding, and the step's rotation with RK4
            const double bound = engine->setting == "rk4" ? 1e-3 : is_binary32(*engine) ? 2e-5 : 1e-9;
            EXPECT_LT(distance.attitude, bound);
            EXPECT_LT(distance.position, bound);
        }
    }
}

// Forces and torques on bodies of a mechanism, at points and in frames of each kind, and formulas that read other
// bodies and joints: the error is proportional to the step.
TEST(EngineFormulas, LoadBodiesOfAMechanism) {
    SKIP_WITHOUT_ENGINES();
    const Scene scene = parse_scene(R"json({"name": "pair", "duration": 1, "bodies": [
        {"name": "b", "body": {"mass": 2, "inertia": [[0.5, 0.125, 0], [0.125, 0.75, 0], [0, 0, 1]],
          "center_of_mass": [0.5, 0.25, 0]}},
        {"name": "a", "body": {"mass": 3, "inertia": [1, 1.5, 2], "center_of_mass": [0.25, 0, 0.5]}}],
        "joints": [{"name": "j", "type": "revolute", "parent": "a", "child": "b", "axis": [0, 1, 0],
            "parent_point": [0.25, 0, 0.5], "initial": {"angle": 0.25, "rate": 0.5}},
          {"name": "base", "type": "revolute", "parent": "world", "child": "a", "axis": [0, 0, 1],
            "initial": {"angle": -0.5, "rate": 1}}],
        "loads": [{"type": "gravity", "acceleration": [0, 0, -2]},
          {"type": "torque", "body": "a", "frame": "body", "formula": "[0, 0, -b.w.y - base.angle]"},
          {"type": "torque", "body": "b", "frame": "world", "formula": "-0.5*w_W + [j.angle, j.rate, t]"},
          {"type": "force", "body": "b", "frame": "world", "point": [0.5, 0, 1], "point_frame": "body",
           "formula": "[1, -4*at(b, [0.5, 0, 1]).y, 2] - velocity_at(a, [0, 0, 1])"},
          {"type": "force", "body": "b", "frame": "body", "point": [0, 1, 0], "point_frame": "world",
           "formula": "[1, 0, 0.5*norm(a.p)]"}]})json",
                                    "pair");
    const Trajectory truth = solve_reference(scene);
    int completed = 0;
    for (const EngineMethod* engine : engines_tested()) {
        SCOPED_TRACE(engine->method->name);
        const Trajectory coarse = run_loads(*engine, scene, 1. / 256);
        if (is_unsupported(*engine, coarse)) continue;
        const Trajectory fine = run_loads(*engine, scene, 1. / 1024);
        ASSERT_EQ(fine.status, Status::ok) << fine.message;
        const Distance of_coarse = find_distance(coarse, truth), of_fine = find_distance(fine, truth);
        if (!is_coarse(*engine) && is_gyroscopic(*engine)) {
            EXPECT_LT(of_coarse.attitude, 3e-2);
            EXPECT_LT(of_fine.attitude, 1e-2);
        }
        if (!is_binary32(*engine) && is_gyroscopic(*engine)) {
            EXPECT_NEAR(of_coarse.attitude / of_fine.attitude, 4, 1);
        }
        ++completed;
    }
    EXPECT_GT(completed, 3);
}

// A block on a rough floor slides by 0.0146 m while an oscillating force exceeds the friction, and sticks between. The
// engines listed keep friction at rest without creep; the others are off by up to this distance (measured).
TEST(EngineFormulas, PushABlockOnAFloor) {
    SKIP_WITHOUT_ENGINES();
    const Scene scene = find_scene("contact/forced_block");
    const Trajectory truth = solve_reference(scene);
    EXPECT_NEAR(truth.samples.back().position_W[0], 0.014584, 1e-6);
    int completed = 0;
    for (const EngineMethod* engine : engines_tested()) {
        if (!engine->method->planes) continue;
        SCOPED_TRACE(engine->method->name);
        const Trajectory run = run_loads(*engine, scene, 1e-3);
        ASSERT_EQ(run.status, Status::ok) << run.message;
        ++completed;
        if (engine->engine == "ode" || engine->engine == "jolt" || engine->engine == "rapier") {
            EXPECT_LT(find_distance(run, truth).position, 1e-3);
        }
    }
    EXPECT_GT(completed, 1);
}

TEST(EngineFormulas, FailWithoutAFiniteValue) {
    SKIP_WITHOUT_ENGINES();
    const Scene scene = loaded_body(R"({"type": "torque", "frame": "body", "formula": "[sqrt(0.5 - t), 0, 0]"})");
    for (const EngineMethod* engine : engines_tested()) {
        const Trajectory run = run_loads(*engine, scene, 1. / 64);
        if (is_unsupported(*engine, run)) continue;
        EXPECT_EQ(run.status, Status::failed);
        EXPECT_EQ(run.message, engine->engine + ": a formula has no finite value at t = 0.515625 s");
    }
}

// The JSON form documented in README.md.
TEST(EngineFormulas, AreSentAsOperations) {
    const Scene scene = parse_scene(R"json({"name": "sent", "duration": 1, "body": {"mass": 2, "inertia": [1, 2, 3]},
        "parameters": {"k": 0.5}, "loads": [{"type": "force", "frame": "world", "until": 0.5, "point": [0, 0, 1],
          "formula": ["k*mass*t", "hold(p.x, 0.25)", "if(v.y >= 3, 1, sin(t))"]}]})json",
                                    "sent");
    const Problem problem = pose(scene);
    const std::optional<EngineFormulas> formulas = body_formulas(scene, problem.body, {1, 0, 0, 0}, {});
    ASSERT_TRUE(formulas);
    const nlohmann::json sent = write_formulas(*formulas);
    EXPECT_EQ(sent["holds"].size(), 1u);
    EXPECT_EQ(sent["holds"][0]["period"], 0.25);
    EXPECT_EQ(sent["holds"][0]["input"], 14);
    EXPECT_EQ(sent["axes"], nlohmann::json::parse("[[1, 0, 0, 0]]").get<nlohmann::json>());
    ASSERT_EQ(sent["loads"].size(), 1u);
    const nlohmann::json& load = sent["loads"][0];
    EXPECT_EQ(load["type"], "force");
    EXPECT_EQ(load["until"], 0.5);
    EXPECT_FALSE(load.contains("from"));
    const auto operation = [&](int component) {
        return sent["operations"][load["value"][component].get<std::size_t>()];
    };
    EXPECT_EQ(operation(0)[0], "multiply");
    EXPECT_EQ(operation(1), nlohmann::json({"input", 14}));
    EXPECT_EQ(operation(2)[0], "choose");
    EXPECT_EQ(operation(2)[2], "not_negative");
    // constants are sent as their values
    for (const nlohmann::json& each : sent["operations"]) EXPECT_NE(each[0], "constant");
    // the window's end and the multiples of the period
    EXPECT_EQ(sent["times"], nlohmann::json({0.25, 0.5, 0.75}));
    EXPECT_EQ(align_to_steps(*formulas, 1, 1, 4).times, (std::vector<double>{0.25, 0.5, 0.75}));
    EXPECT_EQ(write_formulas(read_formulas(sent)), sent);
    EXPECT_THROW(read_formulas({{"axes", nlohmann::json::array()},
                                {"coordinates", nlohmann::json::array()},
                                {"times", nlohmann::json::array()},
                                {"operations", nlohmann::json::parse(R"([["tan", 0]])")}}),
                 std::invalid_argument);
}

}  // namespace
}  // namespace polhode
