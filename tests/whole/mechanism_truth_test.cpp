// The truth of mechanisms against the truth of one body, from other equations, against truths with more digits, and
// against published figures.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "build_kind.h"
#include "integrators/truth/jointed_start.h"
#include "motion/mechanism_motion.h"
#include "whole/truth_values.h"

namespace polhode {
namespace {

double apart(const Vector3<Pair>& a, const Vector3<Pair>& b) {
    return length(Vector3<Real100>(value(a) - value(b))).convert_to<double>();
}

/// The largest difference of two truths of the same bodies: rad and SI units, reactions relative to the largest.
double disagreement(const Reference& a, const Reference& b) {
    EXPECT_TRUE(a.available) << a.message;
    EXPECT_TRUE(b.available) << b.message;
    if (!a.available || !b.available) return INFINITY;
    EXPECT_EQ(a.samples.size(), b.samples.size());
    double worst = 0;
    for (std::size_t i = 0; i < a.samples.size(); ++i) {
        const ReferenceSample &x = a.samples[i], &y = b.samples[i];
        const Quaternion<Real100> between = conjugate(value(x.q)) * value(y.q);
        worst = std::max({worst, 2 * length(vector_part(between)).convert_to<double>(),
                          apart(x.angular_velocity_B, y.angular_velocity_B), apart(x.position_W, y.position_W),
                          apart(x.velocity_W, y.velocity_W)});
    }
    double largest = 0, off = 0;
    for (std::size_t i = 0; i < a.reactions.size() && i < b.reactions.size(); ++i) {
        const Reaction<Pair>&x = a.reactions[i], &y = b.reactions[i];
        largest = std::max(
            {largest, length(value(x.force_W)).convert_to<double>(), length(value(x.torque_W)).convert_to<double>()});
        off = std::max({off, apart(x.force_W, y.force_W), apart(x.torque_W, y.torque_W)});
    }
    return std::max(worst, largest > 0 ? off / largest : 0);
}

// A body on a spherical joint equals one with a pivot, and a mechanism of one free body equals a single body. One
// side uses Euler's equations and momenta, the other joint coordinates and multipliers.
TEST(MechanismTruth, OfOneBodyIsThatBodysTruth) {
    const FreshCache cache;
    for (const auto& [mechanism, body] : {std::pair("mechanisms/top_on_spherical_joint", "lagrange_top"),
                                          std::pair("mechanisms/free_body_as_mechanism", "free_asymmetric")}) {
        Scene of_joints = find_scene(mechanism), of_one = find_scene(body);
        of_joints.duration = of_one.duration = 2;
        const Reference joints = reference(of_joints, 4, 30), one = reference(of_one, 4, 30);
        // pairs have 106 bits, a relative accuracy of 1e-32; the top's w is 20 rad/s
        EXPECT_LT(disagreement(joints, one), 1e-28) << mechanism;
        ASSERT_EQ(joints.system.size(), one.samples.size());
        for (std::size_t i = 0; i < one.samples.size(); ++i) {
            EXPECT_LT(apart(joints.system[i].angular_momentum_W, one.samples[i].angular_momentum_W), 1e-27);
            EXPECT_LT(gap(value(joints.system[i].energy), value(one.samples[i].energy)), 1e-26);
        }
    }
}

// A pendulum released at theta_0: sin(theta / 2) = k sn(K - w t, k), k = sin(theta_0 / 2), w^2 = m g l / I.
TEST(MechanismTruth, OfAPendulumIsElliptic) {
    const FreshCache cache;
    Scene scene = find_scene("mechanisms/physical_pendulum");
    scene.duration = 3;
    const Reference truth = reference(scene, 3, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    const auto properties = bodies_mass_properties<Wide>(scene)[0];
    const Joint& hinge = scene.joints[0];
    ASSERT_EQ(hinge.rate[0], 0);
    const Real100 arm = length(Vector3<Real100>(Real100(double(properties.center[0] - Wide(hinge.child_point[0]))),
                                                Real100(double(properties.center[1] - Wide(hinge.child_point[1]))),
                                                Real100(double(properties.center[2] - Wide(hinge.child_point[2])))));
    const Real100 mass(double(properties.mass)), inertia(double(properties.inertia[1][1]));
    const Real100 gravity(std::abs(std::get<Gravity>(scene.loads[0]).acceleration_W[2]));
    const Real100 w = sqrt(Real100(mass * gravity * arm / (inertia + mass * arm * arm)));
    const Real100 k = sin(Real100(Real100(hinge.coordinate[0]) / 2));
    for (const ReferenceSample& sample : truth.samples) {
        const Real100 u = boost::math::ellint_1(k) - w * Real100(sample.t);
        const Real100 half_sine = k * boost::math::jacobi_sn(k, u);
        // q = (cos, 0, sin, 0) of half the angle about y
        EXPECT_LT(gap(value(sample.q.y), half_sine), 1e-25) << sample.t;
    }
}

// A truth with more digits confirms all digits of the first, for motions and reactions.
TEST(MechanismTruth, DigitsThatAreAskedForAreRight) {
    const FreshCache cache;
    const int count = optimised_build ? 6 : 1;
    for (int i = 0; i < count; ++i) {
        const unsigned seed = 100 + static_cast<unsigned>(i);
        Scene scene = random_tree(seed, 2 + i % 3, i % 2 == 1);
        Dice dice(seed);
        scene.loads.push_back(Gravity{{0, 0, -9.75}, {}});
        scene.loads.push_back(Force{dice.vector(), Frame::world, dice.vector(), Frame::world, {0.03, 0.09}, "b1"});
        scene.loads.push_back(Impulse{dice.vector(), Frame::body, dice.vector(), Frame::body, 0.0625, "b1"});
        const Reference few = reference(scene, 2, 25), more = reference(scene, 2, 40);
        ASSERT_EQ(few.reactions.size(), 3 * scene.joints.size());
        EXPECT_LT(disagreement(few, more), 1e-25) << "seed " << seed;
        EXPECT_LE(few.bound, 1e-25);
    }
}

}  // namespace
}  // namespace polhode
