// Comparison of two runs of a truth, made by hand: disagreement, bounds, written decimals and invariants.
#include "integrators/truth/compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "integrators/truth/cache.h"

namespace polhode::truth {
namespace {

using Fifty = Real<50>;
using RunOfOne = Run<Fifty>;
using RunOfTwo = Run<Fifty, Motions<Fifty>>;

// Two free bodies: one spins about its z axis in flight, the other is pulled by the spring of its joint.
Scene two_bodies() {
    Scene scene;
    scene.name = "two", scene.duration = 1;
    scene.bodies.resize(2);
    scene.bodies[0].name = "a", scene.bodies[0].body.mass = 2;
    scene.bodies[0].body.inertia_B = diagonal(Vector3<double>(1, 2, 3));
    scene.bodies[1].name = "b", scene.bodies[1].body.mass = 4;
    scene.joints.resize(1);
    scene.joints[0].name = "slide", scene.joints[0].type = JointType::prismatic;
    scene.joints[0].parent = "a", scene.joints[0].child = "b", scene.joints[0].axes[0] = {0, 0, 1};
    scene.joints[0].child_point = {0, 0.5, 0};
    scene.joints[0].stiffness[0] = 8;
    return scene;
}

const std::vector<double> three_times{0, 0.5, 1};

Motion<Fifty> spinning_body(const Fifty& t) {
    Motion<Fifty> m;
    m.q = {cos(Fifty(t)), Fifty(0), Fifty(0), sin(Fifty(t))};  // at 2 rad/s
    m.angular_velocity_B = {Fifty(0), Fifty(0), Fifty(2)};
    m.velocity_W = {Fifty(1), Fifty(0), Fifty(1) / Fifty(3)};
    m.position_W = t * m.velocity_W;
    return m;
}

RunOfTwo run_of_two() {
    RunOfTwo run;
    run.steps = 3;
    for (const double t : three_times) {
        Motion<Fifty> b = spinning_body(Fifty(t));
        b.position_W = b.position_W + Vector3<Fifty>(Fifty(0), Fifty(0), Fifty(1) / Fifty(7));
        run.motions.push_back({spinning_body(Fifty(t)), b});
    }
    return run;
}

Problem problem_of_two() {
    Problem problem;
    problem.scene = two_bodies();
    return problem;
}

double off_by(const Pair& pair, double expected) { return (pair.high - expected) + pair.low; }

TEST(TruthOfSeveralBodies, IsWrittenTimeByTimeWithWhatTheBodiesHaveTogether) {
    const Attempt attempt = compare_runs(problem_of_two(), three_times, run_of_two(), run_of_two(), "by hand", 50);
    EXPECT_EQ(attempt.fault, "");
    EXPECT_EQ(attempt.agreed_digits, 50);
    const Reference& truth = attempt.truth.reference;
    EXPECT_EQ(truth.bodies, 2);
    EXPECT_EQ(truth.moments(), 3u);
    ASSERT_EQ(truth.samples.size(), 6u);
    ASSERT_EQ(attempt.truth.decimals.size(), 6u);
    ASSERT_EQ(truth.system.size(), 3u);
    EXPECT_TRUE(truth.reactions.empty());
    EXPECT_EQ(attempt.truth.steps, 6);
    for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(truth.samples[k].t, three_times[k / 2]);
    EXPECT_EQ(attempt.truth.decimals[3][9].substr(0, 30), "3.0952380952380952380952380952");  // 1/6 + 1/7
    // the spring's stretch is 1/7 m along z
    const Fifty third = Fifty(1) / Fifty(3),
                kinetic = (Fifty(3) * 4 + Fifty(1) * 4 + Fifty(6) * (1 + third * third)) / 2;
    const Fifty energy = kinetic + Fifty(4) / Fifty(49);
    for (const ReferenceSystem& system : truth.system) {
        EXPECT_LT(std::abs(off_by(system.kinetic, 0) - kinetic.convert_to<double>()), 1e-15);
        EXPECT_LT(abs(Fifty(system.kinetic.high) + Fifty(system.kinetic.low) - kinetic).convert_to<double>(), 1e-30);
        EXPECT_LT(abs(Fifty(system.energy.high) + Fifty(system.energy.low) - energy).convert_to<double>(), 1e-30);
        // about the common centre of mass; one body is above the other
        EXPECT_LT(std::abs(off_by(system.angular_momentum_W[2], 8)), 1e-30);
        EXPECT_LT(std::abs(off_by(system.angular_momentum_W[0], 0)), 1e-30);
        EXPECT_EQ(system.linear_momentum_W[0].high, 6);
    }
}

TEST(TruthOfSeveralBodies, DiffersByTheWorstBody) {
    RunOfTwo other = run_of_two();
    // relative to the largest length over all bodies: position at the end
    other.motions[1][1].position_W[1] += Fifty(1e-20);
    const double longest = std::sqrt(1 + std::pow(1.0 / 3 + 1.0 / 7, 2));
    EXPECT_NEAR(disagreement(run_of_two(), other), 1e-20 / longest, 1e-26);
    other.motions[2][0].q.x += Fifty(1e-17);
    const Attempt attempt = compare_runs(problem_of_two(), three_times, run_of_two(), other, "by hand", 50);
    EXPECT_NEAR(attempt.truth.reference.bound, 2e-17, 1e-22);
    EXPECT_NEAR(attempt.agreed_digits, 17 - std::log10(2), 1e-4);
    other.fault = "lost";
    EXPECT_EQ(compare_runs(problem_of_two(), three_times, run_of_two(), other, "by hand", 50).fault, "lost");
}

TEST(TruthOfSeveralBodies, ReactionsAreComparedAndWritten) {
    MechanismOutputs<Fifty> first;
    for (int k = 0; k < 3; ++k)
        first.reactions.push_back({{{Fifty(k), Fifty(0), Fifty(2) / Fifty(3)}, {Fifty(0), Fifty(0.25), Fifty(0)}}});
    MechanismOutputs<Fifty> second = first;
    Attempt attempt =
        compare_runs(problem_of_two(), three_times, run_of_two(), run_of_two(), "by hand", 50, first, second);
    EXPECT_EQ(attempt.agreed_digits, 50);
    ASSERT_EQ(attempt.truth.reference.reactions.size(), 3u);
    EXPECT_EQ(attempt.truth.reference.reactions[2].force_W[0].high, 2);
    EXPECT_LT(std::abs(off_by(attempt.truth.reference.reactions[0].force_W[2], 2.0 / 3) - 3.70074341541719e-17), 1e-31);
    EXPECT_EQ(attempt.truth.reaction_decimals[1][2].substr(0, 27), "6.6666666666666666666666666");
    EXPECT_EQ(attempt.truth.reaction_decimals[1][4].substr(0, 4), "2.50");
    // the largest force is |(2, 0, 2/3)|; torques are scaled by this force times 0.5 m, the arm to the child's centre
    const double force = std::sqrt(4 + 4.0 / 9);
    second.reactions[0][0].torque_W[0] += Fifty(1e-13);
    attempt = compare_runs(problem_of_two(), three_times, run_of_two(), run_of_two(), "by hand", 50, first, second);
    EXPECT_NEAR(attempt.truth.reference.bound, 1e-13 / (force / 2), 1e-19);
    second.reactions[1][0].force_W[1] += Fifty(4e-13);
    attempt = compare_runs(problem_of_two(), three_times, run_of_two(), run_of_two(), "by hand", 50, first, second);
    EXPECT_NEAR(attempt.truth.reference.bound, 4e-13 / force, 1e-19);
    // undetermined components of redundant constraints do not count and are not printed
    second.reactions[2][0].torque_W[2] = 0.5;
    attempt = compare_runs(problem_of_two(), three_times, run_of_two(), run_of_two(), "by hand", 50, first, second);
    EXPECT_NEAR(attempt.truth.reference.bound, 4e-13 / force, 1e-19);
    EXPECT_TRUE(std::isnan(attempt.truth.reference.reactions[2].torque_W[2].high));
    EXPECT_EQ(attempt.truth.reference.reactions[2].torque_W[1].high, 0.25);
    EXPECT_EQ(attempt.truth.reaction_decimals[2][5], "nan");
    const std::optional<Truth> back = decode("key", encode("key", attempt.truth));
    ASSERT_TRUE(back);
    EXPECT_EQ(back->reaction_decimals, attempt.truth.reaction_decimals);
    EXPECT_TRUE(std::isnan(back->reference.reactions[2].torque_W[2].high));
}

TEST(TruthOfSeveralBodies, RoundOffOfWhatDoesNotMoveIsNoDisagreement) {
    RunOfTwo one = run_of_two();
    for (Motions<Fifty>& all : one.motions)
        for (Motion<Fifty>& m : all) m.position_W = m.velocity_W = {};
    RunOfTwo other = one;
    other.motions[1][0].position_W[2] = other.motions[2][1].velocity_W[0] = 1e-48;
    EXPECT_EQ(disagreement(other, one), 1);
    // relative to the largest radius of gyration, sqrt(6 / 2 / 2) m, and to this length per second
    EXPECT_NEAR(disagreement(other, one, natural_sizes<Fifty>(two_bodies())), 1e-48 / std::sqrt(1.5), 1e-54);
}

// ---- one body

RunOfOne run_of_one() {
    RunOfOne run;
    for (const double t : three_times) run.motions.push_back(spinning_body(Fifty(t)));
    // each block is largest at the middle sample
    run.motions[1].position_W = {Fifty(8), Fifty(0), Fifty(0)},
    run.motions[1].velocity_W = {Fifty(0), Fifty(4), Fifty(0)};
    run.motions[1].angular_velocity_B = {Fifty(0), Fifty(0), Fifty(16)};
    return run;
}

TEST(TruthOfOneBody, DiffersByItsWorstBlockOverTheBlocksLargestLength) {
    const auto differs = [](const auto& change) {
        RunOfOne other = run_of_one();
        change(other);
        return disagreement(run_of_one(), other);
    };
    // at the first sample: neither the difference nor the scale comes from the last one
    EXPECT_NEAR(differs([](auto& run) { run.motions[0].position_W[1] += Fifty(1e-20); }), 1e-20 / 8, 1e-30);
    EXPECT_NEAR(differs([](auto& run) { run.motions[0].velocity_W[2] += Fifty(1e-20); }), 1e-20 / 4, 1e-30);
    EXPECT_NEAR(differs([](auto& run) { run.motions[0].angular_velocity_B[0] += Fifty(1e-20); }), 1e-20 / 16, 1e-30);
    EXPECT_NEAR(differs([](auto& run) { run.motions[0].q.y += Fifty(1e-20); }), 2e-20, 1e-30);
    EXPECT_EQ(differs([](auto& run) {
                  Quaternion<Fifty>& q = run.motions[2].q;
                  q = {-q.w, -q.x, -q.y, -q.z};
              }),
              3);
    const double infinite = std::numeric_limits<double>::infinity();
    EXPECT_EQ(differs([](auto& run) { run.motions[1].q.w = std::numeric_limits<Fifty>::quiet_NaN(); }), infinite);
    EXPECT_EQ(differs([&](auto& run) { run.motions[1].velocity_W[0] = Fifty(infinite); }), infinite);
    // a block that is zero throughout has an absolute difference
    RunOfOne rest = run_of_one();
    for (Motion<Fifty>& m : rest.motions) m.velocity_W = {};
    RunOfOne other = rest;
    other.motions[1].velocity_W[0] = Fifty(1e-20);
    RunOfOne nothing = rest;
    EXPECT_EQ(disagreement(rest, nothing), 0);
    EXPECT_EQ(disagreement(rest, other), 1e-20);
}

Problem problem_of_one() {
    Problem problem;
    problem.scene.name = "one", problem.scene.duration = 1;
    problem.scene.body.mass = 2, problem.scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 3));
    return problem;
}

