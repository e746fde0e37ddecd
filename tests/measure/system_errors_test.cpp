// Errors of several bodies on trajectories made by hand, compared with values computed by hand.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "measure/errors.h"
#include "motion/exact_body.h"

namespace polhode {
namespace {

// uniform in [-2, 2]
double small_number() { return *rc::gen::inRange(-2000, 2001) / 1000.0; }
Vector3<double> small_vector() { return {small_number(), small_number(), small_number()}; }

Vector3<Pair> exactly(const Vector3<double>& v) { return {v[0], v[1], v[2]}; }
ReferenceSample true_sample(const Sample& s) {
    ReferenceSample r;
    r.t = s.t, r.q = {s.q.w, s.q.x, s.q.y, s.q.z}, r.angular_velocity_B = exactly(s.angular_velocity_B);
    r.position_W = exactly(s.position_W), r.velocity_W = exactly(s.velocity_W);
    return r;
}

// Two bodies 2 m apart on x that rotate independently about z at 3 rad/s. The joint is half-way between them.
Scene two_turning_bodies(bool tied) {
    Scene scene;
    scene.name = "two", scene.duration = 1;
    scene.bodies.resize(2);
    scene.bodies[0].name = "left", scene.bodies[1].name = "right";
    for (NamedBody& body : scene.bodies) body.body.inertia_B = diagonal(Vector3<double>(1, 2, 4));
    scene.bodies[0].body.mass = 2, scene.bodies[1].body.mass = 2;
    scene.joints.resize(1);
    scene.joints[0].name = "middle", scene.joints[0].type = JointType::spherical;
    scene.joints[0].parent = tied ? "world" : "left", scene.joints[0].child = "right";
    if (!tied) scene.joints[0].parent_point = {1, 0, 0};
    scene.joints[0].child_point = {-1, 0, 0};
    return scene;
}

Trajectory turning_bodies(double rate_left = 3, double rate_right = 3) {
    Trajectory trajectory;
    for (int k = 0; k <= 4; ++k) {
        std::vector<Sample> both(2);
        for (std::size_t i = 0; i < 2; ++i) {
            both[i].t = sample_time(1, k, 4);
            both[i].q = {1, 0, 0, 0}, both[i].angular_velocity_B = {0, 0, i == 0 ? rate_left : rate_right};
            both[i].position_W = {i == 0 ? -1.0 : 1.0, 0, 0};
        }
        trajectory.append(both);
    }
    return trajectory;
}

Reference truth_of(const Trajectory& trajectory) {
    Reference truth;
    truth.available = true, truth.bodies = trajectory.bodies;
    for (const Sample& s : trajectory.samples) truth.samples.push_back(true_sample(s));
    return truth;
}

Errors errors_of(const Scene& scene, const Trajectory& trajectory, const Reference& truth) {
    return errors(error_series(scene, trajectory, truth), trajectory, truth);
}

TEST(SystemErrors, AreTheWorstBodysAndItIsNamed) {
    const Scene scene = two_turning_bodies(false);
    Trajectory trajectory = turning_bodies();
    const Reference truth = truth_of(trajectory);
    for (const Measure& m : measures()) {
        if (m.name == "reaction") continue;
        EXPECT_EQ(errors_of(scene, trajectory, truth)[m.name].max.value_or(-1), 0) << m.name;
    }
    // at one time the right body is rotated by 1/4 rad; at another the left one by 1/8 rad, shifted and too fast
    trajectory.samples[5].q = {std::cos(0.125), 0, 0, std::sin(0.125)};
    trajectory.samples[6].q = {2 * std::cos(0.0625), 0, 0, 2 * std::sin(0.0625)};
    trajectory.samples[6].position_W[1] = 0.5, trajectory.samples[6].angular_velocity_B[2] = 3.75;
    const ErrorSeries series = error_series(scene, trajectory, truth);
    const Errors e = errors(series, trajectory, truth);
    EXPECT_EQ(series.t.size(), 5U);
    EXPECT_NEAR(series["attitude"][2], 0.25, 1e-15);
    EXPECT_NEAR(series["attitude"][3], 0.125, 1e-15);
    EXPECT_NEAR(*e["attitude"].max, 0.25, 1e-15);
    EXPECT_EQ(*e["attitude"].final, 0);
    EXPECT_EQ(e.worst_body, "right");
    EXPECT_EQ(*e["position"].max, 0.5);
    EXPECT_NEAR(*e["omega"].max, 0.25, 1e-15);
    EXPECT_NEAR(*e["norm"].max, 1, 1e-15);
    // L = 4 w for each body, with no orbital part because the centres of mass are at rest
    EXPECT_NEAR(*e["momentum"].max, 0.75 * 4 / (2 * 3 * 4), 1e-15);
    EXPECT_NEAR(*e["energy"].max, (3.75 * 3.75 - 9) / (2 * 9), 1e-15);
    // the left body's joint point, (1, 0, 0) from its centre, is 1/2 m above the right one's, and rotated by 1/8 rad
    const double across = 0.5 + std::sin(0.125), along = std::cos(0.125) - 1;
    EXPECT_NEAR(*e["joint_gap"].max, std::hypot(across, along), 1e-15);
    EXPECT_EQ(*e["joint_turn"].max, 0);
}

TEST(SystemErrors, WhatTurnsOppositelyHasNoMomentumAndItsErrorIsAbsolute) {
    const Scene scene = two_turning_bodies(false);
    Trajectory trajectory = turning_bodies(3, -3);
    Reference truth = truth_of(trajectory);
    // round-off of a computed reference: low parts of order 1e-28
    for (ReferenceSample& s : truth.samples) s.angular_velocity_B[0].low = 1e-28, s.velocity_W[0].low = 1e-27;
    trajectory.samples[8].angular_velocity_B[2] += 0x1p-20;
    trajectory.samples[8].velocity_W[1] += 0x1p-30;
    const Errors e = errors_of(scene, trajectory, truth);
    EXPECT_NEAR(*e["momentum"].max, 0x1p-18 - 0x1p-29, 1e-15);
    EXPECT_NEAR(*e["linear_momentum"].max, 0x1p-29, 1e-18);
    // a reference at rest, up to round-off: the error is absolute
    trajectory = turning_bodies(0, 0);
    truth = truth_of(trajectory);
    for (ReferenceSample& s : truth.samples) s.angular_velocity_B[0].low = 1e-28;
    trajectory.samples[8].angular_velocity_B[2] = 0x1p-20;
    EXPECT_NEAR(*errors_of(scene, trajectory, truth)["omega"].max, 0x1p-20, 1e-20);
}

TEST(SystemErrors, MomentaAreThoseThatTheSystemHas) {
    Trajectory trajectory = turning_bodies();
    for (Sample& s : trajectory.samples) s.velocity_W = {0, 0.5, 0};
    const Reference truth = truth_of(trajectory);
    trajectory.samples[9].velocity_W = {0, 0.75, 0};
    // free: about the common centre of mass at the origin: 2 kg times 1/4 m/s minus the mean of 1/8 m/s, at arms of 1 m
    Errors e = errors_of(two_turning_bodies(false), trajectory, truth);
    EXPECT_NEAR(*e["momentum"].max, 2 * 0.125 * 2 / 24, 1e-15);
    EXPECT_NEAR(*e["linear_momentum"].max, 2 * 0.25 / 2, 1e-15);
    // tied to the world: about the world's origin, and linear momentum is not compared
    e = errors_of(two_turning_bodies(true), trajectory, truth);
    EXPECT_NEAR(*e["momentum"].max, 2 * 0.25 / 24, 1e-15);
    EXPECT_FALSE(e["linear_momentum"].max);
}

TEST(SystemErrors, ReactionsAreRelativeToTheLargest) {
    const Scene scene = two_turning_bodies(true);
    Trajectory trajectory = turning_bodies();
    Reference truth = truth_of(trajectory);
    for (int k = 0; k < 5; ++k) {
        trajectory.reactions.push_back({{0, 0, 1.0 * k}, {}});
        truth.reactions.push_back({exactly({0, 0, 1.0 * k}), exactly({})});
    }
    EXPECT_EQ(*errors_of(scene, trajectory, truth)["reaction"].max, 0);
    trajectory.reactions[1].force_W[0] = 1;
    EXPECT_NEAR(*errors_of(scene, trajectory, truth)["reaction"].max, 0.25, 1e-15);
    // the largest torque is zero: the scale is that of the largest force at 1 m from the centre of mass
    trajectory.reactions[1].torque_W[0] = 2;
    EXPECT_NEAR(*errors_of(scene, trajectory, truth)["reaction"].max, 0.5, 1e-15);
    // components that redundant constraints leave undetermined (NaN) do not count
    truth.reactions[1].torque_W[0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NEAR(*errors_of(scene, trajectory, truth)["reaction"].max, 0.25, 1e-15);
    // without reactions of the reference there is no error
    truth.reactions.clear();
    EXPECT_FALSE(errors_of(scene, trajectory, truth)["reaction"].max);
}

TEST(SystemErrors, WithoutTruthThereAreTheJointsAndTheNorm) {
    Trajectory trajectory = turning_bodies();
    trajectory.samples[4].position_W[2] = 0.25;
    const Errors e = errors_of(two_turning_bodies(false), trajectory, {});
    EXPECT_EQ(*e["joint_gap"].max, 0.25);
    EXPECT_EQ(*e["norm"].max, 0);
    for (const char* name : {"attitude", "omega", "energy", "momentum", "position", "linear_momentum", "reaction"})
        EXPECT_FALSE(e[name].max) << name;
    EXPECT_EQ(e.worst_body, "");
}

TEST(SystemErrors, OtherNumbersOfBodiesAndOtherTimesAreRefused) {
    const Scene scene = two_turning_bodies(false);
    const Trajectory trajectory = turning_bodies();
    Reference truth = truth_of(trajectory);
    truth.samples[7].t += 1e-9;
    EXPECT_NO_THROW(error_series(scene, trajectory, truth));  // only the first body's time is compared
    truth.samples[6].t += 1e-9;
    EXPECT_THROW(error_series(scene, trajectory, truth), std::invalid_argument);
    truth.bodies = 1;
    EXPECT_THROW(error_series(scene, trajectory, truth), std::invalid_argument);
    Trajectory other = trajectory;
    other.bodies = 5;
    EXPECT_THROW(error_series(scene, other, truth_of(trajectory)), std::invalid_argument);
}

TEST(SystemErrors, GoAsFarAsTheTruthDoes) {
    const Trajectory trajectory = turning_bodies();
    Reference truth = truth_of(trajectory);
    truth.samples.resize(8);
    const ErrorSeries series = error_series(two_turning_bodies(false), trajectory, truth);
    EXPECT_EQ(series.t.size(), 5U);
    EXPECT_EQ(series["attitude"].size(), 4U);
    EXPECT_EQ(series["energy"].size(), 4U);
    EXPECT_EQ(series["norm"].size(), 5U);
}

TEST(SystemErrors, WhatIsNotANumberIsTheWorst) {
    const Scene scene = two_turning_bodies(false);
    const Reference truth = truth_of(turning_bodies());
    // NaN in either body wins over a finite error of the other one
    for (const std::size_t broken : {4U, 5U}) {
        Trajectory trajectory = turning_bodies();
        trajectory.samples[broken].q.w = std::numeric_limits<double>::quiet_NaN();
        trajectory.samples[broken == 4 ? 5 : 4].q = {std::cos(0.125), 0, 0, std::sin(0.125)};
        const ErrorSeries series = error_series(scene, trajectory, truth);
        EXPECT_TRUE(std::isnan(series["attitude"][2])) << broken;
        EXPECT_EQ(series["attitude"][1], 0) << broken;
    }
}

TEST(SystemErrors, AreRelativeToTheLargestEvenWhereTheTruthEndsAtRest) {
    Trajectory trajectory = turning_bodies();
    for (std::size_t i : {8U, 9U}) trajectory.samples[i].angular_velocity_B = {};
    const Reference truth = truth_of(trajectory);
    trajectory.samples[9].angular_velocity_B = {0, 0, 0.75};
    const Errors e = errors_of(two_turning_bodies(false), trajectory, truth);
    EXPECT_NEAR(*e["omega"].final, 0.25, 1e-15);
    EXPECT_NEAR(*e["momentum"].final, 0.75 * 4 / 24, 1e-15);
    EXPECT_NEAR(*e["energy"].final, 0.75 * 0.75 / (2 * 9), 1e-15);
}

TEST(SystemErrors, TheMomentumIsComparedAsAVector) {
    Trajectory trajectory = turning_bodies();
    const Reference truth = truth_of(trajectory);
    for (std::size_t i : {6U, 7U}) trajectory.samples[i].angular_velocity_B = {0, 0, -3};
    EXPECT_NEAR(*errors_of(two_turning_bodies(false), trajectory, truth)["momentum"].max, 2, 1e-15);
}

TEST(SystemErrors, TheEnergyIsRelativeToTheLargerOfItselfAndTheKineticOne) {
    Scene scene = two_turning_bodies(false);
    scene.loads = {Gravity{{0, 0, -9}, {}}};
    // kinetic energy 36 J; potential energy 36 J per metre of common height
    for (const double height : {1.0, -1.0}) {
        Trajectory trajectory = turning_bodies();
        for (Sample& s : trajectory.samples) s.position_W[2] = height;
        const Reference truth = truth_of(trajectory);
        trajectory.samples[9].position_W[2] += 0.5;
        EXPECT_NEAR(*errors_of(scene, trajectory, truth)["energy"].max, 9.0 / (height > 0 ? 72 : 36), 1e-15);
    }
}

TEST(SystemErrors, OfSeveralJointsAreTheWorstOnes) {
    Scene scene = two_turning_bodies(true);
    scene.joints.resize(2, scene.joints[0]);
    scene.joints[1].name = "other", scene.joints[1].child = "left", scene.joints[1].child_point = {1, 0, 0};
    Trajectory trajectory = turning_bodies();
    Reference truth = truth_of(trajectory);
    // the largest force is 4 N, at the second joint half-way through the run
    for (int k = 0; k < 5; ++k)
        for (const double force : {1.0, k == 2 ? 4.0 : 2.0}) {
            trajectory.reactions.push_back({{0, 0, force}, {}});
            truth.reactions.push_back({exactly({0, 0, force}), exactly({})});
        }
    trajectory.reactions[5].force_W[0] = 1;
    trajectory.reactions[8].force_W[0] = 0.5;
    const ErrorSeries series = error_series(scene, trajectory, truth);
    EXPECT_EQ(series["reaction"], (std::vector<double>{0, 0, 0.25, 0, 0.125}));
    // a force with an undetermined component is not used for the largest force
    truth.reactions[5].force_W[2] = Pair(std::numeric_limits<double>::quiet_NaN());
    EXPECT_EQ(error_series(scene, trajectory, truth)["reaction"], (std::vector<double>{0, 0, 0.5, 0, 0.25}));
    // its determined components are still compared
    truth.reactions[5].force_W[0] = Pair(5), trajectory.reactions[5].force_W[0] = 6;
    EXPECT_EQ(error_series(scene, trajectory, truth)["reaction"], (std::vector<double>{0, 0, 0.2, 0, 0.1}));
}

TEST(SystemErrors, TheDefectOfAMatrixIsTheWorstBodys) {
    Trajectory trajectory = turning_bodies();
    trajectory.orthogonality_defect.assign(10, 0.0);
    trajectory.orthogonality_defect[5] = 1e-3, trajectory.orthogonality_defect[8] = 2e-3;
    EXPECT_EQ(error_series(two_turning_bodies(false), trajectory, {})["norm"],
              (std::vector<double>{0, 0, 1e-3, 0, 2e-3}));
}

TEST(SystemErrors, SayWhichNumberOfBodiesIsAnother) {
    const Scene scene = two_turning_bodies(false);
    const auto fault = [&](const Trajectory& trajectory, const Reference& truth) -> std::string {
        try {
            error_series(scene, trajectory, truth);
        } catch (const std::invalid_argument& e) {
            return e.what();
        }
        return "";
    };
    Trajectory trajectory = turning_bodies();
    Reference truth = truth_of(trajectory);
    truth.bodies = 1;
    EXPECT_EQ(fault(trajectory, truth), "the truth has a different number of bodies than the scene");
    trajectory.bodies = 5;
    EXPECT_EQ(fault(trajectory, truth_of(turning_bodies())),
              "the trajectory has a different number of bodies than the scene");
}

// The errors of one body are the same whether the scene has `body` or a list of one body in `bodies`.
RC_GTEST_PROP(SystemErrors, OfOneBodyAreThoseOfABodyAlone, ()) {
    Scene alone;
    alone.name = "alone", alone.duration = 1;
    alone.body.mass = 3, alone.body.inertia_B = diagonal(Vector3<double>(2, 3, 4));
    alone.body.center_of_mass = small_vector();
    alone.loads = {Gravity{small_vector(), {}}};
    Scene several = alone;
    several.bodies = {{"only", alone.body, {}}};
    Trajectory trajectory, right;
    Reference truth;
    truth.available = true;
    const ExactBody<Wide> body = exact_body<Wide>(alone);
    for (int k = 0; k <= 3; ++k) {
        Sample s;
        s.t = sample_time(1, k, 3);
        s.q = {2 + small_number() / 2, small_number(), small_number(), small_number()};
        s.angular_velocity_B = small_vector(), s.position_W = small_vector(), s.velocity_W = small_vector();
        ReferenceSample r = true_sample(s);
        const Quaternion<Wide> q = normalized(cast<Wide>(s.q));
        const auto pair = [](const Wide& x) { return Pair(double(x), double(x - Wide(double(x)))); };
        r.q = {pair(q.w), pair(q.x), pair(q.y), pair(q.z)};
        const Invariants<Wide> kept = invariants(alone, body, s.t, q, cast<Wide>(s.angular_velocity_B),
                                                 cast<Wide>(s.position_W), cast<Wide>(s.velocity_W));
        r.energy = pair(kept.energy);
        for (std::size_t i = 0; i < 3; ++i) r.angular_momentum_W[i] = pair(kept.angular_momentum_W[i]);
        truth.samples.push_back(r);
        s.q.w += small_number(), s.angular_velocity_B[0] += small_number(), s.position_W[1] += small_number();
        s.velocity_W[2] += small_number();
        trajectory.samples.push_back(s);
    }
    const ErrorSeries one = error_series(alone, trajectory, truth), other = error_series(several, trajectory, truth);
    for (std::size_t m = 0; m < measures().size(); ++m) {
        if (!measures()[m].of_one_body) continue;
        RC_ASSERT(one[m].size() == other[m].size());
        for (std::size_t k = 0; k < one[m].size(); ++k)
            RC_ASSERT(std::abs(one[m][k] - other[m][k]) <= 1e-15 * (1 + std::abs(one[m][k])));
    }
    RC_ASSERT(other.worst_body == "only");
}

}  // namespace
}  // namespace polhode
