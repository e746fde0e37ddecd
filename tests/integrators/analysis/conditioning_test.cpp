// The condition number kappa against closed forms, against the multiprecision Taylor series of the variational
// equation, and against finite differences of the truth, which need no derivatives.
#include "integrators/analysis/conditioning.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "integrators/analysis/reference_conditioning.h"
#include "integrators/scenes.h"
#include "integrators/series/linear_algebra.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"
#include "motion/moderate_scene.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

using testing::everything;
using testing::free_body;
using testing::heavy_top;
using testing::moderate;
using testing::moderate_orientation;
using testing::moderate_scene;
using testing::moderate_vector;
using testing::symmetric_attitude;
using testing::symmetric_body;

std::vector<double> sample_times(double duration, long n) {
    std::vector<double> times;
    for (long k = 0; k <= n; ++k) times.push_back(sample_time(duration, k, n));
    return times;
}

double length(const Vector3<double>& v) { return std::sqrt(dot(v, v)); }

// The largest relative difference of the state and attitude values over all times.
double difference(const Conditioning& a, const Conditioning& b) {
    EXPECT_TRUE(a.available) << a.message;
    EXPECT_TRUE(b.available) << b.message;
    EXPECT_EQ(a.times, b.times);
    double worst = 0;
    for (std::size_t k = 0; k < std::min(a.times.size(), b.times.size()); ++k) {
        worst = std::max(worst, std::abs(a.state[k] / b.state[k] - 1));
        worst = std::max(worst, std::abs(a.attitude[k] / b.attitude[k] - 1));
    }
    return worst;
}

// Spectral norm of ((1, x), (0, d)): the rate decays to d, and the body rotates by x per unit of the initial rate.
double shear_norm(double x, double d) {
    const double sum = 1 + x * x + d * d;
    return std::sqrt((sum + std::sqrt(sum * sum - 4 * d * d)) / 2);
}

// Sphere: w is constant; dtheta grows by dw t along w and by less across it. kappa = |((1, x), (0, 1))|, x = |w| t.
RC_GTEST_PROP(ConditioningOf, SphereIsTheClosedForm, ()) {
    Scene scene;
    scene.name = "sphere", scene.duration = moderate(0.1, 20);
    const double moment = moderate(0.1, 5);
    scene.body.inertia_B = diagonal(Vector3<double>(moment, moment, moment));
    scene.initial.angular_velocity = moderate_vector();
    scene.initial.orientation = moderate_orientation();
    RC_PRE(length(scene.initial.angular_velocity) > 1e-3);
    const Conditioning c = conditioning(scene, sample_times(scene.duration, 7));
    RC_ASSERT(c.available);
    for (std::size_t k = 0; k < c.times.size(); ++k) {
        const double x = length(scene.initial.angular_velocity) * c.times[k];
        RC_ASSERT(std::abs(c.state[k] / shear_norm(x, 1) - 1) < 1e-10);
        RC_ASSERT(std::abs(c.attitude[k] / std::hypot(1, x) - 1) < 1e-10);
    }
}

// With drag the rate decays at g = c / I: x = |w| (1 - e^-gt) / g. Over 10^4 decay times, solved by BDF.
TEST(ConditioningOf, DampedSphereIsTheClosedForm) {
    for (const auto& [drag, tolerance] : {std::pair(0.3, 1e-10), std::pair(5e3, 1e-6)}) {
        Scene scene;
        scene.name = "damped sphere", scene.duration = 10;
        scene.body.inertia_B = diagonal(Vector3<double>(2, 2, 2));
        scene.initial.angular_velocity = {0.3, -1.2, 0.4};
        scene.loads = {Drag{{drag, drag, drag}, 0, {}}};
        const double g = drag / 2, w = length(scene.initial.angular_velocity);
        const Conditioning c = conditioning(scene, sample_times(10, 10));
        ASSERT_TRUE(c.available) << c.message;
        EXPECT_EQ(c.message.find("backward") != std::string::npos, drag > 1000) << c.message;
        for (std::size_t k = 0; k < c.times.size(); ++k) {
            const double d = std::exp(-g * c.times[k]), x = w * (1 - d) / g;
            EXPECT_NEAR(c.state[k] / shear_norm(x, d), 1, tolerance);
            EXPECT_NEAR(c.attitude[k] / std::hypot(1, x), 1, tolerance);
        }
    }
}

