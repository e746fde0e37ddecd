// Sequential impulses, soft steps and XPBD against the motion in joint coordinates, whose equations are independent.
#include <numbers>

#include "integrators/multibody/multibody_cases.h"

namespace polhode {
namespace {

using namespace multibody_cases;

// a body on a rod of 1 m from the world, rotating about the rod's end: a loop with one equation and no joint
Scene tethered_body() {
    Scene scene;
    scene.name = "tethered", scene.duration = 1;
    NamedBody bob;
    bob.name = "bob";
    bob.body.mass = 2, bob.body.inertia_B = diagonal(Vector3<double>(0.25, 0.375, 0.5));
    bob.initial.position_W = {0.6, 0.25, -0.8};
    bob.initial.angular_velocity = {0.5, 1, 0.25}, bob.initial.velocity_W = {-0.0625, 0, 0.125};  // rod end at rest
    scene.bodies = {bob};
    Loop rod;
    rod.name = "rod", rod.type = LoopType::distance;
    rod.second = "bob", rod.second_point = {0, -0.25, 0}, rod.length = 1;
    scene.loops = {rod};
    scene.loads = {Gravity{{0, 0, -9.81}, {}}};
    return scene;
}

// a sphere hanging at rest on a spherical joint
Scene hanging_ball() {
    Scene scene;
    scene.name = "hanging", scene.duration = 1;
    NamedBody ball;
    ball.name = "ball";
    ball.body.mass = 3, ball.body.inertia_B = diagonal(Vector3<double>(0.5, 0.5, 0.5));
    scene.bodies = {ball};
    Joint joint;
    joint.name = "joint", joint.type = JointType::spherical, joint.child = "ball", joint.child_point = {0, 0, 1};
    scene.joints = {joint};
    scene.loads = {Gravity{{0, 0, -9.81}, {}}};
    return scene;
}

const std::vector<std::string> impulses{"sequential_impulses_10", "sequential_impulses_split_10",
                                        "sequential_impulses_cold_10", "sequential_impulses_block_10"};

// Measured orders with h = 2e-3 and 1e-3 s over 1 s: spherical joints with springs 0.95 to 1.05, a prismatic joint
// 0.90 to 1.03, motors on a free base 0.99 to 1.05, a fixed joint 0.91 to 1.02.
TEST(MaximalMethods, HaveOrderOne) {
    for (const char* name : {"ball_joint_arm", "cart_pole_tilted", "free_flying_robot", "welded_pendulum"}) {
        const Case it(mechanism(name, 1));
        for (const std::string& method : impulses) {
            if (method == "sequential_impulses_10" && it.problem.scene.name == "mechanisms/welded_pendulum") continue;
            EXPECT_NEAR(it.order(method, 2e-3), 1, 0.15) << method << " on " << name;
        }
        EXPECT_NEAR(it.order("xpbd_joints_10", 2e-3), 1, 0.15) << name;
    }
}

// A Cardan shaft: a universal joint and a revolute loop with mostly redundant equations. Measured orders: 0.94 and
// 1.00. Impulses with Baumgarte's term have 2.0 and more, because the axes of the shafts are fixed.
TEST(MaximalMethods, ConvergeOnAUniversalJointAndALoop) {
    const Case it(mechanism("cardan_shaft", 1));
    for (const char* method : {"sequential_impulses_split_10", "xpbd_joints_10"})
        EXPECT_NEAR(it.order(method, 2e-3), 1, 0.1) << method;
    for (const char* method : {"sequential_impulses_10", "sequential_impulses_cold_10", "sequential_impulses_block_10"})
        EXPECT_GT(it.order(method, 2e-3), 1.5) << method;
    EXPECT_LT(it.off("soft_step_4", 2e-3).attitude, 1e-3);
}

TEST(MaximalMethods, HoldADistance) {
    const Case it(tethered_body());
    for (const std::string& method : impulses) EXPECT_NEAR(it.order(method, 2e-3), 1, 0.2) << method;
    EXPECT_NEAR(it.order("xpbd_joints_10", 2e-3), 1, 0.2);
    EXPECT_LT(it.off("soft_step_4", 1e-3).attitude, 2e-2);
}

// Each impulse acts equally on two bodies, so only rounding remains: 1000 steps at a momentum of 17 kg m/s. Rounding
// of positions is 2^-53 |x| m / h = 2e-10 at each of 10^4 substeps and accumulates randomly: measured 1.9e-8. The
// angular momentum is not conserved, because the arms of a joint's two points differ by its gap.
TEST(MaximalMethods, KeepLinearMomentum) {
    const Case it(mechanism("free_flying_robot", 1));
    const auto change = [&](const std::string& method) {
        const Trajectory run = it.run(method, 1e-3);
        return length(it.invariants(run.at(10)).linear_momentum_W - it.invariants(run.at(0)).linear_momentum_W);
    };
    for (const std::string& method : impulses) EXPECT_LT(change(method), 1e-11) << method;  // measured 2e-13
    EXPECT_LT(change("soft_step_4"), 1e-11);
    EXPECT_LT(change("xpbd_joints_10"), 5e-7);
    const auto turning = [&](double step) {
        const Trajectory run = it.run("sequential_impulses_10", step);
        return length(it.invariants(run.at(10)).angular_momentum_W - it.invariants(run.at(0)).angular_momentum_W);
    };
    EXPECT_NEAR(turning(4e-3) / turning(2e-3), 2, 0.4);
}

// In equilibrium no impulse changes in a substep: lambda = m h g and s b C = (1 - s) h g, hence C = g / w_n^2 for any
// step. The gap approaches this value at the rate h w_n^2, where h is the substep.
TEST(MaximalMethods, SoftJointsOpenByTheLoadOverTheirFrequencySquared) {
    const Case it(hanging_ball());
    const double w_n = 2 * std::numbers::pi * 60, gap = 9.81 / (w_n * w_n);
    for (const double step : {8e-3, 4e-3, 2e-3})
        for (const char* method : {"soft_step_4", "soft_step_16"}) {
            const Trajectory run = it.run(method, step);
            EXPECT_NEAR(-run.at(10)[0].position_W[2] - 1, gap, 1e-5 * gap) << method << " " << step;
        }
    // rigid joints do not open
    EXPECT_LT(it.off("sequential_impulses_10", 4e-3).gap, 1e-15);
}

// Before this equilibrium is reached the order is 1. Measured 0.68, 0.94, 0.90 from h = 3.3e-4 s on over 0.02 s.
TEST(MaximalMethods, SoftStepsConvergeOverShortTimes) {
    const Case it(mechanism("double_pendulum", 0.02));
    EXPECT_NEAR(it.order("soft_step_4", 2e-4), 1, 0.2);
}

// Gaps of the double pendulum over 2 s at h = 0.01 s: 3.4e-2, 3.6e-4, 8.7e-5 m with 1, 10, 20 substeps; 2.0e-2 m with
// 10 and with 50 iterations. Ten iterations solve two joints, so the rest is the error of the step.
TEST(MaximalMethods, SubstepsCloseJointsBetterThanIterations) {
    const Case it(mechanism("double_pendulum", 2));
    const double one = it.off("xpbd_joints_1", 0.01).gap, ten = it.off("xpbd_joints_10", 0.01).gap,
                 twenty = it.off("xpbd_joints_20", 0.01).gap, iterations = it.off("sequential_impulses_50", 0.01).gap;
    EXPECT_LT(ten, one / 20);
    EXPECT_LT(twenty, ten / 3);
    EXPECT_LT(twenty, iterations / 50);
    // the attitude is closer as well with twenty substeps, 20 rounds in total: 0.39 against 0.63 rad
    EXPECT_LT(it.off("xpbd_joints_20", 0.01).attitude, it.off("sequential_impulses_50", 0.01).attitude);
}

// A rope whose ball has 1000 times the mass of a link, over 1 s at h = 1e-3 s. Measured gaps: 1.7e-2 and 7.2e-3 m
// with 4 and 10 iterations, less with 50.
TEST(MaximalMethods, MoreIterationsStretchARopeLess) {
    const Case it(mechanism("rope_mass_ratio", 1));
    const double four = it.off("sequential_impulses_4", 1e-3).gap, ten = it.off("sequential_impulses_10", 1e-3).gap,
                 fifty = it.off("sequential_impulses_50", 1e-3).gap;
    EXPECT_LT(ten, four / 1.5);
    EXPECT_LT(fifty, ten / 1.5);
}

// The chain of ten links after an impulse, h = 3.8e-3 s: axis errors of 1.4e-3 rad warm and 9.6e-3 rad cold; attitude
// errors of 0.018 and 0.094 rad.
TEST(MaximalMethods, WarmStartingHelpsWhereItIsStable) {
    const Case it(mechanism("chain_10", 1), 20);
    const Off warm = it.off("sequential_impulses_10", 4e-3), cold = it.off("sequential_impulses_cold_10", 4e-3);
    EXPECT_LT(warm.turn, cold.turn / 3);
    EXPECT_LT(warm.attitude, cold.attitude / 3);
    EXPECT_LT(warm.gap, cold.gap / 1.5);
}

// A single fixed joint is unstable. If n iterations reduce an error of the impulses by G, then with r = J v and c = C/h
//   lambda' = -(1 - G) A^-1 (r + beta c) + G lambda,  r' = r + A lambda',  c' = c + r'
// The spectral radius at this start is 1.051 for n = 10 (that of G is 0.963); 0.981 cold, 0.981 with split impulses,
// and still 1.018 for n = 50 on the hinges of the double pendulum. Measured energy errors at h = 2e-3 s over 1 s: 1300
// times the motion's energy row by row, 4e-3 by blocks or cold.
TEST(MaximalMethods, WarmStartingRowByRowBlowsUpOnAWeldAndByBlocksDoesNot) {
    const Case it(mechanism("welded_pendulum", 1));
    const Trajectory run = it.run("sequential_impulses_10", 2e-3);
    EXPECT_TRUE(run.status == Status::diverged || it.off(run).energy > 10);
    EXPECT_LT(it.off("sequential_impulses_block_10", 2e-3).energy, 1e-2);
    EXPECT_LT(it.off("sequential_impulses_cold_10", 2e-3).energy, 1e-2);
}

// Without the gyroscopic term the limit is another motion: 9.8e-3 rad off after 1 s at any step.
TEST(MaximalMethods, WithoutTheGyroscopicTermTheLimitIsAnotherMotion) {
    const Case it(mechanism("free_flying_robot", 1));
    EXPECT_GT(it.off("sequential_impulses_no_gyroscopic_10", 5e-4).attitude, 5e-3);
    EXPECT_LT(it.off("sequential_impulses_10", 5e-4).attitude, 1e-3);
}

// At coarse steps both arithmetics have the same errors. XPBD divides the rounding by the step.
TEST(MaximalMethods, InBinary32ErrAsInBinary64AtCoarseSteps) {
    const Case it(mechanism("double_pendulum", 1));
    for (const char* method :
         {"sequential_impulses_4", "sequential_impulses_10", "sequential_impulses_50", "sequential_impulses_split_10",
          "sequential_impulses_cold_10", "sequential_impulses_block_10", "soft_step_4", "soft_step_16"}) {
        const double wide = it.off(method, 4e-3).attitude;
        EXPECT_NEAR(it.off(std::string(method) + "_float32", 4e-3).attitude, wide, 0.02 * wide) << method;
    }
    const double wide = it.off("xpbd_joints_1", 4e-3).attitude;
    EXPECT_NEAR(it.off("xpbd_joints_1_float32", 4e-3).attitude, wide, 0.05 * wide);
}

// An impulse inside a step splits it. A second run takes the same steps: no impulses remain from the first run.
TEST(MaximalMethods, RestartAtEvents) {
    Scene scene = mechanism("double_pendulum", 0.5);
    scene.loads.push_back(Impulse{{0.5, 0, 0}, Frame::world, {0, 0, -0.25}, Frame::body, 0.1234, "lower"});
    scene.loads.push_back(Motor{"elbow", 2, {0.2111, 0.4}});
    const Case it(scene);
    for (const char* method : {"sequential_impulses_10", "sequential_impulses_split_10", "soft_step_4",
                               "xpbd_joints_10", "reduced_semi_implicit_euler", "variational_tree"}) {
        EXPECT_LT(it.off(method, 1e-3).attitude, 0.03) << method;
        Settings settings;
        settings.step = 1e-3, settings.samples = 10;
        const Trajectory once = solve(it.problem, *find_method(method), settings);
        settings.repetitions = 2;
        const Trajectory twice = solve(it.problem, *find_method(method), settings);
        EXPECT_EQ(once.samples.back().q, twice.samples.back().q) << method;
    }
}

// Friction and limits as bounded impulses, against the motion followed from event to event. Order 1: dry friction, a
// limit with restitution 1/2 and impacts that accumulate, sticking at the end.
TEST(MaximalMethods, FrictionAndLimitsHaveOrderOne) {
    for (const char* name : {"joints/coulomb_oscillator", "joints/bouncing_slider", "joints/coulomb_pendulum"}) {
        const Problem problem = pose(find_scene(name));
        std::vector<std::string> methods = impulses;
        // does not support restitution
        if (problem.scene.joints[0].limits.restitution == 0) methods.push_back("soft_step_4");
        for (const std::string& method : methods)
            EXPECT_NEAR(position_order(problem, method, 1000, 0.02), 1, 0.25) << method << " on " << name;
        // measured 1.00, 1.00, 1.01; at longer steps static friction still pulls the pendulum's point off
        EXPECT_NEAR(position_order(problem, "xpbd_joints_10", 4000, 0.005), 1, 0.1) << name;
    }
}
// An arm of six axes, without the armature that these methods do not support: joints hit their limits and stick. An
// inelastic impact at a limit acts on all joints. Measured orders 0.93 and 1.07; the iteration of sequential impulses
// does not converge in 50 passes.
TEST(MaximalMethods, PositionCorrectionsStopAnArmAtItsLimits) {
    Scene scene = find_scene("joints/arm6_limits_friction");
    for (Joint& joint : scene.joints) joint.armature = {};
    const Problem problem = pose(scene);
    EXPECT_NEAR(position_order(problem, "xpbd_joints_1", 2000, 5e-3), 1, 0.2);
    EXPECT_NEAR(position_order(problem, "xpbd_joints_10", 1000, 1e-3), 1, 0.2);
}
// Impacts at times between the steps: the error decreases with the step, without a smooth order.
TEST(MaximalMethods, BounceBetweenStops) {
    const Problem problem = pose(find_scene("joints/pendulum_with_stops"));
    std::vector<std::string> methods = impulses;
    methods.push_back("xpbd_joints_10");
    for (const std::string& method : methods) {
        EXPECT_LT(position_error(problem, method, problem.scene.duration / 8000), 2e-3) << method;
        const Trajectory run = stepped(problem, method, problem.scene.duration / 2000, 2000);
        for (const Sample& sample : run.samples) {
            const double angle = 2 * std::atan2(sample.q.y, sample.q.w);
            EXPECT_LT(angle, 0.5 + 0.02);
            EXPECT_GT(angle, -0.25 - 0.02);
        }
    }
}
TEST(MaximalMethods, RefuseFrictionAndLimitsIfTheyHaveNone) {
    const Problem problem = pose(find_scene("joints/pendulum_with_stops"));
    for (const char* method : {"variational_tree", "reduced_semi_implicit_euler", "reduced_implicit_damping"})
        EXPECT_NE(refusal(*find_method(method), problem).find("does not support friction and limits"),
                  std::string::npos)
            << method;
    for (const char* method : {"sequential_impulses_10_float32", "xpbd_joints_1", "xpbd_joints_10_float32"})
        EXPECT_EQ(refusal(*find_method(method), problem), "") << method;
    EXPECT_NE(refusal(*find_method("soft_step_4"), problem).find("\"hinge\" have a restitution"), std::string::npos);
}
// Limits without restitution: the joint stops there, within the opening of soft joints.
TEST(MaximalMethods, StopAtLimits) {
    Scene scene = find_scene("joints/pendulum_with_stops");
    scene.joints[0].limits.restitution = 0;
    const Problem problem = pose(scene);
    for (const char* method :
         {"sequential_impulses_10", "soft_step_4", "soft_step_16", "soft_step_4_float32", "xpbd_joints_1"})
        EXPECT_LT(position_error(problem, method, scene.duration / 8000), 1e-3) << method;
}

// A swing without gravity between stops: an inelastic stop leaves no motion, an elastic one keeps the rate of 4 rad/s
// to the order of the step. Measured: 0.19, 0.040 and 0.013 rad/s lost. A second run has the same bits.
TEST(MaximalMethods, PositionCorrectionsKeepTheRateOfImpacts) {
    Scene scene = find_scene("joints/pendulum_with_stops");
    scene.loads.clear();
    for (const double restitution : {0.0, 1.0})
        for (const double step : {1e-2, 3e-3, 1e-3}) {
            scene.joints[0].limits.restitution = restitution;
            const Problem problem = pose(scene);
            Settings settings;
            settings.step = step, settings.samples = 10;
            const Trajectory run = solve(problem, *find_method("xpbd_joints_1"), settings);
            ASSERT_EQ(run.status, Status::ok) << run.message;
            const double rate = length(run.samples.back().angular_velocity_B);
            EXPECT_NEAR(rate, 4 * restitution, restitution == 0 ? 1e-9 : 25 * step) << step;
            settings.repetitions = 2;
            EXPECT_EQ(solve(problem, *find_method("xpbd_joints_1"), settings).samples.back().q, run.samples.back().q);
        }
}

TEST(MaximalMethods, RefuseWhatIsNoMechanism) {
    const Problem alone = pose(find_scene("symmetric"));
    for (const char* method : {"sequential_impulses_10", "soft_step_4_float32", "xpbd_joints_10", "variational_tree",
                               "reduced_semi_implicit_euler"})
        EXPECT_NE(refusal(*find_method(method), alone), "") << method;
    Scene heavy = hanging_ball();
    heavy.bodies[0].body.mass = 1e39;
    // inertia in proportion to this mass; moments for 1 kg would be refused beside it
    for (Vector3<double>& row : heavy.bodies[0].body.inertia_B.row) row = 1e39 * row;
    EXPECT_NE(refusal(*find_method("soft_step_4_float32"), pose(heavy)), "");
    EXPECT_EQ(refusal(*find_method("soft_step_4"), pose(heavy)), "");
    EXPECT_NE(refusal(*find_method("variational_tree"), pose(mechanism("cardan_shaft", 1))), "");
}

}  // namespace
}  // namespace polhode
