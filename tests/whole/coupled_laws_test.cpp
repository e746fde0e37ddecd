// Friction, limits and prescribed motions of joints in scenes with couplings and loops, against closed forms and
// equivalent trees.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "integrators/contact/solve_joints.h"
#include "integrators/method.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"
#include "motion/massless.h"
#include "motion/problem.h"
#include "scene/scene.h"
#include "scene/scene_file.h"
#include "whole/exact_rows.h"

namespace polhode {
namespace {

using massless::body_of, massless::joint_of, massless::scene_of;

DecimalReference reference_of(const Scene& scene, long samples = 1) {
    DecimalReference truth = decimal_reference(scene, samples, 22);
    EXPECT_TRUE(truth.available) << truth.message;
    EXPECT_LE(truth.bound, 1e-22);
    return truth;
}
// A column of a body in the last row.
Exact at_end(const DecimalReference& truth, const Scene& scene, std::size_t body, std::size_t column) {
    return Exact(truth.columns[truth.columns.size() - scene.bodies.size() + body][column]);
}
void expect_digits(const Exact& value, const Exact& expected) { expect_equal(value, expected, 1e-21); }
// The method taylor ends where the reference does.
void expect_taylor_agrees(const Scene& scene, const DecimalReference& truth) {
    Settings settings;
    settings.samples = 1, settings.tolerance = 1e-12;
    const Trajectory run = solve(pose(scene), *find_method("taylor"), settings);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    for (std::size_t body = 0; body < scene.bodies.size(); ++body)
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_NEAR(run.samples[run.samples.size() - scene.bodies.size() + body].position_W[i],
                        static_cast<double>(at_end(truth, scene, body, position + i)), 1e-10);
}

std::vector<contact::JointEvent<double>> events_of(const Scene& scene) {
    const Problem problem = pose(scene);
    Settings settings;
    settings.samples = 1, settings.tolerance = 1e-13;
    return contact::follow_joints_in_binary64(problem, settings).events;
}

// Two blocks of 1 and 2 kg on rails; the second moves by -2 times the displacement of the first.
Scene geared_blocks(double speed, double duration) {
    Scene scene = scene_of("geared", duration);
    scene.bodies = {body_of("one", 1, {1, 1, 1}), body_of("two", 2, {1, 1, 1})};
    scene.joints = {joint_of("first", JointType::prismatic, "world", "one", {1, 0, 0}),
                    joint_of("second", JointType::prismatic, "world", "two", {1, 0, 0})};
    scene.couplings = {{"first", "second", -2, 0}};
    scene.joints[0].rate[0] = speed, scene.joints[1].rate[0] = -2 * speed;
    return scene;
}

// On the first block's coordinate: mass 1 + 4 * 2 = 9 and friction 1 + 2 * 0.5 = 2.
TEST(CoupledLaws, FrictionOfBothJointsStopsThem) {
    const FreshCache cache;
    Scene scene = geared_blocks(4, 20);
    scene.joints[0].friction = 1, scene.joints[1].friction = 0.5;
    const DecimalReference truth = reference_of(scene);
    expect_digits(at_end(truth, scene, 0, position), 36);
    expect_digits(at_end(truth, scene, 1, position), -72);
    const auto events = events_of(scene);
    ASSERT_EQ(events.size(), 1u);
    EXPECT_EQ(events[0].kind, contact::JointEventKind::sticks);
    EXPECT_NEAR(events[0].t, 18, 1e-10);
    expect_taylor_agrees(scene, truth);
}

// The second block, at -2 x, reaches its limit at -3; it returns with half the speed. The impulse on its coordinate is
// that of the first, 9 * 1.5 * 2, over the ratio -2.
TEST(CoupledLaws, ALimitOfTheSecondJointReturnsBoth) {
    const FreshCache cache;
    Scene scene = geared_blocks(2, 2);
    scene.joints[0].limits.upper = 8;
    scene.joints[1].limits.lower = -3, scene.joints[1].limits.restitution = 0.5;
    const DecimalReference truth = reference_of(scene);
    const auto events = events_of(scene);
    ASSERT_EQ(events.size(), 1u);
    EXPECT_EQ(events[0].joint, 1u);
    EXPECT_NEAR(events[0].t, 0.75, 1e-12);
    EXPECT_NEAR(events[0].impulse, 13.5, 1e-11);
    expect_digits(at_end(truth, scene, 0, position), Exact(1.5) - Exact(1.25));
    expect_digits(at_end(truth, scene, 1, velocity), 2);
    expect_taylor_agrees(scene, truth);
}

// A weight of 10 N on the first coordinate: friction F on the second one, which moves three times as far, holds it if
// 3 F >= 10. Otherwise the acceleration is (10 - 3 F) / (1 + 9 * 2).
TEST(CoupledLaws, FrictionBehindAGearHoldsAWeight) {
    const FreshCache cache;
    for (const double friction : {3.5, 3.25}) {
        Scene scene = geared_blocks(0, 4);
        scene.couplings[0].ratio = 3;
        scene.joints[1].friction = friction;
        scene.loads = {Force{{10, 0, 0}, Frame::world, {}, Frame::body, {}, "one"}};
        const DecimalReference truth = reference_of(scene);
        const Exact pull = 10 - 3 * Exact(friction);
        expect_digits(at_end(truth, scene, 0, position), pull > 0 ? Exact(pull / 19 * 8) : Exact(0));
    }
}

TEST(CoupledLaws, LimitsThatLeaveNoRoomAreRefused) {
    Scene scene = geared_blocks(0, 1);
    scene.joints[0].limits.lower = 0, scene.joints[0].limits.upper = 1;
    scene.joints[1].limits.lower = 0, scene.joints[1].limits.upper = 1;
    try {
        parse_scene(write_scene(scene), "copy.json");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("/joints/0/limits"), std::string::npos) << error.what();
    }
}

std::string linkage(const std::string& motion) {
    return R"({"name": "slider_crank", "duration": 2,
        "bodies": [{"name": "crank", "body": {"shape": {"type": "box", "half_extents": [0.375, 0.0625, 0.0625]}, "mass": 2}},
                   {"name": "rod", "body": {"shape": {"type": "box", "half_extents": [0.625, 0.03125, 0.0625]}, "mass": 1}},
                   {"name": "slider", "body": {"shape": {"type": "box", "half_extents": [0.125, 0.125, 0.125]}, "mass": 3}}],
        "joints": [{"name": "bearing", "type": "revolute", "parent": "world", "child": "crank", "child_point": [-0.375, 0, 0],
                    "axis": [0, -1, 0], "motion": ")" +
           motion + R"("},
                   {"name": "pin", "type": "revolute", "parent": "crank", "parent_point": [0.375, 0, 0], "child": "rod",
                    "child_point": [-0.625, 0, 0], "axis": [0, -1, 0], "initial": {"angle": -1.6, "dependent": true}},
                   {"name": "guide", "type": "prismatic", "parent": "world", "child": "slider", "axis": [1, 0, 0],
                    "initial": {"displacement": 1.5, "dependent": true}}],
        "loops": [{"name": "wrist", "type": "revolute", "first": "rod", "first_point": [0.625, 0, 0],
                   "first_axis": [0, 1, 0], "second": "slider", "second_axis": [0, 1, 0]}],
        "loads": [{"type": "gravity", "acceleration": [0, 0, -9.75]}]})";
}

