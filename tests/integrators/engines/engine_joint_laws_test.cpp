// Limits, friction, armature, motors and couplings of joints in every available engine, on motions that are known in
// closed form or computed by the event-driven method taylor.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "integrators/method.h"
#include "scene/scene_file.h"
#include "tests/integrators/engines/engines_here.h"

namespace polhode {
namespace {

/// The engines with their setting best, or default if they have no other; MuJoCo also with stiff constraints.
std::vector<const EngineMethod*> engines_with_laws() {
    std::vector<const EngineMethod*> all;
    std::set<std::string> seen;
    for (const EngineMethod& engine : engines_here())
        if (is_undamped(engine) && engine.setting != "rk4" && !engine.inspect(nullptr).hello.laws.empty() &&
            (engine.setting == "best" || engine.setting == "stiff" || !seen.contains(engine.engine))) {
            if (engine.setting == "best" && seen.contains(engine.engine)) all.pop_back();
            seen.insert(engine.engine), all.push_back(&engine);
        }
    return all;
}

Trajectory run_engine(const EngineMethod& engine, const Scene& scene, double step) {
    Settings settings;
    settings.step = step, settings.samples = 16, settings.seconds_limit = 60;
    return solve(scene, *engine.method, settings);
}

// A refused law is named together with the engine.
bool is_refused(const EngineMethod& engine, const Trajectory& run) {
    if (run.status != Status::unsupported) return false;
    EXPECT_NE(run.message.find(engine.engine), std::string::npos) << run.message;
    const std::vector<std::string> words{"limits",  "restitution", "friction",  "armature",
                                         "springs", "motors",      "couplings", "joints"};
    EXPECT_TRUE(std::ranges::any_of(words, [&](const std::string& word) {
        return run.message.find(word) != std::string::npos;
    })) << run.message;
    return true;
}

// The largest distance of a centre of mass from the reference over all samples.
double worst_distance(const Trajectory& run, const Trajectory& truth) {
    double worst = 0;
    for (std::size_t k = 0; k < truth.samples.size(); ++k)
        worst = std::max(worst, hypotenuse(run.samples[k].position_W - truth.samples[k].position_W));
    return worst;
}

// A body of 2 kg, 1 m from its hinge or on a rail, hits a limit with 1 rad/s or 1 m/s. `parent`: world, or a body that
// moves on a joint of its own. The frames of the joint differ from those of the bodies.
Scene stopped_body(const char* type, bool on_body, double rate, double restitution) {
    const bool is_hinge = std::string(type) == "revolute";
    const char *x = is_hinge ? "angle" : "displacement", *v = is_hinge ? "rate" : "speed";
    const std::string axis = is_hinge ? "[0, 1, 0]" : "[1, 0, 0]";
    const std::string base_body =
        on_body ? R"({"name": "a", "body": {"mass": 3, "inertia": [1, 1, 1], "center_of_mass": [0.1, 0.2, 0.3]}},)"
                : "";
    const std::string base_joint =
        on_body ? fmt::format(R"({{"name": "base", "type": "{}", "parent": "world", "child": "a", "axis": {}}},)", type,
                              axis)
                : "";
    return parse_scene(
        fmt::format(R"({{"name": "stopped", "duration": 1.25, "bodies": [{} {{"name": "b", "body": {{"mass": 2,
          "inertia": [0.5, 0.5, 0.5], "center_of_mass": [1, 0, 0]}}}}],
          "joints": [{} {{"name": "j", "type": "{}", "parent": "{}", "child": "b", "axis": {},
            "parent_point": [0.25, 0, 0.5], "parent_orientation": [0.5, 0.5, 0.5, 0.5],
            "initial": {{"{}": 0.4, "{}": {}}}, "limits": {{"lower": -0.5, "upper": 1, "restitution": {}}}}}]}})",
                    base_body, base_joint, type, on_body ? "a" : "world", axis, x, v, rate, restitution),
        "stopped");
}

// A limit that is mirrored or missing differs from the reference by at least 0.3 m.
TEST(EngineJointLaws, StopAtTheirLimits) {
    SKIP_WITHOUT_ENGINES();
    int completed = 0;
    for (const char* type : {"revolute", "prismatic"})
        for (const bool on_body : {false, true})
            for (const double rate : {1.0, -1.0}) {
                const Scene scene = stopped_body(type, on_body, rate, 0);
                Settings settings;
                settings.samples = 16;
                const Trajectory truth = solve(scene, *find_method("taylor"), settings);
                ASSERT_EQ(truth.status, Status::ok) << truth.message;
                for (const EngineMethod* engine : engines_with_laws()) {
                    SCOPED_TRACE(fmt::format("{} {} {} {}", engine->method->name, type, on_body, rate));
                    const Trajectory run = run_engine(*engine, scene, 1e-3);
                    if (is_refused(*engine, run)) continue;
                    ASSERT_EQ(run.status, Status::ok) << run.message;
                    // rebound of soft limits and of position correction: at most 0.2 of the speed for 0.65 s (measured)
                    EXPECT_LT(worst_distance(run, truth), 0.2);
                    ++completed;
                }
            }
    EXPECT_GT(completed, 8);
}