TEST(TruthOfOneBody, IsWrittenWithItsEnergyAndItsRateInTheWorld) {
    RunOfOne run = run_of_one();
    // rotated by a third of a rotation about (1, 1, 1), so that the body's z axis is the world's x axis
    run.motions[0].q = {Fifty(0.5), Fifty(0.5), Fifty(0.5), Fifty(0.5)};
    const Attempt attempt = compare_runs(problem_of_one(), three_times, run, run, "by hand", 50);
    const ReferenceSample& first = attempt.truth.reference.samples[0];
    EXPECT_EQ(first.angular_velocity_B[2].high, 2);
    EXPECT_EQ(first.angular_momentum_W[0].high, 6);
    // 3 2^2 / 2 for the rotation, and 2 (1 + 1/9) / 2 for the flight
    EXPECT_EQ(first.energy.high, 6 + 10.0 / 9);
    EXPECT_EQ(attempt.truth.decimals[0][4].substr(0, 4), "2.00");
    EXPECT_EQ(attempt.truth.decimals[0][6][0], '0');
    EXPECT_EQ(attempt.truth.reference.samples[1].energy.high, 3 * 128 + 16);
}

TEST(TruthOfOneBody, ItsImpactsAreComparedAndCounted) {
    RunOfOne first = run_of_one(), second = run_of_one();
    first.impacts = {Fifty(0.25), Fifty(0.5)};
    second.impacts = {Fifty(0.25) + Fifty(3e-20), Fifty(0.5) - Fifty(1e-20)};
    Attempt attempt = compare_runs(problem_of_one(), three_times, first, second, "by hand", 50);
    EXPECT_EQ(attempt.agreed_digits, 50);
    EXPECT_NEAR(attempt.truth.reference.impact_time_error, 3e-20, 1e-30);
    ASSERT_EQ(attempt.truth.reference.impact_times.size(), 2u);
    EXPECT_NE(attempt.truth.reference.message.find("2 impacts"), std::string::npos);
    second.impacts.pop_back();
    attempt = compare_runs(problem_of_one(), three_times, first, second, "by hand", 50);
    EXPECT_LT(attempt.agreed_digits, 0);
    EXPECT_TRUE(std::isinf(attempt.truth.reference.bound));
}

