// Prescribed motions of joints: the reference solution and the method taylor against closed forms, momentum and the
// work of the drive.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "integrators/method.h"
#include "integrators/series/real.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"
#include "motion/massless.h"
#include "motion/problem.h"
#include "scene/joint_motions.h"
#include "scene/scene_file.h"
#include "whole/exact_rows.h"

namespace polhode {
namespace {

using massless::body_of, massless::joint_of, massless::scene_of;

// r = r0 cosh(2 t) on a rod that turns at 2 rad/s; the drive's torque is the rate of 2 m r^2.
TEST(PrescribedMotion, BeadOnARotatingRodFollowsTheClosedForm) {
    const FreshCache cache;
    const Scene scene = find_scene("joints/bead_on_rotating_rod");
    const DecimalReference truth = decimal_reference(scene, 4, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    EXPECT_NE(truth.message.find("maximal coordinates"), std::string::npos);
    for (std::size_t k = 0; k <= 4; ++k) {
        const Exact t(truth.times[k]), r = cosh(Exact(2 * t)) / 4, rate = sinh(Exact(2 * t)) / 2;
        const DecimalColumns& bead = truth.columns[2 * k + 1];
        expect_equal(number(bead, position), Exact(r * cos(Exact(2 * t))), 1e-23);
        expect_equal(number(bead, position + 1), Exact(r * sin(Exact(2 * t))), 1e-23);
        expect_equal(Exact(truth.reactions[2 * k][5]), Exact(2 * r * rate), 1e-22);
    }
    Settings settings;
    settings.samples = 1, settings.tolerance = 1e-12;
    const Trajectory run = solve(pose(scene), *find_method("taylor"), settings);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    EXPECT_NEAR(run.samples.back().position_W[0], std::cosh(2) / 4 * std::cos(2), 1e-11);
    EXPECT_NE(refusal(*find_method("odeint_dopri5"), pose(scene)).find("prescribed"), std::string::npos);
}

// l x'' = (g + z'') sin x for a pivot at z = a cos(w t), by Runge and Kutta's method in long double.
long double kapitza_angle(long double a, long double w, long double T) {
    using Long = long double;
    using State = std::array<Long, 2>;
    constexpr Long g = 9.75L, l = 0.5L;
    constexpr int steps = 40000;
    const Long h = T / steps;
    State y{0.25L, 0};
    const auto slope = [&](Long t, const State& s) {
        return State{s[1], (g - a * w * w * std::cos(w * t)) / l * std::sin(s[0])};
    };
    for (int i = 0; i < steps; ++i) {
        const Long t = h * static_cast<Long>(i);
        const auto at = [&](const State& k, Long step) { return State{y[0] + step * k[0], y[1] + step * k[1]}; };
        const State k1 = slope(t, y), k2 = slope(t + h / 2, at(k1, h / 2)), k3 = slope(t + h / 2, at(k2, h / 2)),
                    k4 = slope(t + h, at(k3, h));
        for (std::size_t j = 0; j < 2; ++j) y[j] += h / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
    }
    return y[0];
}

// The inverted pendulum is stable if (a w)^2 > 2 g l (Kapitza 1951): 64 and 4 m^2/s^2 against 9.75.
TEST(PrescribedMotion, KapitzasCartStabilizesAboveTheBound) {
    const FreshCache cache;
    Scene scene = find_scene("joints/kapitza_cart");
    const auto angle_at = [](const DecimalColumns& row) {
        return 2 * std::atan2(std::stod(row[2]), std::stod(row[0]));
    };
    const DecimalReference truth = decimal_reference(scene, 20, 20);
    ASSERT_TRUE(truth.available) << truth.message;
    for (std::size_t k = 0; k <= 20; ++k) EXPECT_LT(std::abs(angle_at(truth.columns[2 * k + 1])), 0.3) << k;
    EXPECT_NEAR(angle_at(truth.columns.back()), double(kapitza_angle(0.0625L, 128, 1)), 1e-11);
    ASSERT_EQ(scene.parameters[1].name, "omega");
    scene.parameters[1].value = 32;
    start_joint_motions(scene, "");
    const DecimalReference slow = decimal_reference(scene, 1, 20);
    ASSERT_TRUE(slow.available) << slow.message;
    EXPECT_NEAR(
        std::remainder(angle_at(slow.columns.back()) - double(kapitza_angle(0.0625L, 32, 1)), 6.283185307179586), 0,
        1e-10);
}

// The energy changes by the work of the drive: Simpson's rule on its force and the speed of the cart.
TEST(PrescribedMotion, EnergyChangesByTheWorkOfTheDrive) {
    const FreshCache cache;
    Scene scene = find_scene("joints/kapitza_cart");
    scene.duration = 0.125;
    constexpr std::size_t n = 512;
    const Reference truth = reference(scene, static_cast<long>(n), 20);
    ASSERT_TRUE(truth.available) << truth.message;
    double work = 0, largest = 0;
    for (std::size_t k = 0; k <= n; ++k) {
        const double t = 0.125 * double(k) / double(n), speed = -0.0625 * 128 * std::sin(128 * t);
        const double power = truth.reactions[2 * k].force_W[2].high * speed;
        work += (k == 0 || k == n ? 1 : k % 2 ? 4 : 2) * power * 0.125 / double(n) / 3;
        const double gained = truth.system[k].energy.high - truth.system[0].energy.high;
        largest = std::max(largest, std::abs(gained));
        if (k == n) {
            EXPECT_NEAR(work, gained, 1e-6 * largest);
        }
    }
    EXPECT_GT(largest, 1);
}

// A rotor is turned by t^2 / 2 relative to a free hub: the angular momentum remains zero.
TEST(PrescribedMotion, RotorTurnsAFreeHubBack) {
    const FreshCache cache;
    Scene scene = scene_of("hub", 2);
    scene.bodies = {body_of("hub", 2, {1, 1, 0.75}), body_of("rotor", 1, {0.5, 0.5, 0.25})};
    scene.joints = {joint_of("shaft", JointType::revolute, "hub", "rotor", {0, 0, 1})};
    scene.joints[0].motion = "t^2/2";
    const DecimalReference truth = decimal_reference(scene, 2, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    for (std::size_t k = 0; k <= 2; ++k) {
        const Exact t(truth.times[k]);
        expect_equal(Exact(truth.columns[2 * k][6]), Exact(-t / 4), 1e-23);
        expect_equal(Exact(truth.columns[2 * k][3]), Exact(-sin(Exact(t * t / 16))), 1e-23);
    }
}

// A block on a cart that accelerates with 1 m/s^2 falls against the limit behind it. Impacts and impulses do not change
// the motion of the cart.
TEST(PrescribedMotion, ImpactsLeaveTheDrivenCoordinateUnchanged) {
    const FreshCache cache;
    Scene scene = scene_of("cart", 1.5);
    scene.bodies = {body_of("cart", 2, {1, 1, 1}), body_of("block", 1, {1, 1, 1})};
    scene.joints = {joint_of("rail", JointType::prismatic, "world", "cart", {1, 0, 0}),
                    joint_of("bed", JointType::prismatic, "cart", "block", {1, 0, 0})};
    scene.joints[0].motion = "t^2/2";
    scene.joints[1].coordinate[0] = 0.5;
    scene.joints[1].limits = {0, 1e9, 0.5};
    scene.loads = {Impulse{{3, 0, 0}, Frame::world, {}, Frame::body, 0.25, "cart"}};
    const DecimalReference truth = decimal_reference(scene, 3, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    for (std::size_t k = 0; k <= 3; ++k) {
        const Exact t(truth.times[k]), s = t - 1;
        const Exact relative = t < 1 ? Exact((1 - t * t) / 2) : Exact(s / 2 - s * s / 2);
        expect_equal(number(truth.columns[2 * k], position), Exact(t * t / 2), 1e-24);
        expect_equal(number(truth.columns[2 * k], velocity), t, 1e-24);
        expect_equal(number(truth.columns[2 * k + 1], position), Exact(t * t / 2 + relative), 1e-23);
    }
    // the drive pushes the cart and, while it is at rest on the limit, the block
    expect_equal(Exact(truth.reactions[0][0]), Exact(2), 1e-23);
}

TEST(PrescribedMotion, FilesAreCheckedAndWritten) {
    const std::string text = R"({"name": "a", "duration": 1, "parameters": {"a": 0.25},
  "bodies": [{"name": "arm", "body": {"mass": 1, "inertia": [1, 1, 1]}}, {"name": "tip", "body": {"mass": 1, "inertia": [1, 1, 1]}}],
  "joints": [{"name": "j", "type": "revolute", "parent": "world", "child": "arm", "axis": [0, 1, 0], LAW},
             {"name": "k", "type": "revolute", "parent": "arm", "child": "tip", "axis": [0, 1, 0]}]})";
    const auto with = [&](const std::string& law) {
        std::string scene = text;
        return scene.replace(scene.find("LAW"), 3, law);
    };
    const Scene scene = parse_scene(with(R"x("motion": "a + sqrt(1 + t)*sin(2*t)")x"), "a.json");
    EXPECT_EQ(scene.joints[0].coordinate[0], 0.25);
    EXPECT_EQ(scene.joints[0].rate[0], 2);
    EXPECT_EQ(write_scene(parse_scene(write_scene(scene), "a.json")), write_scene(scene));
    for (const auto& [law, fault] :
         {std::pair{R"x("motion": "abs(t)")x", "/joints/0/motion: switches between branches"},
          {R"x("motion": "b*t")x", "/joints/0/motion: column 1"},
          {R"x("motion": "[t, 0, 0]")x", "/joints/0/motion: the formula is a vector"},
          {R"x("motion": "1/t")x", "/joints/0/motion: is not finite at t = 0"},
          {R"x("motion": "t", "friction": 1)x", "/joints/0/motion: is given together with friction"},
          {R"x("motion": "t", "initial": {"angle": 1})x", "/joints/0/initial: is given for a joint with a prescribed"}})
        try {
            parse_scene(with(law), "a.json");
            FAIL() << law;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(fault), std::string::npos) << error.what();
        }
}

}  // namespace
}  // namespace polhode
