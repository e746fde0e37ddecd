// The truth against closed forms evaluated in 100 digits, exact invariants and published figures.
#include "integrators/truth/reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>

#include "integrators/series/real.h"
#include "integrators/truth/fresh_cache.h"
#include "motion/exact_body.h"
#include "motion/problem.h"
#include "scene/body_source.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

using R = Real<100>;

R value(const Pair& pair) { return R(pair.high) + R(pair.low); }
Vector3<R> value(const Vector3<Pair>& v) { return {value(v[0]), value(v[1]), value(v[2])}; }
Quaternion<R> value(const Quaternion<Pair>& q) { return {value(q.w), value(q.x), value(q.y), value(q.z)}; }

double distance(const Vector3<R>& a, const Vector3<R>& b) {
    return square_root(dot(a - b, a - b)).convert_to<double>();
}
double distance(const Quaternion<R>& a, const Quaternion<R>& b) {
    return square_root(squared_norm(Quaternion<R>{a.w - b.w, a.x - b.x, a.y - b.y, a.z - b.z})).convert_to<double>();
}

// unit quaternion of a rotation by `angle` about the unit vector `axis`
Quaternion<R> turn(const Vector3<R>& axis, const R& angle) {
    const R s = sin(R(angle / 2));
    return {cos(R(angle / 2)), s * axis[0], s * axis[1], s * axis[2]};
}

Scene free_body(const Vector3<double>& moments, const Vector3<double>& rate, double duration) {
    Scene scene;
    scene.name = "free";
    scene.duration = duration;
    scene.body.inertia_B = diagonal(moments);
    scene.initial.angular_velocity = rate;
    return scene;
}

// 25 digits are promised; these motions have scales of at most 10
constexpr double promised = 1e-24;

TEST(Reference, SymmetricBodyFollowsTheTrigonometricForm) {
    Scene scene = free_body({1, 1, 1.5}, {0.5, 0.25, 2}, 20);
    scene.initial.orientation = {0.5, 0.5, -0.5, 0.5};
    const FreshCache cache;
    const Reference truth = reference(scene, 40);
    ASSERT_TRUE(truth.available) << truth.message;
    ASSERT_EQ(truth.samples.size(), 41u);
    const Quaternion<R> q0{R(0.5), R(0.5), R(-0.5), R(0.5)};
    const Vector3<R> L_B(R(0.5), R(0.25), R(3)), L_W = rotate(q0, L_B);
    const R length = square_root(dot(L_B, L_B));
    for (const ReferenceSample& sample : truth.samples) {
        // w_perp rotates at (I3 - I1)/I1 w3 = 1 rad/s; q: about L by |L| t / I1 after about z by (I1 - I3)/I1 w3 t
        const R t(sample.t), c = cos(t), s = sin(t);
        const Vector3<R> w(R(0.5) * c - R(0.25) * s, R(0.25) * c + R(0.5) * s, R(2));
        const Quaternion<R> q = turn((R(1) / length) * L_W, R(length * t)) * q0 * turn({R(0), R(0), R(1)}, R(-t));
        EXPECT_LT(distance(value(sample.angular_velocity_B), w), promised);
        EXPECT_LT(distance(value(sample.q), q), promised);
        EXPECT_LT(distance(value(sample.angular_momentum_W), L_W), promised);
    }
}

TEST(Reference, DraggedAxisDecaysExponentially) {
    Scene scene = free_body({1, 2, 2.5}, {0, 0, 4}, 10);
    scene.loads.push_back(Drag{{0.25, 0.5, 0.625}, 0, {}});
    const FreshCache cache;
    const Reference truth = reference(scene, 10);
    ASSERT_TRUE(truth.available) << truth.message;
    for (const ReferenceSample& sample : truth.samples) {
        // w = w0 e^(-c t / I), c / I = 1/4; angle = w0 (1 - e^(-t/4)) 4
        const R decay = exp(R(-R(sample.t) / 4));
        EXPECT_LT(distance(value(sample.angular_velocity_B), {R(0), R(0), 4 * decay}), promised);
        EXPECT_LT(distance(value(sample.q), turn({R(0), R(0), R(1)}, R(16 * (1 - decay)))), promised);
    }
}