TEST(TruthOfSeveralBodies, ReactionsThatOnlyOneKnowsAreLeftOut) {
    MechanismOutputs<Fifty> first;
    for (int k = 0; k < 3; ++k) first.reactions.push_back({{{Fifty(k), Fifty(0), Fifty(0)}, {}}});
    const Attempt attempt = compare_runs(problem_of_two(), three_times, run_of_two(), run_of_two(), "by hand", 50,
                                         first, MechanismOutputs<Fifty>());
    EXPECT_EQ(attempt.agreed_digits, 50);
    EXPECT_TRUE(attempt.truth.reference.reactions.empty());
}

TEST(TruthOfSeveralBodies, JointsWithoutForceAgree) {
    MechanismOutputs<Fifty> still;
    for (int k = 0; k < 3; ++k) still.reactions.push_back({{{}, {}}});
    const Attempt attempt =
        compare_runs(problem_of_two(), three_times, run_of_two(), run_of_two(), "by hand", 50, still, still);
    EXPECT_EQ(attempt.agreed_digits, 50);
    EXPECT_EQ(attempt.truth.reference.reactions[1].torque_W[0].high, 0);
    EXPECT_EQ(attempt.truth.reaction_decimals[1][4].find("nan"), std::string::npos);
}

}  // namespace
}  // namespace polhode::truth