// x = r cos a + sqrt(l^2 - r^2 sin^2 a) for the angle a of the crank of r = 0.75 and the rod of l = 1.25.
TEST(PrescribedMotion, DrivesASliderCrank) {
    const FreshCache cache;
    const Scene scene = parse_scene(linkage("1 + 3*t + 0.5*sin(2*t)"), "linkage.json");
    const DecimalReference truth = reference_of(scene);
    const Exact a = 7 + Exact(sin(Exact(4))) / 2, a_rate = 3 + Exact(cos(Exact(4)));
    const Exact r(0.75), l(1.25), root = sqrt(Exact(l * l - r * r * sin(a) * sin(a)));
    expect_digits(at_end(truth, scene, 2, position), r * cos(a) + root);
    expect_digits(at_end(truth, scene, 2, velocity), -(r * sin(a) + r * r * sin(a) * cos(a) / root) * a_rate);
    expect_taylor_agrees(scene, truth);
}

// The second block follows the first by the ratio.
TEST(PrescribedMotion, DrivesCoupledJoints) {
    const FreshCache cache;
    Scene scene = geared_blocks(0, 3);
    scene.joints[0].motion = "sin(t)", scene.joints[0].rate[0] = 1;
    scene.joints[1].rate[0] = 0, scene.joints[1].dependent = true;
    const DecimalReference truth = reference_of(scene);
    expect_digits(at_end(truth, scene, 1, position), -2 * Exact(sin(Exact(3))));
    expect_digits(at_end(truth, scene, 1, velocity), -2 * Exact(cos(Exact(3))));
    scene.joints[1].friction = 1;
    EXPECT_THROW(parse_scene(write_scene(scene), "copy.json"), InputError);
}

