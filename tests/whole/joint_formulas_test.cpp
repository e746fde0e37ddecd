// Formula loads in mechanisms whose joints have limits, friction or prescribed motions: the reference and methods
// against the same loads given by other keys, and against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "formula/formula_scene.h"
#include "integrators/contact/solve_joints.h"
#include "integrators/series/real.h"
#include "integrators/truth/attempt.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/shared.h"
#include "motion/massless.h"

namespace polhode {
namespace {

using massless::body_of, massless::joint_of, massless::scene_of;
using Exact = Real<50>;

FormulaLoad motor(const std::string& joint, const std::string& formula) {
    FormulaLoad load;
    load.kind = FormulaKind::motor, load.joint = joint, load.formula = formula;
    return load;
}

// Two links between limits, with friction, from the file's text to obtain checked scenes.
Scene two_links() {
    Scene scene = scene_of("two_links", 1.5);
    scene.bodies = {body_of("upper", 2, {0.25, 0.25, 0.0625}, {0, 0, -0.25}),
                    body_of("lower", 1, {0.125, 0.125, 0.03125}, {0.0625, 0, -0.25})};
    scene.joints = {joint_of("shoulder", JointType::revolute, "world", "upper"),
                    joint_of("elbow", JointType::revolute, "upper", "lower", {0, 1, 0}, {0, 0, -0.5})};
    scene.joints[0].coordinate[0] = 0.75, scene.joints[0].friction = 0.5;
    scene.joints[1].limits = {-0.25, 1, 0.5}, scene.joints[1].rate[0] = 2;
    scene.joints[1].friction = 0.125;
    scene.loads = {Gravity{{0, 0, -9.75}, {}}};
    return scene;
}

Scene checked(const Scene& scene) { return parse_scene(write_scene(scene), "scene.json", ""); }

/// The references of two scenes with the same motion agree, events included.
void expect_same_truth(const Scene& a, const Scene& b) {
    const FreshCache cache;
    const truth::Truth one = truth::find_truth(checked(a), 12, 22, 600),
                       other = truth::find_truth(checked(b), 12, 22, 600);
    ASSERT_TRUE(one.reference.available) << one.reference.message;
    ASSERT_TRUE(other.reference.available) << other.reference.message;
    EXPECT_LT(test::difference(one.reference, other.reference, false), 1e-21);
    ASSERT_EQ(one.reference.reactions.size(), other.reference.reactions.size());
    ASSERT_FALSE(one.reference.reactions.empty());
    for (std::size_t i = 0; i < one.reference.reactions.size(); ++i) {
        EXPECT_LT(test::difference(one.reference.reactions[i].force_W, other.reference.reactions[i].force_W), 1e-18);
        EXPECT_LT(test::difference(one.reference.reactions[i].torque_W, other.reference.reactions[i].torque_W), 1e-18);
    }
    ASSERT_EQ(one.contact_events.size(), other.contact_events.size());
    ASSERT_FALSE(one.contact_events.empty());
    for (std::size_t i = 0; i < one.contact_events.size(); ++i) {
        EXPECT_EQ(one.contact_events[i].event, other.contact_events[i].event);
        const Exact difference = Exact(one.contact_events[i].t) - Exact(other.contact_events[i].t);
        EXPECT_LT(abs(difference), 1e-21) << i;
    }
}

void expect_same_methods(const Scene& a, const Scene& b) {
    for (const char* method : {"taylor", "dop853", "radau"}) {
        const Trajectory one = test::solve_with(checked(a), method, 1e-11, 12),
                         other = test::solve_with(checked(b), method, 1e-11, 12);
        ASSERT_EQ(one.status, Status::ok) << method << ": " << one.message;
        ASSERT_EQ(other.status, Status::ok) << method << ": " << other.message;
        for (std::size_t i = 0; i < one.samples.size(); ++i)
            EXPECT_LT(length(one.samples[i].position_W - other.samples[i].position_W), 1e-8) << method << i;
    }
}

TEST(JointFormulas, SpringDamperAndConstantForceAreThoseOfOtherKeys) {
    Scene keys = two_links(), formulas = keys;
    keys.joints[0].stiffness[0] = 4, keys.joints[0].rest[0] = 0.25, keys.joints[0].damping[0] = 0.5;
    keys.loads.emplace_back(Motor{"elbow", 0.75, {}});
    formulas.loads.emplace_back(motor("shoulder", "-4*(shoulder.angle - 0.25) - 0.5*shoulder.rate"));
    formulas.loads.emplace_back(motor("elbow", "0.75"));
    expect_same_truth(keys, formulas);
    expect_same_methods(keys, formulas);
}

// A transcendental function is a variable of the recorded equations.
TEST(JointFormulas, TranscendentalFunctionsAreFollowed) {
    Scene plain = two_links(), formulas = plain;
    plain.loads.emplace_back(motor("elbow", "2*sin(3*t)"));
    formulas.loads.emplace_back(motor("elbow", "2*sin(3*exp(log(t + 1)) - 3)"));
    expect_same_truth(plain, formulas);
    expect_same_methods(plain, formulas);
}

TEST(JointFormulas, SwitchesOfTimeAreEvents) {
    Scene keys = two_links(), formulas = keys;
    keys.loads.emplace_back(Motor{"elbow", 1.5, {0, 0.4375}});
    keys.loads.emplace_back(Motor{"elbow", -2, {0.4375, 10}});
    formulas.loads.emplace_back(motor("elbow", "if(t < 0.4375, 1.5, -2)"));
    expect_same_truth(keys, formulas);
    expect_same_methods(keys, formulas);
}

// clamp() of a servo: the sum of a spring and a damper within bounds.
TEST(JointFormulas, SaturatedServoAgainstBranches) {
    Scene clamped = two_links(), branches = clamped;
    clamped.loads.emplace_back(motor("shoulder", "clamp(-40*(shoulder.angle - 0.5) - 4*shoulder.rate, -6, 6)"));
    branches.let = {{"u", "-40*(shoulder.angle - 0.5) - 4*shoulder.rate"}};
    branches.loads.emplace_back(motor("shoulder", "0.5*abs(u + 6) - 0.5*abs(u - 6)"));
    expect_same_truth(clamped, branches);
    expect_same_methods(clamped, branches);
}

// A force that starts to exceed the friction at a known time: F = a t, the block slips at t = F / a and then moves by
// m x'' = a t - F.
TEST(JointFormulas, BlockSlipsWhereAGrowingForceExceedsFriction) {
    const FreshCache cache;
    Scene scene = scene_of("ramp", 2);
    scene.bodies = {body_of("block", 2, {1, 1, 1})};
    scene.joints = {joint_of("rail", JointType::prismatic, "world", "block", {1, 0, 0})};
    scene.joints[0].friction = 3;
    scene.loads = {motor("rail", "4*t")};
    const DecimalReference truth = decimal_reference(checked(scene), 8, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    // it is held from the start
    ASSERT_EQ(truth.contact_events.size(), 2u);
    EXPECT_EQ(truth.contact_events[0].event, "sticks");
    EXPECT_EQ(truth.contact_events[1].event, "slips");
    EXPECT_LT(abs(Exact(Exact(truth.contact_events[1].t) - Exact(0.75))), 1e-24);
    for (std::size_t k = 0; k < truth.times.size(); ++k) {
        const Exact s = truth.times[k] > 0.75 ? Exact(Exact(truth.times[k]) - Exact(0.75)) : Exact(0);
        EXPECT_LT(abs(Exact(Exact(truth.columns[k][7]) - s * s * s / 3)), 1e-24) << truth.times[k];
        // the drive and friction: 4 t while held by friction, 4 t - 3 then
        const Exact force = Exact(4) * truth.times[k] - (truth.times[k] > 0.75 ? Exact(3) : Exact(4) * truth.times[k]);
        EXPECT_LT(abs(Exact(Exact(truth.reactions[k][0]) - force)), 1e-22) << truth.times[k];
    }
}

// A cart with a prescribed motion, and on it a block with a load given by a formula.
TEST(JointFormulas, ActBesidePrescribedMotions) {
    Scene keys = scene_of("cart", 2);
    keys.bodies = {body_of("cart", 1, {1, 1, 1}), body_of("bob", 0.5, {0.125, 0.125, 0.125}, {0, 0, -0.5})};
    keys.joints = {joint_of("drive", JointType::prismatic, "world", "cart", {1, 0, 0}),
                   joint_of("hinge", JointType::revolute, "cart", "bob")};
    keys.joints[0].motion = "0.25*sin(4*t)", keys.joints[0].rate[0] = 1;
    keys.joints[1].friction = 0.0625, keys.joints[1].limits = {-0.5, 0.25, 0.5};
    keys.loads = {Gravity{{0, 0, -9.75}, {}}};
    Scene formulas = keys;
    keys.joints[1].damping[0] = 0.25;
    formulas.loads.emplace_back(motor("hinge", "-0.25*hinge.rate"));
    expect_same_truth(keys, formulas);
    expect_same_methods(keys, formulas);
}

// A motion by an exponential function, and a joint that friction holds until the load exceeds it: only the holding
// force changes, so that it determines the steps. The block slips where F = m A exp(-t) falls to the spring's force;
// before that, the drive presses it.
TEST(JointFormulas, TheHoldingForceDeterminesStepsWhileNothingElseMoves) {
    const FreshCache cache;
    Scene scene = scene_of("held", 3);
    scene.bodies = {body_of("cart", 1, {1, 1, 1}), body_of("block", 2, {1, 1, 1})};
    scene.joints = {joint_of("drive", JointType::prismatic, "world", "cart", {1, 0, 0}),
                    joint_of("rail", JointType::prismatic, "cart", "block", {1, 0, 0})};
    scene.joints[0].motion = "0.5*exp(-t)", scene.joints[0].coordinate[0] = 0.5, scene.joints[0].rate[0] = -0.5;
    // the relative acceleration -0.5 exp(-t) and the motor's 1 N: |1 - exp(-t)| <= 0.75 holds until t = ln 4
    scene.joints[1].friction = 0.75;
    scene.loads = {Motor{"rail", 1, {}}};
    const DecimalReference truth = decimal_reference(checked(scene), 4, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    ASSERT_GE(truth.contact_events.size(), 1u);
    const DecimalContactEvent& slip = truth.contact_events.back();
    EXPECT_EQ(slip.event, "slips");
    EXPECT_LT(abs(Exact(Exact(slip.t) - log(Exact(4)))), 1e-24);
    for (const char* method : {"taylor", "dop853", "radau"}) {
        Settings settings;
        settings.samples = 1, settings.tolerance = 1e-11;
        const auto run = contact::follow_joints_in_binary64(pose(checked(scene)), settings, find_method(method)->steps);
        ASSERT_FALSE(run.events.empty()) << method << run.fault;
        EXPECT_NEAR(run.events.back().t, std::log(4.0), 1e-9) << method;
    }
}

// The argument of abs() and the rate of the joint vanish at the same time, where friction stops the joint; later the
// joint slips, and abs() takes the side to which it moves.
TEST(JointFormulas, QuadraticDragStopsAndStartsWithFriction) {
    Scene keys = scene_of("drag", 3);
    keys.bodies = {body_of("cart", 1, {1, 1, 1}), body_of("block", 2, {1, 1, 1})};
    keys.joints = {joint_of("slide", JointType::prismatic, "world", "cart", {1, 0, 0}),
                   joint_of("rail", JointType::prismatic, "cart", "block", {1, 0, 0})};
    keys.joints[0].stiffness[0] = 24, keys.joints[0].rate[0] = 2;
    keys.joints[1].friction = 3, keys.joints[1].rate[0] = 0.5;
    Scene branches = keys;
    keys.loads = {motor("rail", "-0.5*rail.speed*abs(rail.speed)")};
    branches.loads = {motor("rail", "if(rail.speed > 0, -0.5, 0.5)*rail.speed^2")};
    expect_same_truth(keys, branches);
    expect_same_methods(keys, branches);
}

// The sign of the rate as a load: with the joint held, it stays at its threshold.
TEST(JointFormulas, SignOfARateStaysZeroWhileTheJointIsHeld) {
    Scene scene = scene_of("sign", 3);
    scene.bodies = {body_of("block", 2, {1, 1, 1})};
    scene.joints = {joint_of("rail", JointType::prismatic, "world", "block", {1, 0, 0})};
    scene.joints[0].friction = 0.25, scene.joints[0].stiffness[0] = 8, scene.joints[0].coordinate[0] = 0.5;
    Scene friction = scene;
    friction.joints[0].friction = 0.5;
    scene.loads = {motor("rail", "-0.25*sign(rail.speed)")};
    const FreshCache cache;
    const DecimalReference truth = decimal_reference(checked(scene), 6, 22),
                           expected = decimal_reference(checked(friction), 6, 22);
    ASSERT_TRUE(expected.available) << expected.message;
    // turning points 0.5, -0.375, 0.25, -0.125; the sum of both is 0.5 N while the block moves, but 0.25 N at rest,
    // which does not hold it at 0.25 m
    ASSERT_TRUE(truth.available) << truth.message;
    for (std::size_t k = 0; k < 4; ++k)
        EXPECT_LT(abs(Exact(Exact(truth.columns[k][7]) - Exact(expected.columns[k][7]))), 1e-21) << k;
}

}  // namespace
}  // namespace polhode