// A body at rest: only the perturbation moves it, and the scale of the rate is 1 rad over the duration.
TEST(ConditioningOf, RestIsTheClosedForm) {
    const Scene scene = find_scene("at_rest");
    const Conditioning c = conditioning(scene, {0, scene.duration});
    ASSERT_TRUE(c.available) << c.message;
    EXPECT_NEAR(c.state[1], std::numbers::phi, 1e-12);
    EXPECT_NEAR(c.attitude[1], std::numbers::sqrt2, 1e-12);
}

// Central differences of the closed form: w rotates about the axis of symmetry at the rate (I3/I1 - 1) w3.
TEST(ConditioningOf, SymmetricBodyIsTheDerivativeOfItsClosedForm) {
    const Scene scene = symmetric_body(30);
    constexpr double step = 1e-5;
    const double scale = pose(scene).scales.angular_velocity;
    const auto rate = [](const Scene& s, double t) {
        const Vector3<double>& w = s.initial.angular_velocity;
        const double a = (s.body.inertia_B[2][2] / s.body.inertia_B[0][0] - 1) * w[2] * t;
        return Vector3<double>(w[0] * std::cos(a) - w[1] * std::sin(a), w[0] * std::sin(a) + w[1] * std::cos(a), w[2]);
    };
    const Conditioning c = conditioning(scene, sample_times(30, 12));
    ASSERT_TRUE(c.available) << c.message;
    for (std::size_t k = 0; k < c.times.size(); ++k) {
        const double t = c.times[k];
        Eigen::Matrix<double, 6, 6> S = Eigen::Matrix<double, 6, 6>::Zero();
        const Quaternion<double> q = symmetric_attitude(scene, t);
        for (int j = 0; j < 3; ++j) {
            // a rotation of the start is applied before everything else: dtheta(t) = R(t)^T dtheta(0)
            Vector3<double> e;
            e[j] = 1;
            const Vector3<double> turned = rotate_back(q, e);
            Scene above = scene, below = scene;
            above.initial.angular_velocity[j] += step, below.initial.angular_velocity[j] -= step;
            const Quaternion<double> d = conjugate(symmetric_attitude(below, t)) * symmetric_attitude(above, t);
            const Vector3<double> w = rate(above, t) - rate(below, t);
            const double sign = d.w < 0 ? -1 : 1;
            for (int i = 0; i < 3; ++i) {
                S(i, j) = turned[i];
                S(i, 3 + j) = sign * 2 * vector_part(d)[i] / (2 * step) * scale;
                S(3 + i, 3 + j) = w[i] / (2 * step);
            }
        }
        EXPECT_NEAR(c.state[k] / S.jacobiSvd().singularValues()[0], 1, 1e-7) << t;
        const Eigen::Matrix<double, 3, 6> attitude = S.topRows<3>();
        EXPECT_NEAR(c.attitude[k] / attitude.jacobiSvd().singularValues()[0], 1, 1e-7) << t;
    }
}

struct Against {
    const char* scene;
    double duration;
    double tolerance;  // kappa times the error of CVODES in binary64, with a margin
    double least_peak;
};
void PrintTo(const Against& a, std::ostream* out) { *out << a.scene; }

class ConditioningAgainstTaylor : public ::testing::TestWithParam<Against> {};
INSTANTIATE_TEST_SUITE_P(Scenes, ConditioningAgainstTaylor,
                         ::testing::Values(Against{"free_asymmetric", 40, 1e-10, 100},
                                           Against{"near_separatrix", 60, 1e-6, 6e6},
                                           Against{"separatrix", 28, 1e-6, 3e8},    // e^(t / sqrt 2)
                                           Against{"lagrange_top", 5, 1e-10, 100},  // gravity
                                           Against{"struck_bar", 10, 1e-10, 2000},  // impulses
                                           Against{"thrown_hammer", 1, 1e-9, 200},  // closed form of the flight
                                           Against{"every_load", 2, 1e-10, 5},      // windows, integrated flight
                                           Against{"damped_spin", 20, 1e-10, 20},
                                           Against{"attitude_regulator", 60, 1e-9, 5},
                                           Against{"towed_body", 10, 1e-10, 5}, Against{"chaotic_top", 50, 1e-6, 4e4}),
                         [](const auto& test) { return std::string(test.param.scene); });