std::string bar(const char* name, double length) {
    return fmt::format(
        R"({{"name": "{}", "body": {{"shape": {{"type": "box", "half_extents": [{}, 0.0625, 0.0625]}}, "mass": 1}}}})",
        name, length / 2);
}

// A parallelogram of two cranks of 1 m and a coupler of 2 m, which keeps its direction. As a tree, couplings replace
// the loop: the coupler turns by minus the angle of the first crank, and the second crank by the same angle.
std::string parallelogram(const std::string& laws, bool as_loop) {
    const auto hinge = [&](const char* name, const char* parent, const char* at, const char* child, double half,
                           double start, const std::string& more) {
        return fmt::format(
            R"({{"name": "{}", "type": "revolute", "parent": "{}", "parent_point": [{}, 0, 0], "child": "{}",
            "child_point": [{}, 0, 0], "axis": [0, 1, 0], {} "initial": {{"angle": {}{}}}}})",
            name, parent, at, child, -half, more, start, name == std::string("left") ? "" : R"(, "dependent": true)");
    };
    return fmt::format(
        R"({{"name": "parallelogram", "duration": 3, "bodies": [{}, {}, {}], "joints": [{}, {}, {}], {},
            "loads": [{{"type": "gravity", "acceleration": [0, 0, -9.75]}}]}})",
        bar("one", 1), bar("across", 2), bar("two", 1), hinge("left", "world", "0", "one", 0.5, 1, laws),
        hinge("top", "one", "0.5", "across", 1, -1, ""), hinge("right", "world", "2", "two", 0.5, 1, ""),
        as_loop
            ? R"("loops": [{"name": "closure", "type": "revolute", "first": "across", "first_point": [1, 0, 0],
                    "first_axis": [0, 1, 0], "second": "two", "second_point": [0.5, 0, 0], "second_axis": [0, 1, 0]}])"
            : R"("couplings": [{"first": "left", "second": "top", "ratio": -1}, {"first": "left", "second": "right"}])");
}

TEST(LoopLaws, ParallelogramMovesAsTheTreeWithCouplings) {
    const FreshCache cache;
    const std::string laws = R"("friction": 1.5, "limits": {"lower": 0.5, "upper": 1.875, "restitution": 0.5},)";
    const Scene loop = parse_scene(parallelogram(laws, true), "loop.json"),
                tree = parse_scene(parallelogram(laws, false), "tree.json");
    const DecimalReference a = reference_of(loop, 6), b = reference_of(tree, 6);
    const auto of_loop = events_of(loop), of_tree = events_of(tree);
    ASSERT_EQ(of_loop.size(), of_tree.size());
    EXPECT_GE(of_loop.size(), 2u);
    for (std::size_t i = 0; i < of_loop.size(); ++i) EXPECT_NEAR(of_loop[i].t, of_tree[i].t, 1e-10);
    ASSERT_EQ(a.columns.size(), b.columns.size());
    for (std::size_t i = 0; i < a.columns.size(); ++i)
        for (std::size_t k = position; k < velocity + 3; ++k)
            expect_digits(Exact(a.columns[i][k]), Exact(b.columns[i][k]));
    expect_taylor_agrees(loop, a);
    expect_taylor_agrees(tree, b);
}

}  // namespace
}  // namespace polhode