TEST(Reference, SeparatrixFollowsTheHyperbolicForm) {
    // I = (3, 4, 6), w0 = (2, 0, 1): w = (2 sech, 3/sqrt2 tanh, sech)(t / sqrt2), exactly representable
    const FreshCache cache;
    const Reference truth = reference(free_body({3, 4, 6}, {2, 0, 1}, 16), 32);
    ASSERT_TRUE(truth.available) << truth.message;
    const R root = sqrt(R(2));
    for (const ReferenceSample& sample : truth.samples) {
        const R u = R(sample.t) / root, sech = 1 / cosh(u);
        EXPECT_LT(distance(value(sample.angular_velocity_B), {2 * sech, 3 / root * tanh(u), sech}), promised);
    }
}

TEST(Reference, AsymmetricBodyFollowsJacobisFunctions) {
    // I = (1, 2, 3), w0 = (1, 0, 2): w = (cn, sn, 2 dn)(2 t, k), k^2 = 1/12
    const FreshCache cache;
    const Reference truth = reference(free_body({1, 2, 3}, {1, 0, 2}, 20), 20);
    ASSERT_TRUE(truth.available) << truth.message;
    const R k = sqrt(R(1) / 12);
    for (const ReferenceSample& sample : truth.samples) {
        R cn, dn;
        const R sn = boost::math::jacobi_elliptic(k, R(2 * R(sample.t)), &cn, &dn);
        EXPECT_LT(distance(value(sample.angular_velocity_B), {cn, sn, 2 * dn}), promised);
    }
}

TEST(Reference, HeavyTopKeepsEnergyAndVerticalMomentum) {
    Scene scene = free_body({0.75, 0.75, 0.5}, {0, 0, 20}, 10);
    scene.body.center_of_mass = {0, 0, 0.5};
    scene.pivot = Vector3<double>();
    scene.initial.orientation = {0.9689124217106447, 0.24740395925452294, 0, 0};
    scene.loads.push_back(Gravity{{0, 0, -9.80665}, {}});
    const FreshCache cache;
    const Reference truth = reference(scene, 20);
    ASSERT_TRUE(truth.available) << truth.message;
    const ReferenceSample& start = truth.samples.front();
    for (const ReferenceSample& sample : truth.samples) {
        // E is about 104 J, L about 10 kg m^2/s
        EXPECT_LT(abs(R(value(sample.energy) - value(start.energy))), R(1e-22));
        EXPECT_LT(abs(R(value(sample.angular_momentum_W[2]) - value(start.angular_momentum_W[2]))), R(1e-23));
        // p = R(q) arm
        EXPECT_LT(distance(value(sample.position_W), rotate(value(sample.q), Vector3<R>(R(0), R(0), R(0.5)))),
                  promised);
    }
    EXPECT_GT(distance(value(truth.samples.back().q), value(start.q)), 0.1);
}

TEST(Reference, NasaTumblingBrickTurnsAsPublished) {
    // NESC-RP-12-00770, check case 2, simulation 1; NASA's own tools differ from each other by up to 5e-3 deg/s
    constexpr double degree = std::numbers::pi / 180;
    const Scene scene = free_body({0.001894220, 0.006211019, 0.007194665}, {10 * degree, 20 * degree, 30 * degree}, 30);
    const FreshCache cache;
    const Reference truth = reference(scene, 3);
    ASSERT_TRUE(truth.available) << truth.message;
    const Vector3<double> at_10(-2.41890222177841, -23.55256951951579, 28.12859263003343),
        at_30(12.61839077566776, -17.3974747618308, 31.11958888682995);
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(truth.samples[1].angular_velocity_B[i].high / degree, at_10[i], 5e-3);
        EXPECT_NEAR(truth.samples[3].angular_velocity_B[i].high / degree, at_30[i], 5e-3);
    }
}

