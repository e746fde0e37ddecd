// Limits, friction, armature, motors and couplings of joints in every available engine, on motions that are known in
// closed form or computed by the event-driven method taylor.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "body/orientation.h"
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
                    // rebound of soft limits and of position correction: at most 0.2 of the speed for 0.65 s, of Havok
                    // 0.36 (measured)
                    EXPECT_LT(worst_distance(run, truth), engine->engine == "havok" ? 0.25 : 0.2);
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
            // without friction the error is above 0.4 m. Havok loses part of small velocity changes, the last swing of
            // the oscillator included (measured: 0.12)
            EXPECT_LT(worst_distance(run, truth), engine->engine == "havok" ? 0.15 : 0.03);
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

// The body stays within the limit up to the distance of one step (1 rad/s or 1 m/s times 1/1000 s) and the engine's
// tolerance: PhysX, Jolt and Havok correct positions, Bullet and ODE velocities. Soft limits are not tested.
TEST(EngineJointLaws, StayWithinTheirLimits) {
    SKIP_WITHOUT_ENGINES();
    const double step = 1e-3, upper = 1;
    for (const char* type : {"revolute", "prismatic"})
        for (const EngineMethod* engine : engines_with_laws()) {
            if (engine->engine.starts_with("mujoco") && engine->setting != "stiff") continue;
            SCOPED_TRACE(fmt::format("{} {}", engine->method->name, type));
            const Scene scene = stopped_body(type, false, 1, 0);
            Settings settings;
            settings.step = step, settings.samples = std::lround(scene.duration / step), settings.seconds_limit = 60;
            const Trajectory run = solve(scene, *engine->method, settings);
            if (is_refused(*engine, run)) continue;
            ASSERT_EQ(run.status, Status::ok) << run.message;
            // the displacement from the start is the coordinate minus 0.4
            const bool is_hinge = std::string(type) == "revolute";
            const Sample& first = run.samples.front();
            double farthest = 0;
            for (const Sample& s : run.samples)
                farthest = std::max(farthest, is_hinge ? rotation_angle_between(s.q, first.q)
                                                       : hypotenuse(s.position_W - first.position_W));
            EXPECT_GT(farthest, upper - 0.4 - 2e-3);
            EXPECT_LT(farthest, upper - 0.4 + 2.1e-3);
        }
}

// The rebound from PhysX's limits depends on where the limit lies within a step: it is at most the requested part of
// the speed, and none in some steps.
TEST(EngineJointLaws, BounceAtMostAsRequestedInPhysX) {
    SKIP_WITHOUT_ENGINES();
    for (const EngineMethod* engine : engines_with_laws()) {
        if (engine->engine != "physx") continue;
        for (const char* type : {"revolute", "prismatic"}) {
            SCOPED_TRACE(type);
            double fastest = 0;
            for (int i = 0; i < 16; ++i) {
                Scene scene = stopped_body(type, false, 1, 0.5);
                scene.joints[0].coordinate[0] += 1e-4 * i;
                const Trajectory run = run_engine(*engine, scene, 1e-3);
                ASSERT_EQ(run.status, Status::ok) << run.message;
                const Sample& last = run.samples.back();
                const double rate = std::string(type) == "revolute" ? -hypotenuse(angular_velocity_W(last))
                                                                    : -hypotenuse(last.velocity_W);
                EXPECT_GE(rate, -0.5 - 1e-3);
                fastest = std::max(fastest, -rate);
            }
            EXPECT_GT(fastest, 0.3);
        }
    }
}