TEST_P(ConditioningAgainstTaylor, Agrees) {
    const Against& against = GetParam();
    Scene scene = find_scene(against.scene);
    scene.duration = against.duration;
    const Problem problem = pose(scene);
    const std::vector<double> times = sample_times(scene.duration, 25);
    const Conditioning by_taylor = reference_conditioning(problem, times, 18);
    EXPECT_GT(by_taylor.state_peak().value, against.least_peak);
    EXPECT_LT(difference(conditioning(problem, times), by_taylor), against.tolerance) << by_taylor.message;
}

// Beyond 4000 rad kappa comes from differences of the closed form. At the same times it agrees with kappa from CVODES.
TEST(Conditioning, OfLongMotionsIsWhatItWasOfShortOnes) {
    for (const char* name : {"free_asymmetric", "lagrange_top", "symmetric", "thrown_hammer"}) {
        Scene scene = find_scene(name);
        const double radian = 1 / pose(scene).scales.angular_velocity;
        std::vector<double> times{0, 1 * radian, 50 * radian, 777 * radian, 1500 * radian};
        scene.duration = 6000 * radian;
        const Problem problem = pose(scene);
        const Conditioning by_steps = conditioning(problem, times);
        times.push_back(5000 * radian);
        Conditioning by_form = conditioning(problem, times);
        EXPECT_EQ(by_steps.message.find("closed form"), std::string::npos) << name;
        EXPECT_NE(by_form.message.find("closed form"), std::string::npos) << name << ": " << by_form.message;
        by_form.times.pop_back(), by_form.state.pop_back(), by_form.attitude.pop_back();
        EXPECT_LT(difference(by_steps, by_form), 1e-7) << name;
    }
}

TEST(Conditioning, AgreesWithTaylorUnderEveryLoad) {
    const Problem problem = pose(everything(1));
    const std::vector<double> times = sample_times(1, 20);
    EXPECT_LT(difference(conditioning(problem, times), reference_conditioning(problem, times, 18)), 1e-10);
}

// kappa from truths with perturbed starts, without derivatives of the equations. The perturbation is e = 1e-5 of each
// scale; third derivatives of the motion leave an error of (kappa e)^2 / 6, 1e-7 at kappa = 30.
TEST(Conditioning, IsTheFiniteDifferenceOfTheTruth) {
    const FreshCache cache;
    for (const Scene& scene : {free_body(3), heavy_top(0.5)}) {
        constexpr double e = 1e-5;
        const Problem problem = pose(scene);
        const double scale = problem.scales.angular_velocity;
        using Q = Quaternion<long double>;
        const auto wide = [](const Quaternion<Pair>& q) {
            const auto sum = [](const Pair& p) { return static_cast<long double>(p.high) + p.low; };
            return Q{sum(q.w), sum(q.x), sum(q.y), sum(q.z)};
        };
        Eigen::Matrix<double, 6, 6> S;
        for (int j = 0; j < 6; ++j) {
            ReferenceSample end[2];
            for (const int side : {0, 1}) {
                Scene moved = scene;
                const double change = side == 0 ? -e : e;
                if (j < 3) {
                    Quaternion<double> turn{std::cos(change / 2), 0, 0, 0};
                    (j == 0 ? turn.x : j == 1 ? turn.y : turn.z) = std::sin(change / 2);
                    moved.initial.orientation = scene.initial.orientation * turn;
                } else {
                    moved.initial.angular_velocity[j - 3] += change * scale;
                }
                const Reference truth = reference(moved, 1);
                ASSERT_TRUE(truth.available) << truth.message;
                end[side] = truth.samples.back();
            }
            Q d = conjugate(wide(end[0].q)) * wide(end[1].q);
            const long double sign = d.w < 0 ? -1 : 1;
            const long double turn[3] = {d.x, d.y, d.z};
            for (int i = 0; i < 3; ++i) {
                S(i, j) = static_cast<double>(sign * turn[i]) / e;
                const Pair &above = end[1].angular_velocity_B[i], &below = end[0].angular_velocity_B[i];
                S(3 + i, j) = ((above.high - below.high) + (above.low - below.low)) / (2 * e * scale);
            }
        }
        const Conditioning c = conditioning(problem, {scene.duration});
        EXPECT_NEAR(c.state[0] / S.jacobiSvd().singularValues()[0], 1, 1e-7) << scene.name;
        const Eigen::Matrix<double, 3, 6> attitude = S.topRows<3>();
        EXPECT_NEAR(c.attitude[0] / attitude.jacobiSvd().singularValues()[0], 1, 1e-7) << scene.name;
    }
}