TEST(Reference, SamplesAtAnEventShowTheMotionAfterIt) {
    Scene scene = free_body({1, 2, 2.5}, {0, 0, 0}, 2);
    scene.loads.push_back(Impulse{{0, 0, 3}, Frame::world, {1, 0, 0}, Frame::body, 1});
    scene.loads.push_back(Impulse{{0.5, 0, 0}, Frame::world, {}, Frame::body, 2});
    scene.loads.push_back(Impulse{{0, 0.25, 0}, Frame::world, {}, Frame::body, 0});
    const FreshCache cache;
    const Reference truth = reference(scene, 2);
    ASSERT_TRUE(truth.available) << truth.message;
    const auto& [start, middle, end] = std::tie(truth.samples[0], truth.samples[1], truth.samples[2]);
    EXPECT_EQ(start.velocity_W[1].high, 0.25);
    EXPECT_EQ(start.angular_velocity_B[1].high, 0);
    // r x J = (1, 0, 0) x (0, 0, 3) = (0, -3, 0)
    EXPECT_NEAR(middle.angular_velocity_B[1].high, -1.5, 1e-15);
    EXPECT_NEAR(middle.velocity_W[2].high, 3, 1e-15);
    EXPECT_NEAR(end.velocity_W[0].high, 0.5, 1e-15);
    EXPECT_NEAR(end.position_W[1].high, 0.5, 1e-15);
    EXPECT_NEAR(end.position_W[2].high, 3, 1e-15);
}

// w = (cn, sn, 2 dn)(2 t, k), k^2 = 1/12, at times other than regular samples
TEST(Reference, IsThereAtAnyTimes) {
    const FreshCache cache;
    const Scene scene = free_body({1, 2, 3}, {1, 0, 2}, 5);
    const std::vector<double> times{0.1, 0.3, 0x1p-20 + 2, 2.5, 5.5};  // also beyond the scene's end
    const R k = sqrt(R(1) / 12);
    for (int round = 0; round < 2; ++round) {  // computed, then from the cache
        const Reference truth = reference(scene, times);
        ASSERT_TRUE(truth.available) << truth.message;
        ASSERT_EQ(truth.samples.size(), times.size());
        for (std::size_t i = 0; i < times.size(); ++i) {
            EXPECT_EQ(truth.samples[i].t, times[i]);
            R cn, dn;
            const R sn = boost::math::jacobi_elliptic(k, R(2 * R(times[i])), &cn, &dn);
            EXPECT_LT(distance(value(truth.samples[i].angular_velocity_B), {cn, sn, 2 * dn}), promised);
        }
    }
    // explicit times equal to the default times use the same cached truth
    const Reference usual = reference(scene, 4), same = reference(scene, {0, 1.25, 2.5, 3.75, 5});
    EXPECT_EQ(usual.message, same.message);
    const std::filesystem::directory_iterator files(cache.directory());
    EXPECT_EQ(
        std::count_if(begin(files), end(files), [](const auto& file) { return file.path().extension() == ".txt"; }), 2);
    for (const std::vector<double>& bad :
         {std::vector<double>{}, {-1, 0}, {0, 1, 1}, {2, 1}, {0, std::numeric_limits<double>::infinity()}})
        EXPECT_THROW(reference(scene, bad), std::invalid_argument);
}

TEST(Reference, UsersTorqueHasNoTruth) {
    Scene scene = free_body({1, 2, 2.5}, {1, 1, 1}, 1);
    scene.loads.push_back(UserTorque{"mine", [](const LoadState&) { return Vector3<double>(); }, {}});
    const Reference truth = reference(scene, 1);
    EXPECT_FALSE(truth.available);
    EXPECT_NE(truth.message.find("user-defined torque"), std::string::npos);
}

TEST(Reference, SensitiveMotionIsComputedInMoreDigitsOrRefused) {
    // near the separatrix errors grow by e^(t sqrt 2) = 10^24 over t = 40 s: 30 digits need a hundred, not fifty
    const FreshCache cache;
    const Scene scene = free_body({3, 4, 6}, {0, 2, 0x1p-30}, 100);
    const Reference truth = reference(scene, 4, 30);
    ASSERT_TRUE(truth.available) << truth.message;
    EXPECT_LE(truth.bound, 1e-30);
    const Reference refused = reference(scene, 4, most_truth_digits + 1);
    EXPECT_FALSE(refused.available);
    EXPECT_NE(refused.message.find("80"), std::string::npos) << refused.message;
}

TEST(Reference, DecimalsAgreeWithPairs) {
    const FreshCache cache;
    const Scene scene = free_body({1, 2, 3}, {1, 0, 2}, 3);
    const Reference truth = reference(scene, 3);
    const DecimalReference decimals = decimal_reference(scene, 3, 40);
    ASSERT_TRUE(truth.available && decimals.available) << decimals.message;
    EXPECT_LE(decimals.bound, 1.1e-41);
    for (int k = 0; k <= 3; ++k) {
        EXPECT_LT(abs(R(R(decimals.columns[k][0]) - value(truth.samples[k].q.w))), R(promised));
        // w in world axes
        const Vector3<R> w = rotate(value(truth.samples[k].q), value(truth.samples[k].angular_velocity_B));
        EXPECT_LT(abs(R(R(decimals.columns[k][6]) - w[2])), R(promised));
    }
}