// Without other loads, the rate falls by F / m per second to zero at the time m v / F.
TEST(EngineJointLaws, StopByFrictionAtTheTimeInClosedForm) {
    SKIP_WITHOUT_ENGINES();
    const double mass = 2, moment = 0.5, v = 1, stop = 1, step = 1e-3;
    int completed = 0;
    for (const bool is_hinge : {true, false}) {
        const double friction = (is_hinge ? moment : mass) * v / stop;
        const Scene scene = parse_scene(
            fmt::format(R"({{"name": "slowed", "duration": 1.5, "bodies": [{{"name": "b", "body": {{"mass": {},
                "inertia": [{}, {}, {}]}}}}], "joints": [{{"name": "j", "type": "{}", "parent": "world", "child": "b",
                "axis": [0, 1, 0], "initial": {{"{}": {}}}, "friction": {}}}]}})",
                        mass, moment, moment, moment, is_hinge ? "revolute" : "prismatic", is_hinge ? "rate" : "speed",
                        v, friction),
            "slowed");
        for (const EngineMethod* engine : engines_with_laws()) {
            if (engine->engine.starts_with("mujoco") && engine->setting != "stiff") continue;
            SCOPED_TRACE(fmt::format("{} {}", engine->method->name, is_hinge));
            const Trajectory run = run_engine(*engine, scene, step);
            if (is_refused(*engine, run)) continue;
            ASSERT_EQ(run.status, Status::ok) << run.message;
            ++completed;
            for (const Sample& s : run.samples) {
                const double rate = is_hinge ? angular_velocity_W(s)[1] : s.velocity_W[1];
                // one step at the start or the end, and the soft motors of MuJoCo and cannon-es; Havok loses part of
                // small velocity changes (measured: 0.012)
                const double tolerance = engine->engine == "havok" ? 0.02 : 2 * step * v / stop;
                EXPECT_NEAR(rate, std::max(0.0, v * (1 - s.t / stop)), tolerance) << s.t;
            }
        }
    }
    EXPECT_GT(completed, 10);
}

// A constant motor is the same load as a motor given by a formula, which the drivers apply on another path, and turns a
// body by T t^2 / (2 J), up to T t h / (2 J) of a first-order step.
TEST(EngineJointLaws, MotorsEqualFormulasAndTheClosedForm) {
    SKIP_WITHOUT_ENGINES();
    const double torque = 0.25, moment = 0.5, step = 1e-3;
    const auto driven = [&](const std::string& load) {
        return parse_scene(fmt::format(R"({{"name": "driven", "duration": 1, "bodies": [{{"name": "b",
            "body": {{"mass": 2, "inertia": [{}, {}, {}]}}}}], "joints": [{{"name": "j", "type": "revolute",
            "parent": "world", "child": "b", "axis": [0, 1, 0]}}], "loads": [{{"type": "motor", "joint": "j", {}}}]}})",
                                       moment, moment, moment, load),
                           "driven");
    };
    const Scene constant = driven(fmt::format(R"("torque": {})", torque)),
                formula = driven(fmt::format(R"("formula": "{}")", torque));
    for (const EngineMethod* engine : engines_with_laws()) {
        SCOPED_TRACE(engine->method->name);
        const Trajectory run = run_engine(*engine, constant, step), other = run_engine(*engine, formula, step);
        ASSERT_EQ(run.status, Status::ok) << run.message;
        ASSERT_EQ(other.status, Status::ok) << other.message;
        const double t = constant.duration, exact = torque * t * t / (2 * moment);
        const auto angle = [](const Trajectory& of) {
            return 2 * std::atan2(of.samples.back().q.y, of.samples.back().q.w);
        };
        // binary32: 1000 increments of the angle; Havok loses part of small velocity changes (measured: 0.02)
        EXPECT_NEAR(angle(run), angle(other), 2e-5);
        EXPECT_NEAR(angle(run), exact, engine->engine == "havok" ? 0.03 : torque * t * step / moment);
    }
}