// ODE's stops keep the requested part of the speed.
TEST(EngineJointLaws, BounceFromTheirLimits) {
    SKIP_WITHOUT_ENGINES();
    for (const EngineMethod* engine : engines_with_laws()) {
        if (engine->engine != "ode") continue;
        for (const char* type : {"revolute", "prismatic"})
            for (const bool on_body : {false, true})
                for (const double rate : {1.0, -1.0}) {
                    SCOPED_TRACE(fmt::format("{} {} {}", type, on_body, rate));
                    const Scene scene = stopped_body(type, on_body, rate, 0.5);
                    Settings settings;
                    settings.samples = 16;
                    const Trajectory truth = solve(scene, *find_method("taylor"), settings);
                    const Trajectory coarse = run_engine(*engine, scene, 4e-3), fine = run_engine(*engine, scene, 1e-3);
                    ASSERT_EQ(fine.status, Status::ok) << fine.message;
                    // at most a step late at the impact, with a change of speed by 1.5
                    EXPECT_LT(worst_distance(fine, truth), 5e-3);
                    EXPECT_LT(worst_distance(coarse, truth), 2e-2);
                }
    }
}

// Dry friction stops a pendulum away from the vertical: soft friction creeps there, rigid friction holds.
TEST(EngineJointLaws, SlowAndHoldByFriction) {
    SKIP_WITHOUT_ENGINES();
    for (const char* name : {"joints/coulomb_pendulum", "joints/coulomb_oscillator"}) {
        const Scene scene = find_scene(name);
        Settings settings;
        settings.samples = 16;
        const Trajectory truth = solve(scene, *find_method("taylor"), settings);
        ASSERT_EQ(truth.status, Status::ok) << truth.message;
        for (const EngineMethod* engine : engines_with_laws()) {
            SCOPED_TRACE(fmt::format("{} {}", engine->method->name, name));
            const Trajectory run = run_engine(*engine, scene, 1e-3);
            if (is_refused(*engine, run)) continue;
            ASSERT_EQ(run.status, Status::ok) << run.message;
            // without friction the error is above 0.4 m
            EXPECT_LT(worst_distance(run, truth), 0.03);
        }
    }
}

// First order in the step, for the engines with rigid or stiffened friction.
TEST(EngineJointLaws, ConvergeWithFriction) {
    SKIP_WITHOUT_ENGINES();
    const Scene scene = find_scene("joints/coulomb_pendulum");
    Settings settings;
    settings.samples = 16;
    const Trajectory truth = solve(scene, *find_method("taylor"), settings);
    for (const EngineMethod* engine : engines_with_laws()) {
        if (engine->engine != "ode" && engine->setting != "stiff") continue;
        SCOPED_TRACE(engine->method->name);
        const double coarse = worst_distance(run_engine(*engine, scene, 4e-3), truth),
                     fine = worst_distance(run_engine(*engine, scene, 1e-3), truth);
        EXPECT_GT(coarse, 2.5 * fine);
        EXPECT_LT(fine, 3e-3);
    }
}

// Motors on reaction wheels, a rotor as armature and behind a gear, a rack on a pinion.
TEST(EngineJointLaws, FollowMotorsArmatureAndGears) {
    SKIP_WITHOUT_ENGINES();
    for (const char* name : {"joints/reaction_wheels", "joints/pendulum_with_armature", "joints/pendulum_with_rotor",
                             "joints/rack_and_pinion"}) {
        const Scene scene = find_scene(name);
        Settings settings;
        settings.samples = 16;
        const Trajectory truth = solve(scene, *find_method("taylor"), settings);
        ASSERT_EQ(truth.status, Status::ok) << truth.message;
        for (const EngineMethod* engine : engines_with_laws()) {
            SCOPED_TRACE(fmt::format("{} {}", engine->method->name, name));
            const Trajectory run = run_engine(*engine, scene, 1e-3);
            if (is_refused(*engine, run)) continue;
            ASSERT_EQ(run.status, Status::ok) << run.message;
            double worst = 0;
            for (std::size_t k = 0; k < truth.samples.size(); ++k)
                worst = std::max(worst,
                                 hypotenuse(angular_velocity_W(run.samples[k]) - angular_velocity_W(truth.samples[k])));
            // DART's mimic joint exerts no force on the joint that it follows
            const bool is_one_way = engine->engine == "dart" && !scene.couplings.empty();
            if (is_one_way)
                EXPECT_GT(worst, 0.1);
            else
                EXPECT_LT(worst, 0.05);
        }
    }
}

}  // namespace
}  // namespace polhode
