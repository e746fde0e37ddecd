// Massless bodies, point masses and rods with every method for mechanisms and with the reference solution, compared
// with equations of motion written out here or with equivalent scenes.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "integrators/method.h"
#include "integrators/series/real.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"
#include "motion/massless.h"
#include "motion/mechanism.h"

namespace polhode {
namespace {

using massless::body_of, massless::joint_of, massless::scene_of;
using Many = Real<50>;

// theta1, theta2 and their rates: the double pendulum of point masses, angles from the vertical.
using Angles = std::array<Many, 4>;

Angles rates(const massless::PointMassPendulum& p, const Angles& y) {
    const Many m1 = p.m1, m2 = p.m2, l1 = p.l1, l2 = p.l2, g = p.g;
    const Many d = y[0] - y[1], s = sin(d), c = cos(d), below = 2 * m1 + m2 - m2 * cos(Many(2 * d));
    const Many q1 = y[2] * y[2], q2 = y[3] * y[3];
    const Many a1 =
        (-g * (2 * m1 + m2) * sin(y[0]) - m2 * g * sin(Many(y[0] - 2 * y[1])) - 2 * s * m2 * (q2 * l2 + q1 * l1 * c)) /
        (l1 * below);
    const Many a2 = 2 * s * (q1 * l1 * (m1 + m2) + g * (m1 + m2) * cos(y[0]) + q2 * l2 * m2 * c) / (l2 * below);
    return {y[2], y[3], a1, a2};
}

// One step of Gragg's modified midpoint rule with 2, 4, .., 2 columns steps, extrapolated in h^2 to order 2 columns
// (Hairer, Norsett, Wanner 1993, II.9).
Angles extrapolated_step(const massless::PointMassPendulum& p, const Angles& y, const Many& H) {
    constexpr std::size_t columns = 14;
    std::vector<Angles> row(columns);
    for (std::size_t j = 0; j < columns; ++j) {
        const std::size_t n = 2 * (j + 1);
        const Many h = H / n;
        Angles before = y, now = y, rate = rates(p, y);
        for (std::size_t i = 0; i < 4; ++i) now[i] += h * rate[i];
        for (std::size_t k = 1; k < n; ++k) {
            rate = rates(p, now);
            for (std::size_t i = 0; i < 4; ++i) {
                const Many next = before[i] + 2 * h * rate[i];
                before[i] = now[i], now[i] = next;
            }
        }
        row[j] = now;
        // Aitken-Neville from the right: row[k] is the value of columns k..j
        for (std::size_t k = j; k-- > 0;) {
            const Many ratio = Many(j + 1) / Many(k + 1), share = 1 / (ratio * ratio - 1);
            for (std::size_t i = 0; i < 4; ++i) row[k][i] = row[k + 1][i] + share * (row[k + 1][i] - row[k][i]);
        }
    }
    return row[0];
}

TEST(MasslessBodies, TruthOfThePointMassPendulumHas25DigitsOfTheBooksEquations) {
    const FreshCache cache;
    const massless::PointMassPendulum p;
    constexpr int samples = 4, steps_per_sample = 25;
    const DecimalReference truth = decimal_reference(p.scene(2), samples, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    EXPECT_LE(truth.bound, 1e-25);
    EXPECT_NE(truth.message.find("maximal coordinates"), std::string::npos) << truth.message;
    Angles y{p.theta1, p.theta2, p.w1, p.w2};
    for (int k = 0; k <= samples; ++k) {
        const Many x1 = -p.l1 * sin(y[0]), z1 = -p.l1 * cos(y[0]);
        const Many x2 = x1 - p.l2 * sin(y[1]), z2 = z1 - p.l2 * cos(y[1]);
        const std::pair<Many, Many> places[] = {{x1, z1}, {x2, z2}};
        for (std::size_t b = 0; b < 2; ++b) {
            // columns: q, w, p, v
            const DecimalColumns& columns = truth.columns[2 * static_cast<std::size_t>(k) + b];
            EXPECT_LT(abs(Many(Many(columns[7]) - places[b].first)), 1e-25) << k << " " << b;
            EXPECT_LT(abs(Many(Many(columns[9]) - places[b].second)), 1e-25) << k << " " << b;
            EXPECT_LT(abs(Many(columns[8])), 1e-25);
            EXPECT_LT(abs(Many(Many(columns[5]) - y[2 + b])), 2e-24) << k << " " << b;
        }
        for (int i = 0; i < steps_per_sample; ++i) y = extrapolated_step(p, y, Many(2) / (samples * steps_per_sample));
    }
}

double distance_of(const Bodies& a, const ReferenceSample* b) {
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        most = std::max(most, length(Vector3<double>(a[i].position_W - b[i].rounded().position_W)));
    return most;
}

// Each method for mechanisms follows the reference within its order, or names the body that it does not support.
TEST(MasslessBodies, EveryMethodSolvesThePointMassPendulumOrReportsWhyNot) {
    const FreshCache cache;
    const Scene scene = massless::PointMassPendulum{}.scene(1);
    const Problem problem = pose(scene);
    const Reference truth = reference(scene, 1);
    ASSERT_TRUE(truth.available) << truth.message;
    int solved = 0, unsupported = 0;
    for (const Method* method : methods()) {
        if (!method->general_systems && method->precision != Precision::binary32) continue;
        if (std::string_view(method->name) == "truth") continue;
        Settings settings;
        settings.samples = 1, settings.max_steps = 1'000'000;
        if (method->control == Control::fixed_step)
            settings.step = 1e-4;
        else
            settings.tolerance = method->precision == Precision::binary32 ? 1e-5 : 1e-9;
        if (const std::string why = refusal(*method, problem); !why.empty()) {
            if (why.find("body \"upper\" has a moment of inertia of zero") != why.npos) ++unsupported;
            continue;
        }
        const Trajectory run = solve(problem, *method, settings);
        if (run.status == Status::unsupported) continue;
        ASSERT_EQ(run.status, Status::ok) << method->name << ": " << run.message;
        const std::vector<Sample> last(run.samples.end() - 2, run.samples.end());
        EXPECT_LT(distance_of(last, &truth.samples[2]), method->control == Control::fixed_step ? 5e-3 : 1e-4)
            << method->name;
        ++solved;
    }
    EXPECT_GE(solved, 20);
    EXPECT_GE(unsupported, 10);  // engine updates, which divide by each body's mass and moments
    EXPECT_TRUE(refusal(*find_method("ida_index1"), problem).empty());
    EXPECT_TRUE(refusal(*find_method("ida_index2"), problem).empty());
}

// Two massless sliders and a hinge give the three degrees of freedom of planar motion. The motion equals that of a
// free body that starts in the plane and is loaded within it. The two references have different dimensions.
TEST(MasslessBodies, APlanarRootMovesAsAFreeBodyInThePlane) {
    const FreshCache cache;
    const NamedBody box = body_of("box", 1.5, {0.5, 0.75, 1}, {0.25, 0, -0.5});
    const std::vector<Load> loads{Gravity{{0, 0, -9.75}, {}},
                                  Force{{2, 0, 1}, Frame::body, {0.5, 0, 0.25}, Frame::body, {}, "box"},
                                  Drag{{0.1, 0.2, 0.3}, 0.25, {}, "box"}};
    Scene planar = scene_of("planar", 1.5);
    planar.bodies = {body_of("slide x", 0), body_of("slide z", 0), box};
    planar.joints = {joint_of("x", JointType::prismatic, "world", "slide x", {1, 0, 0}),
                     joint_of("z", JointType::prismatic, "slide x", "slide z", {0, 0, 1}),
                     joint_of("turn", JointType::revolute, "slide z", "box", {0, 1, 0})};
    planar.joints[0].coordinate[0] = 0.5, planar.joints[0].rate[0] = 1;
    planar.joints[1].coordinate[0] = -0.25, planar.joints[1].rate[0] = 2;
    planar.joints[2].rate[0] = 3;
    planar.loads = loads;
    Scene free = scene_of("free", 1.5);
    free.bodies = {box}, free.loads = loads;
    Initial& start = free.bodies[0].initial;
    // the centre of mass rotates about the hinge: v + w x r, w = (0, 3, 0), r = (0.25, 0, -0.5)
    start.position_W = {0.75, 0, -0.75}, start.velocity_W = {1 - 1.5, 0, 2 - 0.75};
    start.angular_velocity = {0, 3, 0};
    const Reference one = reference(planar, 3), other = reference(free, 3);
    ASSERT_TRUE(one.available) << one.message;
    ASSERT_TRUE(other.available) << other.message;
    for (std::size_t k = 0; k <= 3; ++k) {
        const ReferenceSample &a = one.samples[3 * k + 2], &b = other.samples[k];
        const auto same = [](const Pair& x, const Pair& y) {
            return std::abs((x.high - y.high) + (x.low - y.low)) <= 1e-24 * (1 + std::abs(y.high));
        };
        for (int i = 0; i < 3; ++i) {
            EXPECT_TRUE(same(a.position_W[i], b.position_W[i])) << k << " " << i;
            EXPECT_TRUE(same(a.velocity_W[i], b.velocity_W[i])) << k << " " << i;
            EXPECT_TRUE(same(a.angular_velocity_B[i], b.angular_velocity_B[i])) << k << " " << i;
        }
        // the sliders have no energy and no momentum
        EXPECT_NEAR(one.system[k].kinetic.high, other.system[k].kinetic.high, 1e-13 * other.system[k].kinetic.high);
        for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(one.system[k].angular_momentum_W[i].high,
                        // the angular momentum of the free body is about its centre of mass
                        (other.system[k].angular_momentum_W[i].high +
                         1.5 * cross(b.rounded().position_W, b.rounded().velocity_W)[i]),
                        1e-12);
    }
}

// Three hinges that do not meet, massless links and a heavy body: both formulations agree and the energy is conserved.
TEST(MasslessBodies, ThreeHingesApartWithMasslessLinksKeepTheEnergy) {
    const FreshCache cache;
    Scene scene = scene_of("hinges", 1);
    scene.bodies = {body_of("first", 0), body_of("second", 0), body_of("box", 2, {0.5, 0.75, 1}, {0.25, 0.125, -0.5})};
    scene.joints = {joint_of("a", JointType::revolute, "world", "first", {1, 0, 0}),
                    joint_of("b", JointType::revolute, "first", "second", {0, 1, 0.25}, {0.25, 0.5, -0.25}),
                    joint_of("c", JointType::revolute, "second", "box", {0.5, 0, 1}, {-0.25, 0.125, -0.5})};
    scene.joints[0].rate[0] = 1, scene.joints[1].rate[0] = -2, scene.joints[2].rate[0] = 3;
    scene.loads = {Gravity{{0, 0, -9.75}, {}}};
    const Reference truth = reference(scene, 2);
    ASSERT_TRUE(truth.available) << truth.message;
    for (const ReferenceSystem& at : truth.system)
        EXPECT_LT(
            std::abs((at.energy.high - truth.system[0].energy.high) + (at.energy.low - truth.system[0].energy.low)),
            1e-23);
    EXPECT_GT(std::abs(truth.system[2].kinetic.high - truth.system[0].kinetic.high), 0.1);
}

// A point mass on a massless arm on a massless slider. It moves in a straight line to the full length of the arm from
// the rail, which it reaches at t = 1 s. There the mass matrix is singular and the motion cannot be continued.
TEST(MasslessBodies, ARunIntoASingularMassMatrixEndsWithAStatus) {
    const FreshCache cache;
    Scene scene = scene_of("reach", 2);
    scene.bodies = {body_of("slider", 0), body_of("ball", 1, {}, {0, 0, -1})};
    scene.joints = {joint_of("rail", JointType::prismatic, "world", "slider", {1, 0, 0}),
                    joint_of("arm", JointType::revolute, "slider", "ball", {0, 1, 0})};
    // z = -cos(theta), z' = sin(theta) theta' = -1; x' = s' - cos(theta) theta' = 0
    constexpr double theta = 1.5;
    scene.joints[1].coordinate[0] = theta, scene.joints[1].rate[0] = -1 / std::sin(theta);
    scene.joints[0].rate[0] = -std::cos(theta) / std::sin(theta);
    const Problem problem = pose(scene);
    for (const char* name : {"dop853", "taylor", "radau", "extrapolation", "cvode_adams", "ida_index1", "ida_index2"}) {
        Settings settings;
        settings.tolerance = 1e-10, settings.samples = 20, settings.max_steps = 20000;
        const Trajectory run = solve(problem, *find_method(name), settings);
        if (std::string_view(name).starts_with("ida") && run.status == Status::unsupported) continue;
        EXPECT_NE(run.status, Status::ok) << name;
        EXPECT_NE(run.message, "") << name;
        for (const Sample& sample : run.samples) EXPECT_TRUE(std::isfinite(sample.position_W[0])) << name;
    }
    const Reference truth = reference(scene, 4, 17, 5);
    EXPECT_FALSE(truth.available);
    EXPECT_NE(truth.message, "");
}

}  // namespace
}  // namespace polhode
