// Every available engine, on motions known independently. Missing engines are reported and skipped.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "body/orientation.h"
#include "places.h"
#include "scene/scene_file.h"
#include "tests/integrators/engines/engines_here.h"

namespace polhode {
namespace {

constexpr double pi = std::numbers::pi;

bool has_gyroscopic_term(const EngineMethod& engine) {
    if (engine.setting == "none" || engine.engine == "havok" || engine.engine == "cannon_es" || engine.engine == "oimo")
        return false;
    return !(engine.setting == "default" &&
             (engine.engine == "jolt" || engine.engine == "physx" || engine.engine == "ammo"));
}

/// Rounding error in binary32 after a thousand steps, some of them with four substeps.
double rounding(const EngineMethod& engine) { return engine.method->precision == Precision::binary32 ? 1e-3 : 1e-6; }
/// Havok loses part of small velocity changes: 4 % of a force's effect at 1/1000 s, as measured.
bool loses_small_changes(const EngineMethod& engine) { return engine.engine == "havok"; }
bool may_sleep(const EngineMethod& engine) {
    return engine.setting == "default" && (engine.engine.starts_with("bullet") || engine.engine == "rapier" ||
                                           engine.engine == "ammo" || engine.engine == "oimo");
}

Scene scene_of(const Vector3<double>& moments, const Vector3<double>& w, double duration = 1) {
    Scene scene;
    scene.name = "known", scene.duration = duration;
    scene.body.mass = 2, scene.body.inertia_B = diagonal(moments);
    scene.initial.angular_velocity = w;
    return scene;
}

Trajectory moved(const EngineMethod& engine, const Scene& scene, double step = 1e-3) {
    Settings settings;
    settings.step = step, settings.samples = 10, settings.seconds_limit = 60;
    return solve(scene, *engine.method, settings);
}

// A sphere keeps its w in world axes from any initial attitude: tests frame, sign and order of w and q.
TEST(RealEngines, TurnABallAboutAFixedAxis) {
    SKIP_WITHOUT_ENGINES();
    for (const EngineMethod& engine : engines_here()) {
        SCOPED_TRACE(engine.method->name);
        if (!is_undamped(engine)) continue;
        Scene scene = scene_of({1, 1, 1}, {0.3, -0.4, 0.5});
        const Quaternion<double> start = quaternion_from_rotation_vector(Vector3<double>(0.2, 0.9, -0.4));
        scene.initial.orientation = start, scene.initial.angular_velocity_frame = Frame::world;
        const Trajectory run = moved(engine, scene);
        ASSERT_EQ(run.status, Status::ok) << run.message;
        const Sample& end = run.samples.back();
        const Quaternion<double> turned = quaternion_from_rotation_vector(Vector3<double>(0.3, -0.4, 0.5)) * start;
        EXPECT_LT(rotation_angle_between(end.q, turned), 1e-4 + rounding(engine));
        EXPECT_LT(hypotenuse(angular_velocity_W(end) - Vector3<double>(0.3, -0.4, 0.5)), rounding(engine));
        EXPECT_NEAR(norm(end.q), 1, 1e-6);
    }
}

// The centre of mass of a thrown body is off by at most g h t / 2, the error of semi-implicit Euler.
TEST(RealEngines, ThrowAParabola) {
    SKIP_WITHOUT_ENGINES();
    for (const EngineMethod& engine : engines_here()) {
        SCOPED_TRACE(engine.method->name);
        if (!is_undamped(engine)) continue;
        Scene scene = scene_of({1, 2, 3}, {0, 0, 1});
        scene.initial.position_W = {1, -2, 3}, scene.initial.velocity_W = {4, 5, 6};
        scene.loads.push_back(Gravity{{1, 2, -9.81}, {}});
        const Trajectory run = moved(engine, scene);
        ASSERT_EQ(run.status, Status::ok) << run.message;
        const Sample& end = run.samples.back();
        EXPECT_LT(hypotenuse(end.position_W - Vector3<double>(5.5, 4, 9 - 9.81 / 2)), 6e-3);
        EXPECT_LT(hypotenuse(end.velocity_W - Vector3<double>(5, 7, 6 - 9.81)), 2e-2);
    }
}

// A quarter rotation about each principal axis of an asymmetric body, from an arbitrary attitude.
TEST(RealEngines, TurnAQuarterAboutEachPrincipalAxis) {
    SKIP_WITHOUT_ENGINES();
    for (const EngineMethod& engine : engines_here()) {
        if (!is_undamped(engine)) continue;
        for (int axis = 0; axis < 3; ++axis) {
            SCOPED_TRACE(std::string(engine.method->name) + " " + "xyz"[axis]);
            Vector3<double> w;
            w[axis] = pi / 2;
            Scene scene = scene_of({1, 2, 3}, w);
            const Quaternion<double> start = quaternion_from_rotation_vector(Vector3<double>(-0.3, 0.5, 1));
            scene.initial.orientation = start;
            const Trajectory run = moved(engine, scene);
            ASSERT_EQ(run.status, Status::ok) << run.message;
            EXPECT_LT(rotation_angle_between(run.samples.back().q, start * quaternion_from_rotation_vector(w)), 2e-3);
        }
    }
}

// A tensor that is not diagonal, for as long as a first-order update stays close: conversion to principal axes.
TEST(RealEngines, MoveABodyWithProductsOfInertia) {
    SKIP_WITHOUT_ENGINES();
    Scene scene = find_scene("l_shape");
    scene.duration = 1;
    Settings settings;
    settings.samples = 10;
    const Trajectory truth = solve(scene, *find_method("exact"), settings);
    for (const EngineMethod& engine : engines_here()) {
        SCOPED_TRACE(engine.method->name);
        if (!is_undamped(engine)) continue;
        const Trajectory run = moved(engine, scene, 1e-3);
        ASSERT_EQ(run.status, Status::ok) << run.message;
        double worst = 0;
        for (std::size_t k = 0; k < run.samples.size(); ++k)
            worst = std::max(worst, rotation_angle_between(run.samples[k].q, truth.samples[k].q));
        if (has_gyroscopic_term(engine))
            EXPECT_LT(worst, 0.02);
        else
            EXPECT_GT(worst, 0.05);
    }
}

// From rest, by a torque about a principal axis and by a force off the centre of mass.
TEST(RealEngines, TakeTorquesAndForces) {
    SKIP_WITHOUT_ENGINES();
    for (const EngineMethod& engine : engines_here()) {
        SCOPED_TRACE(engine.method->name);
        if (!is_undamped(engine) || may_sleep(engine) || engine.setting == "default") continue;
        const double part = loses_small_changes(engine) ? 0.06 : rounding(engine);
        Scene scene = scene_of({1, 2, 3}, {});
        scene.loads.push_back(Torque{{0, 0.6, 0}, Frame::body, {}});
        Trajectory run = moved(engine, scene);
        if (run.status == Status::failed && engine.engine == "oimo") continue;
        if (run.status == Status::unsupported) continue;
        ASSERT_EQ(run.status, Status::ok) << run.message;
        EXPECT_LT(hypotenuse(run.samples.back().angular_velocity_B - Vector3<double>(0, 0.3, 0)), part);
        EXPECT_NEAR(rotation_angle_between(run.samples.back().q, scene.initial.orientation), 0.15, 1e-3 + part);
        scene.loads = {Force{{0, 0, 2}, Frame::world, {0, 0.1, 0}, Frame::body, {}}};
        run = moved(engine, scene);
        ASSERT_EQ(run.status, Status::ok) << run.message;
        EXPECT_NEAR(run.samples.back().velocity_W[2], 1, part);
        EXPECT_NEAR(run.samples.back().angular_velocity_B[0], 0.2, 2e-3 + part);
        scene.loads = {Impulse{{0, 0, 2}, Frame::world, {0, 0.1, 0}, Frame::body, 0.55}};
        run = moved(engine, scene);
        ASSERT_EQ(run.status, Status::ok) << run.message;
        EXPECT_EQ(run.samples[5].velocity_W[2], 0);
        EXPECT_NEAR(run.samples[6].velocity_W[2], 1, 1e-5);
        EXPECT_NEAR(run.samples[6].angular_velocity_B[0], 0.2, 1e-5);
    }
}

// Small oscillations of a pendulum about a spherical joint, for one period.
TEST(RealEngines, SwingAtAPivot) {
    SKIP_WITHOUT_ENGINES();
    for (const EngineMethod& engine : engines_here()) {
        SCOPED_TRACE(engine.method->name);
        if (!is_undamped(engine) || may_sleep(engine) || loses_small_changes(engine)) continue;
        Scene scene = scene_of({1, 2, 3}, {});
        // moment about the pivot 1 + 2 kg m^2
        scene.pivot = Vector3<double>(0, 0, 1), scene.duration = 2 * pi * std::sqrt(3 / (2 * 9.81));
        scene.loads.push_back(Gravity{{0, 0, -9.81}, {}});
        scene.initial.orientation = quaternion_from_rotation_vector(Vector3<double>(0.05, 0, 0));
        const Trajectory run = moved(engine, scene);
        if (run.status == Status::unsupported) continue;
        ASSERT_EQ(run.status, Status::ok) << run.message;
        EXPECT_LT(rotation_angle_between(run.samples.back().q, scene.initial.orientation), 5e-3);
        EXPECT_NEAR(rotation_angle_between(run.samples[5].q, scene.initial.orientation), 0.1, 5e-3);
        EXPECT_LT(hypotenuse(run.samples[5].position_W + rotate(normalized(run.samples[5].q), *scene.pivot)), 2e-3);
    }
}

// A sphere dropped on a plane with restitution 1, one bounce.
TEST(RealEngines, BounceFromAPlane) {
    SKIP_WITHOUT_ENGINES();
    Scene scene = find_scene("bouncing_ball");
    scene.duration = 0.7, scene.initial.angular_velocity = {};
    for (const EngineMethod& engine : engines_here()) {
        SCOPED_TRACE(engine.method->name);
        if (!engine.method->planes) continue;
        const Trajectory run = moved(engine, scene);
        if (engine.engine.starts_with("mujoco")) {
            EXPECT_EQ(run.status, Status::unsupported);
            EXPECT_NE(run.message.find("restitution"), std::string::npos) << run.message;
            continue;
        }
        ASSERT_EQ(run.status, Status::ok) << run.message;
        double lowest = 0, highest = 0;
        for (const Sample& s : run.samples)
            lowest = std::min(lowest, s.velocity_W[2]), highest = std::max(highest, s.velocity_W[2]);
        EXPECT_LT(lowest, -1);
        EXPECT_GT(highest, 1);
    }
}

// A ball that slides without rotation is slowed by mu g: along an axis of the plane, so that pyramids agree. Measured:
// 0.96 mu g (mujoco) to 1.01 mu g, and damping of at most 0.05 v. cannon-es limits the impulse of a step by mu m g, not
// by mu m g h: the ball rolls at once.
TEST(RealEngines, SlideWithTheRequestedFriction) {
    SKIP_WITHOUT_ENGINES();
    Scene scene = find_scene("contact/ball_incline_rolls");
    scene.duration = 0.25, scene.loads = {Gravity{{0, 0, -9.81}, {}}}, scene.initial.velocity_W = {4, 0, 0};
    for (const double friction : {0.1, 0.25}) {
        scene.planes[0].friction = friction;
        for (const EngineMethod& engine : engines_here()) {
            SCOPED_TRACE(engine.method->name);
            if (!engine.method->planes) continue;
            const Trajectory run = moved(engine, scene);
            ASSERT_EQ(run.status, Status::ok) << run.message;
            const Vector3<double> v = run.samples.back().velocity_W;
            if (engine.engine == "cannon_es")
                EXPECT_NEAR(v[0], 4 * 5.0 / 7, 0.05);
            else
                EXPECT_NEAR((4 - v[0]) / 0.25, friction * 9.81,
                            0.05 * friction * 9.81 + (is_undamped(engine) ? 0 : 0.2));
            EXPECT_NEAR(v[1], 0, 1e-3);
        }
    }
}

// Bodies of every shape that an engine lists rest on a plane where they are put: sizes, axes and positions of shapes.
TEST(RealEngines, RestOnRoundShapes) {
    SKIP_WITHOUT_ENGINES();
    const std::string lying = R"("orientation": [0.7071067811865476, 0.7071067811865476, 0, 0], )";
    struct Resting {
        std::string body, initial;
    };
    const Resting resting[] = {
        {R"("shape": {"type": "sphere", "radius": 0.25})", R"("position": [0, 0, 0.25])"},
        {R"("shape": {"type": "capsule", "radius": 0.25, "half_height": 0.5})", lying + R"("position": [0, 0, 0.25])"},
        {R"("shape": {"type": "cylinder", "radius": 0.25, "half_height": 0.5})", R"("position": [0, 0, 0.5])"},
        {R"("shape": {"type": "cylinder", "radius": 0.25, "half_height": 0.5})", lying + R"("position": [0, 0, 0.25])"},
        {R"("shape": {"type": "disc", "radius": 0.25})", R"("position": [0, 0, 0])"},
        {R"("shape": {"type": "ellipsoid", "semi_axes": [0.5, 0.375, 0.25]})", R"("position": [0, 0, 0.25])"},
        {R"("shape": {"type": "box", "half_extents": [0.5, 0.25, 0.125]})", lying + R"("position": [0, 0, 0.25])"},
        // heavier below: the centre of mass is 0.04 m below the centre
        {R"("parts": [{"shape": {"type": "sphere", "radius": 0.25}, "mass": 1}, {"shape": {"type": "sphere", "radius": 0.05}, "mass": 0.25, "position": [0, 0, -0.2]}])",
         R"("position": [0, 0, 0.21])"},
        {R"("parts": [{"shape": {"type": "sphere", "radius": 0.25}, "mass": 1, "position": [0.5, 0, 0]}, {"shape": {"type": "sphere", "radius": 0.25}, "mass": 1, "position": [-0.5, 0, 0]}])",
         R"("position": [0, 0, 0.25])"}};
    for (const Resting& one : resting) {
        SCOPED_TRACE(one.body);
        const std::string mass = one.body.starts_with("\"shape") ? R"(, "mass": 2)" : "";
        const Scene scene = parse_scene(R"({"name": "resting", "duration": 1, "body": {)" + one.body + mass +
                                            R"(}, "initial": {)" + one.initial +
                                            R"(}, "loads": [{"type": "gravity", "acceleration": [0, 0, -9.81]}],
            "planes": [{"normal": [0, 0, 1], "offset": 0, "restitution": 0, "friction": 0.5}]})",
                                        "resting");
        const double height = scene.initial.position_W[2];
        std::size_t completed = 0;
        for (const EngineMethod& engine : engines_here()) {
            SCOPED_TRACE(engine.method->name);
            if (!engine.method->planes) continue;
            const Trajectory run = moved(engine, scene, 1.0 / 240);
            if (run.status == Status::unsupported) continue;
            ASSERT_EQ(run.status, Status::ok) << run.message;
            const Sample& end = run.samples.back();
            EXPECT_NEAR(end.position_W[2], height, 2e-3);
            EXPECT_LT(std::hypot(end.position_W[0], end.position_W[1]), 2e-3);
            EXPECT_LT(rotation_angle_between(end.q, scene.initial.orientation), 5e-3);
            ++completed;
        }
        EXPECT_GT(completed, 0u);
    }
}