// The derivative of a user-defined torque comes from differences. A torque equal to a load must have the same kappa.
TEST(Conditioning, OfAUserTorqueIsThatOfTheLoadItRestates) {
    Scene scene = free_body(10), by_user = scene;
    scene.loads = {Drag{{0.1, 0.2, 0.3}, 0, {}}};
    by_user.loads = {UserTorque{"drag",
                                [](const LoadState& now) {
                                    const Vector3<double>& w = now.angular_velocity_B;
                                    return Vector3<double>(-0.1 * w[0], -0.2 * w[1], -0.3 * w[2]);
                                },
                                {}}};
    const std::vector<double> times = sample_times(10, 10);
    EXPECT_LT(difference(conditioning(by_user, times), conditioning(scene, times)), 1e-8);
    by_user.loads = {UserTorque{
        "broken", [](const LoadState&) -> Vector3<double> { throw std::domain_error("no torque today"); }, {}}};
    EXPECT_THROW(conditioning(by_user, times), std::domain_error);
}

TEST(Conditioning, DoesNotDependOnTheSystemPosed) {
    const std::vector<double> times = sample_times(1, 10);
    const Scene scene = everything(1);
    const Conditioning reduced = conditioning(pose(scene), times);
    EXPECT_EQ(conditioning(pose(scene, Formulation::full), times).state, reduced.state);
    EXPECT_EQ(conditioning(scene, times).attitude, reduced.attitude);
}

TEST(Conditioning, HasTheSameBitsEveryTime) {
    const Scene scene = find_scene("chaotic_top");
    const std::vector<double> times = sample_times(scene.duration, 50);
    const Conditioning once = conditioning(scene, times), again = conditioning(scene, times);
    EXPECT_EQ(once.state, again.state);
    EXPECT_EQ(once.attitude, again.attitude);
    EXPECT_EQ(once.steps, again.steps);
}

TEST(Conditioning, ShowsTheMotionAfterAnEventAndGoesOnBeyondTheDuration) {
    Scene scene = free_body(2);
    scene.loads = {Impulse{{3, 0, 0}, Frame::world, {0, 1, 0}, Frame::body, 1.0}};
    const Conditioning c = conditioning(scene, {0, std::nextafter(1.0, 0.0), 1, 2, 3});
    ASSERT_TRUE(c.available) << c.message;
    EXPECT_EQ(c.times.back(), 3);
    EXPECT_GT(std::abs(c.state[2] / c.state[1] - 1), 1e-3);  // the impulse rotates with the attitude
    const std::vector<double> times{0, 1, 2, 3};
    scene.duration = 3;
    EXPECT_LT(difference(conditioning(scene, times), reference_conditioning(pose(scene), times, 18)), 1e-10);
}