TEST(Reference, HasTheEnergyOfTheMotion) {
    const FreshCache cache;
    Scene scene = free_body({1, 2, 3}, {1, 0, 2}, 1);
    scene.body.mass = 2, scene.initial.velocity_W = {3, 0, 0}, scene.initial.position_W = {0, 0, 1};
    scene.loads.push_back(Gravity{{0, 0, -8}, {}});
    // (1 + 12) / 2 + 9 + 2 8 1
    for (const ReferenceSample& sample : reference(scene, 2).samples) EXPECT_EQ(sample.energy.high, 31.5);
}

TEST(Reference, DecimalsAreBoundedWithTheirOwnRounding) {
    const FreshCache cache;
    const Scene scene = free_body({1, 2, 3}, {1, 0, 2}, 1);
    const DecimalReference few = decimal_reference(scene, 1, 10);
    ASSERT_TRUE(few.available);
    // 12 digits are written: 5 10^-12 in each component, 10^-11 in the attitude
    EXPECT_GE(few.bound, 1e-11);
    EXPECT_LT(few.bound, 1.001e-11);
    EXPECT_EQ(few.times, (std::vector<double>{0, 1}));
}

TEST(Reference, AsManyDigitsAsCanBeAskedFor) {
    const FreshCache cache;
    const Reference most = reference(free_body({1, 2, 3}, {1, 0, 2}, 1), 1, most_truth_digits);
    ASSERT_TRUE(most.available) << most.message;
    EXPECT_LE(most.bound, std::pow(10.0, -most_truth_digits));
}

TEST(Reference, StiffMotionsAreNotFollowedOntoPlanes) {
    const FreshCache cache;
    Scene scene = free_body({1, 1, 1}, {1, 0, 2}, 1);
    scene.body = body_of(body_source(ShapedBody{SolidSphere{0.25}, {2, false}}));
    scene.initial.position_W = {0, 0, 2};
    scene.planes = {Plane{}};
    scene.loads.push_back(Drag{{1e6, 1e6, 1e6}, 0, {}});
    const Reference truth = reference(scene, 1);
    EXPECT_FALSE(truth.available);
    EXPECT_NE(truth.message.find("does not support planes"), std::string::npos) << truth.message;
}

// The stronger of the two dampings, of translation and of rotation, decides.
TEST(StrongDamping, IsThatOfTheFlightOrOfTheRotation) {
    Scene scene = free_body({1, 2, 3}, {1, 0, 2}, 1);
    scene.loads.push_back(Drag{{0, 0, 0}, 1e4, {}});
    EXPECT_EQ(truth_method(pose(scene)), "collocation");
    scene.loads = {Drag{{1e4, 1e4, 1e4}, 0, {}}};
    EXPECT_EQ(truth_method(pose(scene)), "collocation");
    scene.loads = {Drag{{1, 1, 1}, 1, {}}};
    EXPECT_EQ(truth_method(pose(scene)), "Taylor series");
    Scene longer = free_body({1, 2, 3}, {1, 0, 2}, 1e6);
    EXPECT_EQ(truth_method(pose(longer)), "closed form");
}

// Six hinges in a loop with redundant constraints: components that the motion does not determine have no digits.
TEST(Reference, DecimalsOfSeveralBodiesLeaveOutWhatIsNotDetermined) {
    const FreshCache cache;
    Scene scene = find_scene("mechanisms/bricard");
    scene.duration = 0.02;
    const DecimalReference truth = decimal_reference(scene, 2, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    EXPECT_EQ(truth.times, sample_times(scene.duration, 2));
    EXPECT_EQ(truth.columns.size(), 3 * scene.bodies.size());
    ASSERT_EQ(truth.reactions.size(), 3 * (scene.joints.size() + scene.loops.size()));
    int open = 0, told = 0;
    for (const ReactionDecimals& reaction : truth.reactions)
        for (const std::string& number : reaction) {
            EXPECT_NE(number, "nan");
            ++(number.empty() ? open : told);
        }
    EXPECT_GT(open, 0);
    EXPECT_GT(told, 0);
}

}  // namespace
}  // namespace polhode
