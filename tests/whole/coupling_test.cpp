// Couplings of joint coordinates against equivalent mechanisms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "catalogue.h"
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
using Long = Real<50>;

// A pendulum and a flywheel on parallel fixed axes, geared 1 : -3, move as the pendulum with an armature of 9 times the
// flywheel's moment.
TEST(Coupling, GearedRotorEqualsAnArmatureTo28Digits) {
    const FreshCache cache;
    constexpr double J = 0.125, ratio = -3;
    Scene geared = scene_of("geared", 3);
    geared.bodies = {body_of("arm", 1.5, {0.25, 0.5, 0.375}, {0.25, 0, -0.5}), body_of("rotor", 0.5, {J, J, J})};
    geared.joints = {joint_of("hinge", JointType::revolute, "world", "arm", {0, 1, 0}),
                     joint_of("shaft", JointType::revolute, "world", "rotor", {0, 1, 0}, {1, 0, 0})};
    geared.joints[0].coordinate[0] = 1.25, geared.joints[0].rate[0] = 2;
    geared.joints[1].coordinate[0] = ratio * 1.25 + 0.5, geared.joints[1].rate[0] = ratio * 2;
    geared.couplings = {{"hinge", "shaft", ratio, 0.5}};
    geared.loads = {Gravity{{0, 0, -9.75}, {}}};
    Scene reflected = geared;
    reflected.bodies.pop_back(), reflected.joints.pop_back(), reflected.couplings.clear();
    reflected.joints[0].armature[0] = ratio * ratio * J;
    const DecimalReference one = decimal_reference(geared, 4, 28), other = decimal_reference(reflected, 4, 28);
    ASSERT_TRUE(one.available) << one.message;
    ASSERT_TRUE(other.available) << other.message;
    for (std::size_t k = 0; k <= 4; ++k)
        for (std::size_t c = 0; c < 13; ++c)
            EXPECT_LT(abs(Long(Long(one.columns[2 * k][c]) - Long(other.columns[k][c]))), 1e-26) << k << " " << c;
    // the gear's torque J ratio^2 x'' is part of both reactions
    const Long torque = Long(one.reactions[1][4]);
    EXPECT_GT(abs(torque), 0.01);
    const Problem problem = pose(geared);
    for (const char* name : {"dop853", "taylor", "radau", "ida_index1", "ida_index2", "reduced_semi_implicit_euler"}) {
        const Method& method = *find_method(name);
        ASSERT_EQ(refusal(method, problem), "") << name;
        Settings settings;
        settings.samples = 1;
        if (method.control == Control::fixed_step)
            settings.step = 1e-4;
        else
            settings.tolerance = 1e-11;
        const Trajectory run = solve(problem, method, settings);
        ASSERT_EQ(run.status, Status::ok) << name << run.message;
        EXPECT_NEAR(run.samples[run.samples.size() - 2].position_W[0], std::stod(one.columns[8][7]),
                    method.control == Control::fixed_step ? 1e-2 : 1e-8)
            << name;
    }
    for (const char* name : {"variational_tree", "sequential_impulses_10"})
        if (const Method* method = find_method(name)) {
            EXPECT_NE(refusal(*method, problem), "") << name;
        }
}