TEST(Conditioning, ReportsWhereItEnds) {
    const Scene scene = free_body(100);
    ConditioningSettings settings;
    settings.max_steps = 500;
    const Conditioning c = conditioning(scene, sample_times(100, 100), settings);
    EXPECT_FALSE(c.available);
    EXPECT_NE(c.message.find("limit of 500 steps"), std::string::npos) << c.message;
    ASSERT_GT(c.times.size(), 3u);
    ASSERT_LT(c.times.size(), 100u);
    const Conditioning whole = conditioning(scene, sample_times(100, 100));
    EXPECT_EQ(c.state.back(), whole.state[c.times.size() - 1]);
    for (const std::vector<double>& times :
         {std::vector<double>{}, {-1}, {1, 0.5}, {std::nan("")}, {std::numeric_limits<double>::infinity()}})
        EXPECT_THROW(conditioning(scene, times), std::invalid_argument);
    EXPECT_THROW(conditioning(pose(scene), {101}), std::invalid_argument);
}

// On the separatrix kappa grows as e^(t / sqrt 2) and exceeds 2^53 at about t = 52 s. The message reports it.
TEST(Conditioning, ReportsWhereBinary64IsInsufficient) {
    Scene scene = find_scene("separatrix");
    scene.duration = 70;
    const Conditioning c = conditioning(scene, sample_times(70, 70));
    ASSERT_TRUE(c.available) << c.message;
    EXPECT_NE(c.message.find("binary64 cannot follow"), std::string::npos) << c.message;
    scene.duration = 40;
    const Conditioning shorter = conditioning(scene, sample_times(40, 40));
    EXPECT_EQ(shorter.message.find("cannot follow"), std::string::npos) << shorter.message;
}

// With enough digits reference_conditioning() follows this growth further.
TEST(Conditioning, ReferenceFollowsTheSeparatrixBeyondBinary64) {
    Scene scene = find_scene("separatrix");
    scene.duration = 60;
    const Conditioning c = reference_conditioning(pose(scene), {50, 60}, 40);
    ASSERT_TRUE(c.available) << c.message;
    EXPECT_GT(c.state[1], 0x1p53);
    EXPECT_NEAR(c.state[1] / c.state[0], std::exp(10 / std::numbers::sqrt2), 1e-6 * std::exp(10 / std::numbers::sqrt2));
}

TEST(Conditioning, FloorsAreKappaTimesTheRoundoff) {
    Conditioning c;
    c.times = {0, 1, 2}, c.state = {1, 9, 4}, c.attitude = {1, 8, 1e9};
    EXPECT_EQ(c.floor(1, float64_roundoff), 8 * 0x1p-53);
    EXPECT_EQ(c.floor(1, float32_roundoff), 8 * 0x1p-24);
    EXPECT_EQ(c.floor_peak(float32_roundoff).value, std::numbers::pi);  // the largest possible attitude error
    EXPECT_EQ(c.floor_peak(float32_roundoff).time, 2);
    EXPECT_EQ(c.state_peak().value, 9);
    EXPECT_EQ(c.state_peak().time, 1);
    EXPECT_EQ(Conditioning().state_peak().value, 0);
}

// GCC 12.2 at -O2 miscompiles the conversion of two doubles to float and back: its vectoriser drops both conversions.
double rounded_to_float(double value) {
    volatile float narrow = static_cast<float>(value);
    return static_cast<double>(narrow);
}

// Rounding the start to binary32 changes the attitude by at most twice the floor, and for some start by a good part.
TEST(Conditioning, Float32FloorIsWhatRoundingTheStartDoes) {
    const FreshCache cache;
    double largest = 0;
    for (const double w : {0.9137, 1.0291, 1.1733, 1.3719}) {
        Scene scene = find_scene("free_asymmetric");
        scene.duration = 10;
        scene.initial.angular_velocity = w * scene.initial.angular_velocity;
        Scene rounded = scene;
        for (int i = 0; i < 3; ++i)
            rounded.initial.angular_velocity[i] = rounded_to_float(scene.initial.angular_velocity[i]);
        const Reference exact = reference(scene, 20), moved = reference(rounded, 20);
        const Conditioning c = conditioning(scene, sample_times(10, 20));
        for (std::size_t k = 0; k <= 20; ++k) {
            const Quaternion<Pair>&a = exact.samples[k].q, &b = moved.samples[k].q;
            const double error = testing::attitude_error(Quaternion<double>{a.w.high, a.x.high, a.y.high, a.z.high},
                                                         Quaternion<double>{b.w.high, b.x.high, b.y.high, b.z.high});
            const double share = error / c.floor(k, float32_roundoff);
            EXPECT_LT(share, 2);
            if (k > 0) largest = std::max(largest, share);
        }
    }
    EXPECT_GT(largest, 0.05);
}

