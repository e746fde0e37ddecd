// Friction and limits of joints: the reference solution and the method taylor against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "integrators/contact/box_forces.h"
#include "integrators/method.h"
#include "integrators/series/real.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"
#include "integrators/truth/shared.h"
#include "motion/massless.h"
#include "motion/problem.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

using massless::body_of, massless::joint_of, massless::scene_of;
using Exact = Real<50>;

Scene slider(double mass, double duration) {
    Scene scene = scene_of("slider", duration);
    scene.bodies = {body_of("block", mass, {1, 1, 1})};
    scene.joints = {joint_of("rail", JointType::prismatic, "world", "block", {1, 0, 0})};
    return scene;
}

double solve_end(const Scene& scene, double tolerance = 1e-12) {
    Settings settings;
    settings.samples = 1, settings.tolerance = tolerance;
    const Trajectory run = solve(pose(scene), *find_method("taylor"), settings);
    EXPECT_EQ(run.status, Status::ok) << run.message;
    return run.samples.back().position_W[0];
}

// m x'' = -k x - F sign(x'): the turning points are (-1)^n (x0 - 2 n F / k), at n pi sqrt(m / k). The block stops where
// k |x| <= F.
TEST(JointFriction, OscillatorFollowsTheClosedFormTo25Digits) {
    const FreshCache cache;
    Scene scene = slider(2, 7);
    scene.joints[0].stiffness[0] = 8, scene.joints[0].friction = 0.5;
    scene.joints[0].coordinate[0] = 0.5;
    // turning points 0.5, -0.375, 0.25, -0.125, and 0 is in the interval of sticking |x| <= 1/16
    const DecimalReference truth = decimal_reference(scene, 28, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    EXPECT_LE(truth.bound, 1e-25);
    for (std::size_t i = 0; i < truth.times.size(); ++i) {
        // x = c + (x_n - c) cos(w t) with c = +-F/k against the motion; w = 2
        const Exact t(truth.times[i]), half = acos(Exact(-1)) / 2;
        const int n = std::min(4, static_cast<int>(truth.times[i] / static_cast<double>(half)));
        const Exact turning = (n % 2 ? -1 : 1) * (Exact(0.5) - n * Exact(0.125));
        const Exact center = (n % 2 ? -1 : 1) * Exact(0.0625);
        const Exact x = n == 4 ? turning : center + (turning - center) * cos(Exact(2 * (t - n * half)));
        EXPECT_LT(abs(Exact(Exact(truth.columns[i][7]) - x)), 1e-24) << truth.times[i];
    }
    EXPECT_NEAR(solve_end(scene), 0, 1e-11);
    // the rigid law needs events: methods without them refuse the scene
    EXPECT_NE(refusal(*find_method("odeint_dopri5"), pose(scene)).find("friction"), std::string::npos);
}

// The turning points of a pendulum with dry friction: m g l (cos a' - cos a) = F (a + a'). It stops where
// m g l sin |a| <= F.
TEST(JointFriction, PendulumStopsWhereTheEnergyBalanceEnds) {
    const FreshCache cache;
    constexpr double m = 1.5, g = 9.75, l = 0.5, F = 0.75, start = 1.25;
    Scene scene = scene_of("pendulum", 12);
    scene.bodies = {body_of("arm", m, {}, {0, 0, -l})};
    scene.joints = {joint_of("hinge", JointType::revolute, "world", "arm")};
    scene.joints[0].friction = F, scene.joints[0].coordinate[0] = start;
    scene.loads = {Gravity{{0, 0, -g}, {}}};
    const Exact weight = Exact(m) * g * l;
    Exact a(start);
    int swings = 0;
    while (weight * sin(a) > Exact(F)) {
        Exact next = a - 2 * Exact(F) / weight;
        for (int i = 0; i < 60; ++i)
            next -= (weight * (cos(next) - cos(a)) - F * (a + next)) / (-weight * sin(next) - F);
        a = next, ++swings;
    }
    ASSERT_GE(swings, 4);
    const DecimalReference truth = decimal_reference(scene, 2, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    const Exact angle = 2 * asin(Exact(truth.columns.back()[2]));
    EXPECT_LT(abs(Exact(angle - (swings % 2 ? -a : a))), 1e-24) << swings;
    EXPECT_LT(abs(Exact(truth.columns.back()[5])), 1e-24);
    Settings settings;
    settings.samples = 1, settings.tolerance = 1e-12;
    const Trajectory run = solve(pose(scene), *find_method("taylor"), settings);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    EXPECT_NEAR(2 * std::asin(run.samples.back().q.y), static_cast<double>(angle), 1e-10);
}

// A ball that falls onto a limit: impacts at known times; it rests at sqrt(2 h / g) (1 + e) / (1 - e).
TEST(JointLimits, BouncingBlockAccumulatesAndRests) {
    const FreshCache cache;
    constexpr double g = 2, e = 0.5;
    Scene scene = slider(1.5, 4);
    scene.joints[0].limits = {0.25, std::numeric_limits<double>::infinity(), e};
    scene.joints[0].coordinate[0] = 1.25;
    scene.loads = {Gravity{{-g, 0, 0}, {}}};
    // falls for 1 s; flights of 1 s, 0.5 s, ..; at rest from 3 s on. Samples at t = 1 s and 2 s are at impacts.
    const DecimalReference truth = decimal_reference(scene, 32, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    for (std::size_t i = 0; i < truth.times.size(); ++i) {
        Exact t(truth.times[i]), x(0);
        if (t < 1) {
            x = 1 - t * t;
        } else {
            t -= 1;
            Exact flight(1), speed(1);
            while (t >= flight && flight > 1e-40) t -= flight, flight /= 2, speed /= 2;
            x = flight > 1e-40 ? Exact(t * (speed - t)) : Exact(0);
        }
        EXPECT_LT(abs(Exact(Exact(truth.columns[i][7]) - (x + Exact(0.25)))), 1e-24) << truth.times[i];
    }
    EXPECT_LT(abs(Exact(Exact(truth.columns[8][10]) - 1)), 1e-24);  // after the impact with 2 m/s
    EXPECT_LT(abs(Exact(Exact(truth.columns[16][10]) - Exact(0.5))), 1e-24);
    scene.duration = 1;
    const DecimalReference last = decimal_reference(scene, 1, 25);
    ASSERT_TRUE(last.available) << last.message;
    EXPECT_LT(abs(Exact(Exact(last.columns[1][10]) - 1)), 1e-24);
    scene.duration = 4;
    EXPECT_NEAR(solve_end(scene), 0.25, 1e-12);
    Scene elastic = scene;
    elastic.joints[0].limits.restitution = 1, elastic.duration = 3.5;
    EXPECT_NEAR(solve_end(elastic), 1, 1e-10);  // 0.5 s after the second impact: 0.25 + 2 0.5 - 0.5^2
}

// A block that a motor has pressed against a limit stays there without a load: both formulations find the same modes
// where the force of the limit is zero up to rounding.
TEST(JointLimits, BlockStaysAtALimitWithoutALoad) {
    const FreshCache cache;
    Scene scene = slider(1.625, 2);
    scene.joints[0].axes[0] = {0.6, 0.48, 0.64};
    scene.joints[0].limits = {-0.5, 0.25, 0};
    scene.joints[0].rate[0] = 0.375;
    scene.loads = {Motor{"rail", 7.375, {0.25, 0.625}}};
    const DecimalReference truth = decimal_reference(scene, 4, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    ASSERT_EQ(truth.contact_events.size(), 1u);
    EXPECT_EQ(truth.contact_events[0].event, "rests");
    EXPECT_LT(abs(Exact(Exact(truth.columns.back()[7]) - Exact(0.25) * Exact(0.6))), 1e-16);
    EXPECT_NEAR(solve_end(scene), 0.25 * 0.6, 1e-12);
}

// A pendulum between stops: between impacts the energy is constant, and each impact keeps e^2 of the kinetic energy.
TEST(JointLimits, PendulumBetweenStopsLosesEnergyAtImpactsOnly) {
    const FreshCache cache;
    constexpr double e = 0.75;
    Scene scene = scene_of("stops", 1.5);
    scene.bodies = {body_of("arm", 1.5, {0.25, 0.5, 0.375}, {0, 0, -0.5})};
    scene.joints = {joint_of("hinge", JointType::revolute, "world", "arm")};
    scene.joints[0].limits = {-0.25, 0.5, e};
    scene.joints[0].rate[0] = 4;
    scene.loads = {Gravity{{0, 0, -9.75}, {}}};
    const Reference truth = reference(scene, 12, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    const auto height = [](double angle) { return -1.5 * 9.75 * 0.5 * std::cos(angle); };
    // energies after 0, 1, 2, .. impacts, alternately at the upper and the lower limit
    std::vector<double> levels{truth.system[0].energy.high};
    for (int k = 0; k < 40; ++k) {
        const double at = height(k % 2 ? -0.25 : 0.5), before = levels.back() - at;
        if (before < 0) break;
        levels.push_back(at + e * e * before);
    }
    std::size_t level = 0;
    for (const ReferenceSystem& now : truth.system) {
        while (level + 1 < levels.size() && std::abs(now.energy.high - levels[level]) > 1e-12) ++level;
        EXPECT_NEAR(now.energy.high, levels[level], 1e-12);
    }
    EXPECT_GE(level, 3u);
}

// A spatial arm with friction and limits in all joints: both formulations pass through the same events. At the end of
// a series of impacts the joint turns closer to its limit than the rounding of its coordinate.
TEST(JointLimits, SpatialArmAgreesInTwoFormulations) {
    const FreshCache cache;
    Scene scene = scene_of("arm", 0.375);
    scene.bodies = {body_of("shoulder", 2, {0.25, 0.375, 0.5}, {0, 0.125, -0.25}),
                    body_of("elbow", 1.5, {0.25, 0.125, 0.25}, {0.125, 0, -0.25}),
                    body_of("wrist", 1, {0.0625, 0.125, 0.125}, {0, 0, -0.125})};
    scene.joints = {joint_of("a", JointType::revolute, "world", "shoulder", {0, 1, 0.25}),
                    joint_of("b", JointType::revolute, "shoulder", "elbow", {1, 0, 0}, {0, 0, -0.5}),
                    joint_of("c", JointType::prismatic, "elbow", "wrist", {0, 0.5, 1}, {0, 0, -0.5})};
    scene.joints[0].coordinate[0] = 1, scene.joints[1].rate[0] = 2;
    scene.joints[0].friction = 0.5, scene.joints[1].friction = 1, scene.joints[2].friction = 2;
    scene.joints[0].limits = {-0.75, 1.5, 0.5}, scene.joints[1].limits = {-0.5, 0.75, 0};
    scene.joints[2].limits = {-0.125, 0.25, 0.25};
    scene.joints[1].armature[0] = 0.125;
    scene.loads = {Gravity{{0, 0, -9.75}, {}}};
    const Reference truth = reference(scene, 3, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    EXPECT_LE(truth.bound, 1e-22);
    Settings settings;
    settings.samples = 3, settings.tolerance = 1e-12;
    const Trajectory run = solve(pose(scene), *find_method("taylor"), settings);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    for (std::size_t i = 0; i < run.samples.size(); ++i)
        EXPECT_LT(length(Vector3<double>(run.samples[i].position_W - truth.samples[i].rounded().position_W)), 1e-8)
            << i;
}

// Two blocks on top of each other: the lower one is held or dragged along, by the laws for each case.
TEST(JointFriction, StackedBlocksStickOrSlip) {
    const FreshCache cache;
    Scene scene = scene_of("stack", 1);
    scene.bodies = {body_of("lower", 2, {1, 1, 1}), body_of("upper", 1, {1, 1, 1})};
    scene.joints = {joint_of("floor", JointType::prismatic, "world", "lower", {1, 0, 0}),
                    joint_of("between", JointType::prismatic, "lower", "upper", {1, 0, 0})};
    struct Case {
        double floor, between, force, lower, upper;  // accelerations
    };
    for (const Case& one : {Case{1, 2, 0.75, 0, 0},        // all held
                            Case{1, 2, 1.75, 0.25, 0.25},  // both move together: 0.75 / 3
                            Case{1, 2, 8, 0.5, 6},         // the upper one slips and drags the lower: (2 - 1) / 2
                            Case{3, 2, 8, 0, 6}}) {        // the lower one is held
        scene.joints[0].friction = one.floor, scene.joints[1].friction = one.between;
        scene.loads = {Force{{one.force, 0, 0}, Frame::world, {}, Frame::body, {}, "upper"}};
        const DecimalReference truth = decimal_reference(scene, 1, 25);
        ASSERT_TRUE(truth.available) << truth.message;
        EXPECT_LT(abs(Exact(Exact(truth.columns[2][7]) - Exact(one.lower) / 2)), 1e-24) << one.force;
        EXPECT_LT(abs(Exact(Exact(truth.columns[3][7]) - Exact(one.upper) / 2)), 1e-24) << one.force;
        // the reaction of the floor includes its friction
        const Exact balance = Exact(one.force) - 2 * Exact(one.lower) - Exact(one.upper);
        EXPECT_LT(abs(Exact(Exact(truth.reactions[0][0]) + balance)), 1e-23) << one.force;
    }
}

// All conditions of the complementarity problem, for random positive definite matrices.
TEST(BoxForces, SatisfyAllConditions) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int trial = 0; trial < 500; ++trial) {
        const std::size_t n = 1 + static_cast<std::size_t>(trial) % 5;
        std::vector<double> L(n * n), A(n * n, 0.0), a(n);
        for (double& x : L) x = any(random);
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j < n; ++j) {
                A[i * n + j] = i == j ? 0.1 : 0;
                for (std::size_t k = 0; k < n; ++k) A[i * n + j] += L[i * n + k] * L[j * n + k];
            }
        std::vector<contact::Box<double>> boxes(n);
        for (std::size_t i = 0; i < n; ++i) {
            a[i] = any(random);
            const double F = std::abs(any(random));
            boxes[i] = {-F, F, trial % 3 != 1 || i != 0, trial % 3 != 2 || i != 0};
        }
        const auto found = contact::BoxForces<double>(A, a, boxes).solve();
        ASSERT_TRUE(found) << trial;
        for (std::size_t i = 0; i < n; ++i) {
            double rest = a[i];
            for (std::size_t j = 0; j < n; ++j) rest += A[i * n + j] * found->forces[j];
            const double f = found->forces[i];
            const bool at_low = boxes[i].has_low && f <= boxes[i].low,
                       at_high = boxes[i].has_high && f >= boxes[i].high;
            EXPECT_TRUE(!boxes[i].has_low || f >= boxes[i].low);
            EXPECT_TRUE(!boxes[i].has_high || f <= boxes[i].high);
            if (at_low)
                EXPECT_GE(rest, -1e-9);
            else if (at_high)
                EXPECT_LE(rest, 1e-9);
            else
                EXPECT_NEAR(rest, 0, 1e-9);
        }
    }
}

TEST(JointLimits, FilesAreCheckedAndWritten) {
    const std::string text = R"({"name": "a", "duration": 1,
  "bodies": [{"name": "arm", "body": {"mass": 1, "inertia": [1, 1, 1]}}],
  "joints": [{"name": "j", "type": "revolute", "parent": "world", "child": "arm", "axis": [0, 1, 0], LAW}]})";
    const auto with = [&](const std::string& law) {
        std::string scene = text;
        return scene.replace(scene.find("LAW"), 3, law);
    };
    const Scene scene = parse_scene(with(R"("friction": 0.3, "limits": {"lower": -1, "restitution": 0.5})"), "a.json");
    EXPECT_EQ(scene.joints[0].friction, 0.3);
    EXPECT_EQ(scene.joints[0].limits.lower, -1);
    EXPECT_TRUE(std::isinf(scene.joints[0].limits.upper));
    const Scene again = parse_scene(write_scene(scene), "a.json");
    EXPECT_EQ(again.joints[0].limits.restitution, 0.5);
    EXPECT_EQ(write_scene(again), write_scene(scene));
    for (const auto& [law, place] : {std::pair{R"("friction": -1)", "/joints/0/friction"},
                                     {R"("limits": {"lower": 1, "upper": 0})", "/joints/0/limits"},
                                     {R"("limits": {"upper": -1})", "/joints/0/initial"},
                                     {R"("limits": {"upper": 1, "restitution": 2})", "/joints/0/limits/restitution"},
                                     {R"("limits": {})", "/joints/0/limits"}})
        try {
            parse_scene(with(law), "a.json");
            FAIL() << law;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(place), std::string::npos) << error.what();
        }
}

}  // namespace
}  // namespace polhode