// A rack and a pinion on a moving carriage, gear in series with a free base: joints of one chain share bodies.
TEST(Coupling, ChainOnAFreeBaseKeepsEnergyAndMomenta) {
    const FreshCache cache;
    Scene scene = scene_of("chain", 1);
    scene.bodies = {body_of("base", 2, {0.5, 0.75, 1}, {0.125, 0, 0.25}),
                    body_of("first", 1, {0.25, 0.375, 0.5}, {0, 0.25, -0.25}),
                    body_of("second", 1.5, {0.25, 0.5, 0.375}, {0.25, 0, -0.5}),
                    body_of("rack", 0.5, {0.25, 0.25, 0.25}, {0, 0.25, 0})};
    scene.joints = {joint_of("a", JointType::revolute, "base", "first", {1, 0, 0.5}, {0.5, 0, 0}),
                    joint_of("b", JointType::revolute, "first", "second", {0, 1, 0}, {0, 0.25, 0}),
                    joint_of("c", JointType::prismatic, "second", "rack", {0, 0.5, 1}, {0, 0.5, -0.5})};
    scene.joints[0].rate[0] = 2, scene.joints[1].rate[0] = -1, scene.joints[2].rate[0] = -0.25;
    scene.couplings = {{"a", "b", -0.5, 0}, {"b", "c", 0.25, 0}};
    scene.bodies[0].initial.angular_velocity = {0.5, 1, -0.25};
    const Reference truth = reference(scene, 2, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    for (const ReferenceSystem& at : truth.system) {
        EXPECT_NEAR(at.energy.high, truth.system[0].energy.high, 1e-14 * truth.system[0].energy.high);
        for (int i = 0; i < 3; ++i) {
            EXPECT_NEAR(at.angular_momentum_W[i].high, truth.system[0].angular_momentum_W[i].high, 1e-13);
            EXPECT_NEAR(at.linear_momentum_W[i].high, truth.system[0].linear_momentum_W[i].high, 1e-13);
        }
    }
}

// IDA has couplings as rows of constraints of the bodies.
TEST(Coupling, ErrorsOfIdaFallWithTheTolerance) {
    const FreshCache cache;
    for (const char* name : {"joints/geared_double_pendulum", "joints/cardan_gear", "joints/arm_with_gripper"}) {
        Problem problem = pose(find_scene(name));
        problem.reactions = true;
        const Reference truth = reference(problem.scene, 4, 17);
        ASSERT_TRUE(truth.available) << truth.message;
        for (const char* method : {"ida_index1", "ida_index2"}) {
            double former = 1;
            for (const double tolerance : {1e-6, 1e-9}) {
                Settings settings;
                settings.samples = 4, settings.tolerance = tolerance;
                const Trajectory run = solve(problem, *find_method(method), settings);
                ASSERT_EQ(run.status, Status::ok) << name << " " << method << ": " << run.message;
                double position = 0, torque = 0, largest = 1;
                for (std::size_t i = 0; i < run.samples.size(); ++i)
                    position = std::max(position, length(Vector3<double>(run.samples[i].position_W -
                                                                         truth.samples[i].rounded().position_W)));
                ASSERT_EQ(run.reactions.size(), truth.reactions.size());
                for (std::size_t i = 0; i < run.reactions.size(); ++i)
                    for (std::size_t k = 0; k < 3; ++k) {
                        const double expected = truth.reactions[i].torque_W[k].high;
                        largest = std::max(largest, std::abs(expected));
                        torque = std::max(torque, std::abs(run.reactions[i].torque_W[k] - expected));
                    }
                const double error = std::max(position, torque / largest);
                EXPECT_LT(error, 5000 * tolerance) << name << " " << method;
                EXPECT_LT(error, former / 30) << name << " " << method;
                former = error;
            }
        }
    }
}

TEST(Coupling, FilesAreCheckedAndWritten) {
    const std::string text = R"({"name": "a", "duration": 1,
  "bodies": [{"name": "x", "body": {"mass": 1, "inertia": [1, 1, 1]}}, {"name": "y", "body": {"mass": 1, "inertia": [1, 1, 1]}}],
  "joints": [{"name": "i", "type": "revolute", "parent": "world", "child": "x", "axis": [0, 1, 0], "initial": {"angle": 0.5}},
             {"name": "j", "type": "prismatic", "parent": "x", "child": "y", "axis": [0, 1, 0], "initial": {START}}],
  "couplings": [LAW]})";
    const auto with = [&](const std::string& law, const std::string& start = "\"displacement\": 1.25") {
        std::string scene = text;
        scene.replace(scene.find("START"), 5, start);
        return scene.replace(scene.find("LAW"), 3, law);
    };
    const std::string gear = R"({"first": "i", "second": "j", "ratio": 2, "offset": 0.25})";
    const Scene scene = parse_scene(with(gear), "a.json");
    EXPECT_EQ(scene.couplings[0].ratio, 2);
    EXPECT_EQ(write_scene(parse_scene(write_scene(scene), "a.json")), write_scene(scene));
    EXPECT_NO_THROW(pose(scene));
    EXPECT_NO_THROW(pose(parse_scene(with(gear, "\"displacement\": 0, \"dependent\": true"), "a.json")));
    for (const auto& [law, place] : {std::pair{R"({"first": "i", "second": "k"})", "/couplings/0/second"},
                                     {R"({"first": "i", "second": "i"})", "/couplings/0/second"},
                                     {R"({"first": "i", "second": "j", "ratio": 0})", "/couplings/0/ratio"},
                                     {R"({"first": "i", "second": "j", "ratio": 1})", "/couplings/0"}})
        try {
            pose(parse_scene(with(law), "a.json"));
            FAIL() << law;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(place), std::string::npos) << error.what();
        }
}

}  // namespace
}  // namespace polhode
