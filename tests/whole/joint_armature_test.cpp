// Armature of joints: the reference solution against explicit rotors and against Lagrange's equations written out here,
// and methods against the reference.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "integrators/method.h"
#include "integrators/series/real.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"
#include "motion/massless.h"
#include "motion/problem.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

using massless::body_of, massless::joint_of, massless::scene_of;
using Digits = Real<50>;

// A pendulum with an armature d moves as one with a balanced flywheel of moment d on its hinge axis.
TEST(JointArmature, EqualsAnExplicitRotorTo28Digits) {
    const FreshCache cache;
    constexpr double d = 0.375;
    Scene reflected = scene_of("reflected", 3);
    reflected.bodies = {body_of("arm", 1.5, {0.25, 0.5, 0.375}, {0.25, 0, -0.5})};
    reflected.joints = {joint_of("hinge", JointType::revolute, "world", "arm", {0, 1, 0}, {0.125, 0, 1})};
    reflected.joints[0].coordinate[0] = 1.25, reflected.joints[0].rate[0] = 2;
    reflected.joints[0].stiffness[0] = 3, reflected.joints[0].damping[0] = 0.125;
    reflected.loads = {Gravity{{0, 0, -9.75}, {}}};
    Scene with_rotor = reflected;
    with_rotor.bodies.push_back(body_of("rotor", 0.5, {d / 2, d, d / 2}));
    with_rotor.joints.push_back(joint_of("shaft", JointType::fixed, "arm", "rotor"));
    reflected.joints[0].armature[0] = d;
    const DecimalReference one = decimal_reference(reflected, 6, 28), other = decimal_reference(with_rotor, 6, 28);
    ASSERT_TRUE(one.available) << one.message;
    ASSERT_TRUE(other.available) << other.message;
    EXPECT_NE(one.message.find("maximal coordinates"), std::string::npos) << one.message;
    for (std::size_t k = 0; k <= 6; ++k)
        for (std::size_t c = 0; c < 13; ++c)
            EXPECT_LT(abs(Digits(Digits(one.columns[k][c]) - Digits(other.columns[2 * k][c]))), 1e-27) << k << " " << c;
    // the armature is not negligible
    reflected.joints[0].armature[0] = 0;
    const DecimalReference without = decimal_reference(reflected, 6, 17);
    EXPECT_GT(abs(Digits(Digits(one.columns[6][7]) - Digits(without.columns[6][7]))), 0.01);
}

// The double pendulum of point masses with an armature at the elbow, M = M_0 + d (1 -1; -1 1) in angles from the
// vertical. Lagrange's equations are evaluated on the reference's own motion: accelerations by central differences.
TEST(JointArmature, AtAMovingJointFollowsLagrangesEquations) {
    const FreshCache cache;
    const massless::PointMassPendulum p;
    constexpr double d = 0.75;
    Scene scene = p.scene(1);
    scene.joints[1].armature[0] = d;
    constexpr double step = 1.0 / 4096;
    for (const double at : {0.25, 0.75}) {
        const std::vector<double> times{at - 2 * step, at - step, at, at + step, at + 2 * step};
        const DecimalReference truth = decimal_reference(scene, times, 25);
        ASSERT_TRUE(truth.available) << truth.message;
        double theta[2], rate[2], acceleration[2];
        for (std::size_t b = 0; b < 2; ++b) {
            const auto w = [&](std::size_t k) { return Digits(truth.columns[2 * k + b][5]); };
            rate[b] = static_cast<double>(w(2));
            acceleration[b] = static_cast<double>(Digits((8 * (w(3) - w(1)) - (w(4) - w(0))) / Digits(12 * step)));
            const double qw = std::stod(truth.columns[4 + b][0]), qy = std::stod(truth.columns[4 + b][2]);
            theta[b] = 2 * std::atan2(qy, qw);
        }
        const double s = std::sin(theta[0] - theta[1]), c = std::cos(theta[0] - theta[1]), l = p.m2 * p.l1 * p.l2;
        const double first = ((p.m1 + p.m2) * p.l1 * p.l1 + d) * acceleration[0] + (l * c - d) * acceleration[1] +
                             l * s * rate[1] * rate[1] + (p.m1 + p.m2) * p.g * p.l1 * std::sin(theta[0]);
        const double second = (l * c - d) * acceleration[0] + (p.m2 * p.l2 * p.l2 + d) * acceleration[1] -
                              l * s * rate[0] * rate[0] + p.m2 * p.g * p.l2 * std::sin(theta[1]);
        // h^4 x^(5) / 30 with |x^(5)| below 1e4
        EXPECT_NEAR(first, 0, 1e-9);
        EXPECT_NEAR(second, 0, 1e-9);
    }
}

