// The extreme scenes. Each has a truth, and the method that `auto` selects reaches it. Each family has the property
// in its name, by independent formulas.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "build_kind.h"
#include "catalogue.h"
#include "integrators/analysis/conditioning.h"
#include "integrators/method.h"
#include "integrators/series/linear_algebra.h"
#include "measure/errors.h"
#include "motion/dual.h"
#include "motion/systems.h"
#include "whole/truth_values.h"

namespace polhode {
namespace {

using std::numbers::pi;

struct Member {
    double parameter;
    Scene scene;
    Problem problem;
};

// every member of a family, with its parameter
std::vector<Member> members(const std::string& family) {
    std::vector<Member> all;
    for (const std::string& name : scene_family("extreme", family)) {
        const Scene scene = find_scene(name);
        all.push_back({family_member(name).value, scene, pose(scene)});
    }
    EXPECT_GE(all.size(), 3u) << family;
    return all;
}

// the truth at given times
std::vector<ReferenceSample> truth_at(const Scene& scene, std::vector<double> times) {
    const FreshCache cache;
    times.insert(times.begin(), 0);
    const Reference truth = reference(scene, times);
    EXPECT_TRUE(truth.available) << scene.name << ": " << truth.message;
    return truth.available ? truth.samples : std::vector<ReferenceSample>(times.size());
}
Vector3<double> w_B(const ReferenceSample& sample) {
    return {sample.angular_velocity_B[0].high, sample.angular_velocity_B[1].high, sample.angular_velocity_B[2].high};
}
Vector3<double> L_W(const ReferenceSample& sample) {
    return {sample.angular_momentum_W[0].high, sample.angular_momentum_W[1].high, sample.angular_momentum_W[2].high};
}
Quaternion<double> attitude(const ReferenceSample& sample) {
    return {sample.q.w.high, sample.q.x.high, sample.q.y.high, sample.q.z.high};
}
double rotation_angle_of(const Quaternion<double>& q) { return 2 * std::atan2(size(vector_part(q)), std::abs(q.w)); }

// The magnitudes of the eigenvalues of the right-hand side for w and q at this state, in descending order.
std::vector<double> sizes_of_eigenvalues(const Problem& problem, const Vector3<double>& w, const Quaternion<double>& q,
                                         std::size_t segment = 0) {
    double y[7], J[49];
    put(y, 0, w), put(y, 3, q);
    jacobian(LoadedRotation(problem, problem.segments[segment]), 0, y, J);
    const Eigen::Matrix<double, 7, 7> matrix = Eigen::Map<Eigen::Matrix<double, 7, 7, Eigen::RowMajor>>(J);
    const auto values = matrix.eigenvalues();
    std::vector<double> sizes;
    for (int i = 0; i < 7; ++i) sizes.push_back(std::abs(values[i]));
    std::sort(sizes.rbegin(), sizes.rend());
    return sizes;
}

// ---- every scene

class Extreme : public ::testing::TestWithParam<std::string> {};

// The truth has 25 digits, and `auto` at tolerance 1e-10 has an attitude error below 1e-8 times the condition number.
// Where the truth needs a Taylor series, only the start of the motion is compared, to limit the run time to seconds.
TEST_P(Extreme, HasATruthThatAutoFinds) {
    Scene scene = find_scene(GetParam());
    const Problem whole = pose(scene);
    const double turn = whole.scales.angular_velocity * scene.duration;
    if (truth_method(whole) == "Taylor series" && whole.segments.size() == 1)
        scene.duration *= std::min(0.2, 40 / turn);
    const Problem problem = pose(scene);
    const Reference truth = fresh_truth(scene, 10);
    ASSERT_TRUE(truth.available) << truth.message;
    Settings settings;
    settings.samples = 10;
    const Choice best = choose_method(problem);
    if (takes_tolerance(*best.method)) settings.tolerance = 1e-10;
    const Trajectory run = solve(problem, *best.method, settings);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    ASSERT_EQ(run.samples.size(), truth.samples.size());
    const Conditioning kappa = conditioning(scene, {0, scene.duration / 2, scene.duration});
    const double growth = kappa.available ? kappa.state_peak().value : 1;
    for (std::size_t k = 0; k < run.samples.size(); ++k) {
        const Sample& s = run.samples[k];
        EXPECT_TRUE(std::isfinite(size(s.angular_velocity_B))) << s.t;
        EXPECT_LT(attitude_error(s.q, truth.samples[k].q), 1e-8 * std::max(1.0, growth)) << s.t;
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Extreme, ::testing::ValuesIn([] {
                             // all scenes in optimised builds
                             const std::vector<std::string> all = scenes_in("extreme");
                             std::vector<std::string> some;
                             for (std::size_t i = 0; i < all.size(); i += optimised_build ? 1 : 20)
                                 some.push_back(all[i]);
                             return some;
                         }()),
                         [](const auto& tested) { return test_name(tested.param); });

TEST(ExtremeScenes, AreManyInFamilies) {
    EXPECT_GE(scenes_in("extreme").size(), 60u);
    for (const std::string& name : scenes_in("extreme")) EXPECT_NE(family_member(name).parameter, "") << name;
}

// ---- stiff

// dw/dt = -c w / I1, and the angle is 1 - exp(-c t).
TEST(ExtremeScenes, DragIsTheLinearTestEquation) {
    for (const auto& [c, scene, problem] : members("drag")) {
        ASSERT_EQ(problem.needs.system, SystemKind::principal_axis_rotation);
        const AxisEquations<double>& system = problem.segments[0].about_axis;
        EXPECT_DOUBLE_EQ(system.inverse_moment * system.damping, c);
        EXPECT_EQ(system.cc, 0);
        EXPECT_EQ(system.cs, 0);
        EXPECT_EQ(system.ss, 0);
        EXPECT_NEAR(c * scene.duration, 1000, 1e-9);
        const ReferenceSample after = truth_at(scene, {2 / c})[1];
        EXPECT_NEAR(w_B(after)[0] / c, std::exp(-2), 1e-15);
        EXPECT_NEAR(rotation_angle_of(attitude(after)), 1 - std::exp(-2), 1e-15);
    }
}

TEST(ExtremeScenes, DragWithTorqueIsStiffAndSteadyInTheEnd) {
    for (const auto& [c, scene, problem] : members("drag_torque")) {
        EXPECT_NEAR(sizes_of_eigenvalues(problem, {}, {})[0], c, 1e-9 * c);
        if (c < 100) continue;
        // to first order in 1/c: w = torque / c
        const Vector3<double> w = w_B(truth_at(scene, {scene.duration})[1]);
        EXPECT_LT(size(w - Vector3<double>(2.0 / 7, 3.0 / 7, 6.0 / 7)), 1 / c);
    }
}

// A pendulum I x'' = -k sin x with amplitude a has the period 4 K(sin a/2) / sqrt(k/I).
TEST(ExtremeScenes, SpringIsAPendulumOfSmallAmplitude) {
    for (const auto& [k, scene, problem] : members("spring")) {
        ASSERT_EQ(problem.needs.system, SystemKind::principal_axis_rotation);
        const AxisEquations<double>& system = problem.segments[0].about_axis;
        // the spring's torque -2 k s c linearises to -k x
        EXPECT_DOUBLE_EQ(-system.cs / 2 * system.inverse_moment, k);
        const double rate = std::sqrt(k), sine = scene.initial.angular_velocity[0] / (2 * rate);
        const double period = 4 * boost::math::ellint_1(sine) / rate;
        EXPECT_LT(std::abs(period * rate / (2 * pi) - 1), 1e-4);
        const auto samples = truth_at(scene, {period / 4, period});
        EXPECT_NEAR(rotation_angle_of(attitude(samples[1])), 2 * std::asin(sine), 1e-14);
        EXPECT_LT(rotation_angle_of(attitude(samples[2])), 1e-15);
        EXPECT_NEAR(scene.duration * rate, 1000, 5);
    }
}

// I x'' + c x' + k x = 0 about each axis.
TEST(ExtremeScenes, DampedSpringsHaveTheirRatio) {
    for (const auto& [ratio, scene, problem] : members("spring_damped")) {
        std::vector<double> expected{0};
        for (const double rate : {100.0, 100 / 1.2, 100 / 1.5})
            for (const int sign : {1, -1})
                expected.push_back(ratio <= 1 ? rate : rate * (ratio + sign * std::sqrt(ratio * ratio - 1)));
        std::sort(expected.rbegin(), expected.rend());
        const std::vector<double> found = sizes_of_eigenvalues(problem, {}, {});
        // a double eigenvalue is determined only to the square root of the rounding error
        for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(found[i], expected[i], 1e-4 * expected[0]) << ratio << i;
        EXPECT_NEAR(rotation_angle_of(scene.initial.orientation), 0.5, 1e-15);
    }
}

TEST(ExtremeScenes, SpringsThatHoldAHeavyBodyAreStiffBesideIt) {
    for (const auto& [k, scene, problem] : members("spring_gravity")) {
        EXPECT_TRUE(problem.body.pivoted);
        // gravity changes the torque by at most m g l = 5 N m per radian
        const double fastest = sizes_of_eigenvalues(problem, {}, {})[0];
        EXPECT_NEAR(fastest * fastest / k, 1, 5 / k + 1e-9);
    }
}

// At rest the spring balances the disturbance: k sin(angle) = |torque|.
TEST(ExtremeScenes, AttitudeIsHeldAgainstTheDisturbance) {
    for (const auto& [k, scene, problem] : members("pd_hold")) {
        const double disturbance = size(std::get<Torque>(scene.loads[2]).vector);
        const ReferenceSample end = truth_at(scene, {scene.duration})[1];
        EXPECT_NEAR(std::sin(rotation_angle_of(attitude(end))), disturbance / k, 1e-12);
        EXPECT_LT(size(w_B(end)), 1e-12 * problem.scales.angular_velocity);
    }
}

// The precession rate is m g l / (I3 w3), averaged over the nutations, to first order in its squared ratio to the spin.
TEST(ExtremeScenes, FastTopsPrecessSlowly) {
    for (const auto& [spin, scene, problem] : members("fast_top")) {
        EXPECT_EQ(scene.initial.angular_velocity[2], spin);
        if (spin < 100) continue;
        // after whole nutations, each of which lasts 2 pi I1 / (I3 w3)
        const double time = 40 * 2 * pi / (0.5 * spin);
        const auto samples = truth_at(scene, {time});
        const auto azimuth = [](const ReferenceSample& s) {
            const Vector3<double> axis = rotate(attitude(s), Vector3<double>(0, 0, 1));
            return std::atan2(axis[1], axis[0]);
        };
        EXPECT_NEAR(azimuth(samples[1]) - azimuth(samples[0]), 10 / spin * time, 0.01 * 10 / spin * time) << spin;
    }
}

TEST(ExtremeScenes, TwoDragsAreFarApart) {
    for (const auto& [ratio, scene, problem] : members("two_drags")) {
        const std::vector<double> found = sizes_of_eigenvalues(problem, {}, {});
        EXPECT_NEAR(found[0], ratio / 3, 1e-6 * ratio);
        EXPECT_NEAR(found[1], std::sqrt(ratio) / 2, 1e-3 * std::sqrt(ratio));
    }
}

// |L| changes by at most torque times time.
TEST(ExtremeScenes, WeakTorquesHardlyChangeTheSpin) {
    for (const auto& [torque, scene, problem] : members("weak_torque")) {
        const auto samples = truth_at(scene, {0.01});
        const double change = size(L_W(samples[1]) - L_W(samples[0]));
        EXPECT_LE(change, 1.0001 * std::sqrt(6.0) * torque * 0.01 + 1e-12);
        EXPECT_GT(problem.scales.angular_velocity, 999);
    }
}

TEST(ExtremeScenes, DragActsInItsWindow) {
    for (const auto& [c, scene, problem] : members("drag_window")) {
        ASSERT_EQ(problem.segments.size(), 3u);
        for (const std::size_t i : {0, 1, 2}) EXPECT_EQ(problem.segments[i].forcing.has_damping, i == 1);
        EXPECT_NEAR(sizes_of_eigenvalues(problem, {}, {}, 1)[0], c, 1e-9 * c);
        // after 10 decay times of the slowest axis w equals the torque divided by the drag
        const double time = 0.75 + 30 / c;
        const ReferenceSample braked = truth_at(scene, {time})[1];
        EXPECT_LT(size(w_B(braked) - (1 / c) * Vector3<double>(0.3, 0.2, 0.1)), 1e-3 * 4 + 10 / (c * c)) << c;
    }
}

// ---- extreme

TEST(ExtremeScenes, MomentsMatchTheirNames) {
    const auto sorted = [](const Problem& problem) {
        Vector3<double> I = problem.body.principal.moments;
        std::sort(&I[0], &I[0] + 3);
        return I;
    };
    for (const auto& [ratio, scene, problem] : members("needle")) {
        const Vector3<double> I = sorted(problem);
        EXPECT_EQ(I[1] / I[0], ratio);
        EXPECT_GT(I[2], I[1]);
        EXPECT_LE(I[2] - I[1], I[0]) << "the triangle inequality";
    }
    for (const auto& [ratio, scene, problem] : members("plate")) {
        const Vector3<double> I = sorted(problem);
        EXPECT_EQ(I[1] / I[0], ratio);
        EXPECT_EQ(I[2] - I[1], I[0]) << "flat";
    }
    for (const auto& [part, scene, problem] : members("near_equal")) {
        const Vector3<double> I = sorted(problem);
        EXPECT_NEAR((I[1] - I[0]) / I[0], part, 2.3e-16);
        EXPECT_NEAR((I[2] - I[1]) / I[0], part, 2.3e-16);
        EXPECT_EQ(problem.needs.symmetry, Symmetry::asymmetric);
    }
    for (const auto& [part, scene, problem] : members("flat")) {
        const Vector3<double> I = sorted(problem);
        EXPECT_NEAR((I[0] + I[1] - I[2]) / I[2], part, 3e-16);
    }
    for (const auto& [moment, scene, problem] : members("moment")) EXPECT_EQ(sorted(problem)[0], moment);
}

TEST(ExtremeScenes, RatesMatchTheirNames) {
    for (const auto& [rate, scene, problem] : members("free_spin"))
        EXPECT_NEAR(size(scene.initial.angular_velocity) / rate, 1, 1e-13);
    for (const auto& [rate, scene, problem] : members("rate")) EXPECT_EQ(scene.initial.angular_velocity[0], rate);
    for (const auto& [turns, scene, problem] : members("revolutions")) {
        EXPECT_EQ(truth_method(problem), "closed form");
        EXPECT_NEAR(size(scene.initial.angular_velocity) * scene.duration / (2 * pi * turns), 1, 0.02);
    }
}

// Scaling mass, moments or time does not change the motion.
TEST(ExtremeScenes, UnitsDoNotMatter) {
    std::vector<ReferenceSample> first;
    for (const auto& [mass, scene, problem] : members("mass")) {
        EXPECT_EQ(scene.body.mass, mass);
        const auto samples = truth_at(scene, {1});
        if (first.empty()) first = samples;
        EXPECT_LT(attitude_error(attitude(samples[1]), first[1].q), 1e-14) << mass;
    }
    Scene unit = find_scene("extreme/moment_1e150");
    unit.body.inertia_B = diagonal(Vector3<double>(1, 2, 3));
    const std::vector<ReferenceSample> expected = truth_at(unit, {10});
    for (const auto& [moment, scene, problem] : members("moment"))
        EXPECT_LT(attitude_error(attitude(truth_at(scene, {10})[1]), expected[1].q), 1e-13) << moment;
    for (const auto& [rate, scene, problem] : members("rate"))
        EXPECT_LT(attitude_error(attitude(truth_at(scene, {10 / rate})[1]), expected[1].q), 1e-13) << rate;
}

// On the separatrix I1 (I2 - I1) w1^2 = I3 (I3 - I2) w3^2.
TEST(ExtremeScenes, SeparatrixIsAtItsDistance) {
    for (const auto& [distance, scene, problem] : members("separatrix")) {
        const Vector3<double>& w = scene.initial.angular_velocity;
        const Real100 off = Real100(1) - Real100(6 * 2) * Real100(w[2]) * Real100(w[2]) /
                                             (Real100(3 * 1) * Real100(w[0]) * Real100(w[0]));
        EXPECT_NEAR((off / 2).convert_to<double>() / distance, 1, 0.12) << distance;
    }
}

// Starting at the middle axis with a disturbance p in w1 and w3, w2 first vanishes after about ln(4/p) / 0.577 s.
TEST(ExtremeScenes, MiddleAxisTurnsOverWhenItShould) {
    for (const auto& [p, scene, problem] : members("middle_axis")) {
        EXPECT_EQ(scene.initial.angular_velocity[0], p);
        const double flip = std::log(4 / p) * std::sqrt(3.0);
        EXPECT_GT(scene.duration, flip);
        if (p < 1e-100 && !optimised_build) continue;
        const auto samples = truth_at(scene, {flip - 4, flip + 4});
        EXPECT_GT(w_B(samples[1])[1], 0) << p;
        EXPECT_LT(w_B(samples[2])[1], 0) << p;
    }
}

// A top released at tilt a falls to tilt b with cos b = l - sqrt(l^2 - 2 l cos a + 1), where
// l = (I3 w3)^2 / (4 I1 m g l) (F. Klein and A. Sommerfeld 1897).
TEST(ExtremeScenes, SleepingTopsFallAsFarAsTheyMust) {
    for (const auto& [ratio, scene, problem] : members("sleeping")) {
        const double l = ratio * ratio, a = 0.001;
        const double spin = 0.5 * scene.initial.angular_velocity[2];
        EXPECT_NEAR(spin * spin / 16, l, 1e-15);
        const double b = std::acos(l - std::sqrt((l - 1) * (l - 1) + 4 * l * std::sin(a / 2) * std::sin(a / 2)));
        double farthest = 0;
        std::vector<double> times;
        for (int k = 1; k <= 500; ++k) times.push_back(scene.duration * k / 500);
        for (const ReferenceSample& s : truth_at(scene, times)) {
            const Quaternion<double> q = attitude(s);
            farthest = std::max(farthest, 2 * std::asin(std::hypot(q.x, q.y)));
        }
        EXPECT_LT(farthest, b * (1 + 1e-9)) << ratio;
        EXPECT_GT(farthest, 0.98 * b) << ratio;
    }
}

// After a quarter rotation the body's x axis passes the vertical at the given distance.
TEST(ExtremeScenes, GimbalLockIsPassedAtItsDistance) {
    for (const auto& [distance, scene, problem] : members("gimbal_lock")) {
        const Vector3<double> x = rotate(attitude(truth_at(scene, {pi / 2})[1]), Vector3<double>(1, 0, 0));
        EXPECT_NEAR(std::hypot(x[0], x[1]), std::sin(distance), 5e-16);
        EXPECT_LT(x[2], -0.999);
    }
}

TEST(ExtremeScenes, RestIsRest) {
    for (const auto& [stiffness, scene, problem] : members("rest")) {
        const auto samples = truth_at(scene, {scene.duration / 3, scene.duration});
        for (const ReferenceSample& s : samples) {
            EXPECT_EQ(size(w_B(s)), 0) << stiffness;
            EXPECT_EQ(rotation_angle_of(attitude(s)), 0) << stiffness;
        }
    }
}

// angle'' = 5 sin(angle), from rest.
TEST(ExtremeScenes, UprightPendulumsFallExponentially) {
    for (const auto& [tilt, scene, problem] : members("upright")) {
        ASSERT_EQ(problem.needs.system, SystemKind::principal_axis_rotation);
        const double angle = rotation_angle_of(attitude(truth_at(scene, {2})[1]));
        EXPECT_NEAR(angle, tilt * std::cosh(2 * std::sqrt(5.0)), 1e-4 * tilt) << tilt;
    }
}

// A step covers whole rotations plus a thousandth of one, up to a nutation of 6e-5 rad.
TEST(ExtremeScenes, WholeTurnsAStepLookLikeACreep) {
    for (const auto& [turns, scene, problem] : members("turns_per_step")) {
        EXPECT_NEAR(scene.initial.angular_velocity[2] * scene.duration / 1e4 / (2 * pi), turns + 1e-3, 1e-9);
        const ReferenceSample step = truth_at(scene, {scene.duration / 1e4})[1];
        EXPECT_NEAR(rotation_angle_of(attitude(step)), 2 * pi * 1e-3, 3e-4) << turns;
    }
}

// The torque over its window equals an impulse of (1/2, -1/4, 1/4) N m s in body axes, which rotate meanwhile.
TEST(ExtremeScenes, ShortWindowsAreImpulses) {
    for (const auto& [length, scene, problem] : members("short_window")) {
        ASSERT_EQ(problem.segments.size(), 3u);
        const Segment& window = problem.segments[1];
        EXPECT_NEAR((window.end - window.begin) / length, 1, 1e-3);
        EXPECT_LT(window.end - window.begin, scene.duration / 1e4);
        const auto samples = truth_at(scene, {window.begin, window.end});
        const Vector3<double> gained =
            rotate_back(attitude(samples[1]), Vector3<double>(L_W(samples[2]) - L_W(samples[1])));
        EXPECT_LT(size(gained - Vector3<double>(0.5, -0.25, 0.25)), 2 * length + 1e-3) << length;
    }
}

TEST(ExtremeScenes, BangBangTorquesSwitchAsOften) {
    for (const auto& [number, scene, problem] : members("bang_bang")) {
        EXPECT_EQ(problem.segments.size(), static_cast<std::size_t>(number));
        for (std::size_t i = 1; i < problem.segments.size(); ++i)
            EXPECT_GT(size(problem.segments[i].forcing.torque - problem.segments[i - 1].forcing.torque), 1);
    }
}

}  // namespace
}  // namespace polhode