RC_GTEST_PROP(Conditioning, IsOneAtTheStart, ()) {
    const Conditioning c = conditioning(moderate_scene(), {0});
    RC_ASSERT(c.available);
    RC_ASSERT(std::abs(c.state[0] - 1) < 1e-14);
    RC_ASSERT(std::abs(c.attitude[0] - 1) < 1e-14);
}

// Invariance under scaling of time and mass: twice as fast for half the duration with matching forces, or twice as
// heavy with twice the forces. Scaling by powers of two gives identical numbers except for the exponentials of drag.
RC_GTEST_PROP(Conditioning, HasNoUnits, ()) {
    Scene scene = moderate_scene();
    scene.loads.clear();
    if (!scene.pivot) scene.initial.position_W = scene.initial.velocity_W = {};
    Scene fast = scene, heavy = scene;
    fast.duration = scene.duration / 4;
    fast.initial.angular_velocity = 4.0 * scene.initial.angular_velocity;
    heavy.body.mass = 8 * scene.body.mass;
    for (int i = 0; i < 3; ++i) heavy.body.inertia_B[i] = 8.0 * scene.body.inertia_B[i];
    if (scene.pivot) {
        const Vector3<double> g = moderate_vector();
        scene.loads = {Gravity{g, {}}}, heavy.loads = scene.loads, fast.loads = {Gravity{16.0 * g, {}}};
    }
    const std::vector<double> times = sample_times(scene.duration, 4);
    const Conditioning c = conditioning(scene, times);
    RC_ASSERT(difference(conditioning(heavy, times), c) < 1e-11);
    Conditioning faster = conditioning(fast, sample_times(fast.duration, 4));
    faster.times = times;
    RC_ASSERT(difference(faster, c) < 1e-11);
}

// Rotating the world together with start, forces and impulses leaves kappa unchanged.
RC_GTEST_PROP(Conditioning, DoesNotDependOnTheWorldsAxes, ()) {
    Scene scene;
    scene.name = "any", scene.duration = 2;
    scene.body.inertia_B = testing::moderate_inertia();
    scene.initial.orientation = moderate_orientation();
    scene.initial.angular_velocity = moderate_vector();
    scene.initial.position_W = moderate_vector(), scene.initial.velocity_W = moderate_vector();
    const Vector3<double> field = moderate_vector(), kick = moderate_vector(), arm = moderate_vector();
    const Quaternion<double> rest = moderate_orientation();
    const auto loads = [&](const Quaternion<double>& r) {
        return std::vector<Load>{Gravity{rotate(r, field), {}}, Torque{rotate(r, kick), Frame::world, {0.5, 1.5}},
                                 Force{rotate(r, field), Frame::world, arm, Frame::body, {}},
                                 Impulse{rotate(r, kick), Frame::world, arm, Frame::body, 0.75},
                                 Spring{1.5, r * rest, {}}};
    };
    Scene turned = scene;
    const Quaternion<double> r = moderate_orientation();
    turned.initial.orientation = r * scene.initial.orientation;
    turned.initial.position_W = rotate(r, scene.initial.position_W);
    turned.initial.velocity_W = rotate(r, scene.initial.velocity_W);
    scene.loads = loads({}), turned.loads = loads(r);
    // the scales, the units of the blocks, are estimates to three digits
    const Problem problem = pose(scene);
    Problem other = pose(turned);
    RC_ASSERT(std::abs(other.scales.angular_velocity / problem.scales.angular_velocity - 1) < 0.05);
    other.scales = problem.scales;
    const std::vector<double> times = sample_times(2, 4);
    RC_ASSERT(difference(conditioning(other, times), conditioning(problem, times)) < 1e-9);
}

}  // namespace
}  // namespace polhode