// Armatures at joints of every type, with a loop, a massless link and a ball joint below a moving base.
Scene mixed_scene(bool with_loop) {
    Scene scene = scene_of("mixed", 1);
    scene.bodies = {body_of("base", 2, {0.5, 0.75, 1}, {0.125, 0, 0.25}), body_of("slide", 0),
                    body_of("cross", 1, {0.25, 0.375, 0.5}, {0, 0.25, -0.25}),
                    body_of("ball", 1.5, {0.25, 0.5, 0.375}, {0.25, 0, -0.5})};
    scene.joints = {joint_of("rail", JointType::prismatic, "base", "slide", {1, 0, 0.5}, {0.5, 0, 0}),
                    joint_of("cardan", JointType::universal, "slide", "cross", {1, 0, 0}, {0, 0.25, 0}),
                    joint_of("socket", JointType::spherical, "cross", "ball", {0, 1, 0}, {0, 0.5, -0.5})};
    scene.joints[1].axes = {Vector3<double>(1, 0, 0), Vector3<double>(0.25, 1, 0)};
    scene.joints[0].armature[0] = 0.75;
    scene.joints[1].armature = {0.25, 0.5};
    scene.joints[2].armature[0] = 0.375;
    scene.joints[0].rate[0] = 1, scene.joints[0].stiffness[0] = 10;
    scene.joints[1].rate = {2, -1}, scene.joints[2].angular_velocity = {1, 2, -0.5};
    scene.bodies[0].initial.angular_velocity = {0.5, 1, -0.25};
    if (with_loop) {
        scene.joints.push_back(joint_of("hinge", JointType::revolute, "world", "base", {0, 1, 0}, {0, 0, 0.5}));
        scene.bodies[0].initial = {};
        scene.bodies.push_back(body_of("bar", 0.5, {0.25, 0.25, 0.125}, {0, 0, 0.25}));
        scene.joints.push_back(joint_of("foot", JointType::spherical, "world", "bar", {0, 1, 0}, {0.5, 0.75, 0}));
        for (Joint& joint : scene.joints) joint.rate = {}, joint.angular_velocity = {};
        Loop loop;
        loop.name = "rod", loop.type = LoopType::distance, loop.first = "bar", loop.second = "ball";
        loop.first_point = {0, 0, 0.5};
        // (0.5, 0.75, 0.5) and (0.5, 0.75, 0) at the start
        loop.length = 0.5;
        scene.loops = {loop};
        scene.joints.back().armature[0] = 0.25;
    }
    scene.loads = {Gravity{{0, 0, -9.75}, {}}};
    return scene;
}

TEST(JointArmature, TwoFormulationsAgreeAndTheEnergyIncludesTheRotors) {
    const FreshCache cache;
    const Scene scene = mixed_scene(false);
    const Reference truth = reference(scene, 2, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    EXPECT_LE(truth.bound, 1e-22);
    for (const ReferenceSystem& at : truth.system)
        EXPECT_LT(
            std::abs((at.energy.high - truth.system[0].energy.high) + (at.energy.low - truth.system[0].energy.low)),
            1e-21);
    ASSERT_FALSE(truth.reactions.empty());
    // methods in joint and in maximal coordinates
    const Problem problem = pose(scene);
    for (const char* name : {"dop853", "taylor", "radau", "ida_index1", "ida_index2", "reduced_semi_implicit_euler",
                             "reduced_implicit_damping"}) {
        const Method& method = *find_method(name);
        ASSERT_EQ(refusal(method, problem), "") << name;
        Settings settings;
        settings.samples = 2;
        if (method.control == Control::fixed_step)
            settings.step = 1e-4;
        else
            settings.tolerance = 1e-10;
        const Trajectory run = solve(problem, method, settings);
        ASSERT_EQ(run.status, Status::ok) << name << run.message;
        const double limit = method.control == Control::fixed_step ? 1e-2 : 1e-7;
        for (std::size_t i = 0; i < run.samples.size(); ++i)
            EXPECT_LT(length(Vector3<double>(run.samples[i].position_W - truth.samples[i].rounded().position_W)), limit)
                << name << " " << i;
    }
    for (const char* name : {"variational_tree", "sequential_impulses_10"})
        if (const Method* method = find_method(name)) {
            EXPECT_NE(refusal(*method, problem).find("armature"), std::string::npos) << name;
        }
}

TEST(JointArmature, ActsInLoopsToo) {
    const FreshCache cache;
    const Scene scene = mixed_scene(true);
    Reference truth;
    try {
        truth = reference(scene, 2, 20);
    } catch (const InputError& error) {
        FAIL() << error.what();
    }
    ASSERT_TRUE(truth.available) << truth.message;
    for (const ReferenceSystem& at : truth.system)
        EXPECT_LT(
            std::abs((at.energy.high - truth.system[0].energy.high) + (at.energy.low - truth.system[0].energy.low)),
            1e-19);
}

TEST(JointArmature, FilesAreReadAndWritten) {
    const std::string text = R"({"name": "a", "duration": 1,
  "bodies": [{"name": "arm", "body": {"mass": 1, "inertia": [0, 0, 0]}}],
  "joints": [{"name": "j", "type": "revolute", "parent": "world", "child": "arm", "axis": [0, 1, 0], "armature": ARM}]})";
    const auto with = [&](const std::string& value) {
        std::string scene = text;
        return scene.replace(scene.find("ARM"), 3, value);
    };
    const Scene scene = parse_scene(with("0.25"), "a.json");
    EXPECT_EQ(scene.joints[0].armature[0], 0.25);
    EXPECT_EQ(parse_scene(write_scene(scene), "a.json").joints[0].armature[0], 0.25);
    try {
        parse_scene(with("-1"), "a.json");
        FAIL() << "accepted";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("/joints/0/armature"), std::string::npos) << error.what();
    }
    // an armature makes the mass matrix of a point mass on its axis regular
    EXPECT_NO_THROW(pose(scene));
    EXPECT_THROW(pose(parse_scene(with("0"), "a.json")), InputError);
}

}  // namespace
}  // namespace polhode