// Each refusal is one line that names the engine and what it does not support.
TEST(EngineJointLaws, NameWhatAnEngineDoesNotSupport) {
    SKIP_WITHOUT_ENGINES();
    Scene one_sided = stopped_body("revolute", false, 1, 0);
    one_sided.joints[0].limits.lower = -std::numeric_limits<double>::infinity();
    Scene with_armature = stopped_body("revolute", false, 1, 0);
    with_armature.joints[0].limits = {}, with_armature.joints[0].armature[0] = 1;
    const Scene bouncing_hinge = stopped_body("revolute", false, 1, 0.5),
                bouncing_rail = stopped_body("prismatic", false, 1, 0.5),
                stopped = stopped_body("revolute", false, 1, 0), geared = find_scene("joints/pendulum_with_rotor");
    const char* both_sides = "supports limits of revolute joints only on both sides within pi of the start";
    const char *no_restitution = "does not support restitution", *no_armature = "does not support armature",
               *no_couplings = "does not support couplings";
    const struct {
        const char* engine;
        const Scene* scene;
        const char* message;
    } refusals[] = {{"jolt", &one_sided, both_sides},
                    {"jolt", &bouncing_rail, no_restitution},
                    {"jolt", &with_armature, no_armature},
                    {"physx", &one_sided, both_sides},
                    {"physx", &with_armature, no_armature},
                    {"rapier", &one_sided, both_sides},
                    {"rapier", &bouncing_hinge, no_restitution},
                    {"rapier", &with_armature, no_armature},
                    {"rapier", &geared, no_couplings},
                    {"havok", &one_sided, both_sides},
                    {"havok", &bouncing_rail, no_restitution},
                    {"havok", &with_armature, no_armature},
                    {"havok", &geared, no_couplings},
                    {"ammo", &one_sided, both_sides},
                    {"ammo", &bouncing_rail, "supports restitution only at the limits of revolute joints"},
                    {"ammo", &with_armature, no_armature},
                    {"ammo", &geared, no_couplings},
                    {"cannon_es", &stopped, "does not support limits"},
                    {"cannon_es", &with_armature, no_armature},
                    {"cannon_es", &geared, no_couplings}};
    for (const EngineMethod* engine : engines_with_laws())
        for (const auto& [name, scene, message] : refusals) {
            if (engine->engine != name) continue;
            SCOPED_TRACE(fmt::format("{} {}", name, message));
            const Trajectory run = run_engine(*engine, *scene, 1e-3);
            EXPECT_EQ(run.status, Status::unsupported);
            EXPECT_TRUE(run.message.starts_with(fmt::format("{}: ", name))) << run.message;
            EXPECT_NE(run.message.find(message), std::string::npos) << run.message;
            EXPECT_EQ(run.message.find('\n'), std::string::npos) << run.message;
        }
}

// Gears and racks of Jolt and PhysX act between bodies that rotate or slide relative to the world.
TEST(EngineJointLaws, RefuseGearsOfJointsOnBodies) {
    SKIP_WITHOUT_ENGINES();
    const Scene scene = parse_scene(R"({"name": "geared", "duration": 1, "bodies": [
          {"name": "a", "body": {"mass": 3, "inertia": [1, 1, 1]}},
          {"name": "b", "body": {"mass": 2, "inertia": [0.5, 0.5, 0.5]}}],
        "joints": [{"name": "i", "type": "revolute", "parent": "world", "child": "a", "axis": [0, 1, 0]},
                   {"name": "j", "type": "revolute", "parent": "a", "child": "b", "axis": [0, 1, 0]}],
        "couplings": [{"first": "i", "second": "j", "ratio": 2}]})",
                                    "geared");
    for (const EngineMethod* engine : engines_with_laws()) {
        if (engine->engine != "jolt" && engine->engine != "physx") continue;
        const Trajectory run = run_engine(*engine, scene, 1e-3);
        EXPECT_EQ(run.status, Status::unsupported);
        EXPECT_NE(run.message.find("supports couplings only of"), std::string::npos) << run.message;
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
            // DART's mimic joint exerts no force on the joint that it follows. Jolt's gear exerts the same torque on
            // both bodies (GearConstraintPart::ApplyVelocityStep does not multiply the second one by the ratio); its
            // rack is right
            const bool is_unbalanced = (engine->engine == "dart" && !scene.couplings.empty()) ||
                                       (engine->engine == "jolt" && scene.name == "joints/pendulum_with_rotor");
            if (is_unbalanced)
                EXPECT_GT(worst, 0.1);
            else  // of 16 rad/s; Havok loses part of small velocity changes (measured: 0.84)
                EXPECT_LT(worst, engine->engine == "havok" ? 1 : 0.05);
        }
    }
}

}  // namespace
}  // namespace polhode