// The engine's body is the requested one, and repeating a request gives the same answer, also in another process.
TEST(RealEngines, HaveTheRequestedBodyAndRepeat) {
    SKIP_WITHOUT_ENGINES();
    const auto list = std::filesystem::path(program_path()).parent_path() / "engines" / "engines.json";
    const std::vector<EngineMethod> others = read_engines(list.string());
    for (const EngineMethod& engine : engines_here()) {
        SCOPED_TRACE(engine.method->name);
        Scene scene = scene_of({1, 2, 2.5}, {1, 1.1, 0.9});
        scene.initial.position_W = {1, 2, 3}, scene.initial.velocity_W = {-1, 0.5, 2};
        const Problem problem = pose(scene);
        const EngineReport report = engine.inspect(&problem);
        EXPECT_EQ(report.fault, "");
        EXPECT_FALSE(report.hello.version.empty());
        EXPECT_LT(report.difference.value(), 1e-6);
        const auto other =
            std::ranges::find(others, engine.method->name, [](const EngineMethod& e) { return e.method->name; });
        const Trajectory first = moved(engine, scene), second = moved(*other, scene);
        ASSERT_EQ(first.samples.size(), second.samples.size());
        for (std::size_t k = 0; k < first.samples.size(); ++k) EXPECT_EQ(first.samples[k].q, second.samples[k].q);
    }
}

// A driver refuses what it does not support and continues to work.
TEST(RealEngines, RefuseAndLiveOn) {
    SKIP_WITHOUT_ENGINES();
    for (const EngineMethod& engine : engines_here()) {
        SCOPED_TRACE(engine.method->name);
        if (!engine.method->planes) {
            EXPECT_EQ(moved(engine, find_scene("bouncing_ball")).status, Status::unsupported);
        }
        EXPECT_EQ(moved(engine, scene_of({1, 1, 1}, {0, 0, 1}, 0.1)).status, Status::ok);
    }
}

}  // namespace
}  // namespace polhode
