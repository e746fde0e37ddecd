// Faults of friction: a small engine with known faults rolls balls on planes, with fine and with coarse steps. It
// shares no code with `check`.
#include "check/contact_faults.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "integrators/method.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

using V3 = Vector3<double>;

struct ContactKnobs {
    double friction_factor = 1;
    double inertia_factor = 1;  // factor of I
    bool at_center = false;     // friction does not change the angular velocity
    bool pyramid = false;       // each tangential axis has its own limit
    double rolling_slip = 0;    // part of the slip that is left at each step
    double rolling_loss = 0;    // part of the acceleration of rolling down a slope that is missing
    double sleep_speed = 0;     // a slower ball is put to rest, m/s
    double spin_damping = 0;    // 1/s
    double linear_damping = 0;  // 1/s, of v and w
};

// Semi-implicit Euler with one impulse per step at the contact with the plane z = 0, without restitution.
TrajectoryFile roll(const Scene& scene, const ContactKnobs& k, double h, int steps_per_row) {
    const double m = scene.body.mass, r = scene.initial.position_W[2],
                 mu = k.friction_factor * scene.planes[0].friction;
    const double I = k.inertia_factor * scene.body.inertia_B[0][0], K = 1 / m + r * r / I;
    const V3 g = std::get<Gravity>(scene.loads.at(0)).acceleration_W;
    V3 x = scene.initial.position_W, v = scene.initial.velocity_W, w = scene.initial.angular_velocity;
    TrajectoryFile file;
    file.has_angular_velocity = file.has_position = file.has_velocity = true;
    const auto rows = static_cast<int>(scene.duration / (h * steps_per_row));
    for (int row = 0; row <= rows; ++row) {
        file.rows.push_back({row * h * steps_per_row, {}, w, x, v});
        for (int step = 0; step < steps_per_row; ++step) {
            v = v + h * g;
            const double N = -m * v[2];
            v[2] = 0;
            const double u[2] = {v[0] - r * w[1], v[1] + r * w[0]};
            double J[2] = {-(1 - k.rolling_slip) * u[0] / K, -(1 - k.rolling_slip) * u[1] / K};
            if (k.pyramid) {
                for (double& part : J) part = std::clamp(part, -mu * N, mu * N);
            } else if (const double size = std::hypot(J[0], J[1]); size > mu * N) {
                for (double& part : J) part *= mu * N / size;
            }
            v = v + V3(J[0] / m, J[1] / m, 0);
            if (!k.at_center) w = w + V3(J[1] * r / I, -J[0] * r / I, 0);
            const V3 loss = (-k.rolling_loss * 5 / 7 * h) * V3(g[0], g[1], 0);
            v = v + loss, w = w + (1 / r) * V3(-loss[1], loss[0], 0);
            w[2] *= 1 - k.spin_damping * h;
            v = (1 - k.linear_damping * h) * v, w = (1 - k.linear_damping * h) * w;
            if (std::hypot(v[0], v[1]) < k.sleep_speed) v = w = V3();
            x = x + h * v;
        }
    }
    return file;
}

Scene ball_scene(const std::string& initial, const std::string& gravity, double mu, double duration) {
    return parse_scene(R"({"name": "ball", "duration": )" + std::to_string(duration) +
                           R"(, "body": {"shape": {"type": "sphere", "radius": 0.25}, "mass": 2}, "initial": )" +
                           initial + R"(, "loads": [{"type": "gravity", "acceleration": )" + gravity +
                           R"(}], "planes": [{"name": "floor", "normal": [0, 0, 1], "restitution": 0, "friction": )" +
                           std::to_string(mu) + "}]}",
                       "ball.json");
}
Scene thrown() {
    return ball_scene(R"({"position": [0, 0, 0.25], "velocity": [4, 1, 0], "angular_velocity": [0, -2, 5]})",
                      "[0, 0, -10]", 0.125, 3);
}
Scene on_slope() {
    return ball_scene(R"({"position": [0, 0, 0.25], "velocity": [0, 0.5, 0],
                                       "angular_velocity": [-2, 0, 3]})",
                      "[3, 0, -9]", 0.25, 2);
}
Scene rolling() {
    return ball_scene(R"({"position": [0, 0, 0.25], "velocity": [0.5, 0, 0], "angular_velocity": [0, 2, 0]})",
                      "[0, 0, -10]", 0.25, 2);
}

void expect_fault(const Scene& scene, const ContactKnobs& knobs, const std::string& fault) {
    // rows of 1/60 s: 16 steps each, and one coarse step each
    for (const int steps : {16, 1}) {
        const std::vector<Diagnosis> found = contact_faults(scene, roll(scene, knobs, 1.0 / (60 * steps), steps));
        ASSERT_EQ(found.size(), 1u) << fault << ", steps per row: " << steps
                                    << (found.empty() ? "" : ": " + found[0].message + found.back().message);
        EXPECT_EQ(found[0].fault, fault) << found[0].message;
        EXPECT_NE(found[0].message.find("floor"), std::string::npos) << found[0].message;
    }
}

TEST(ContactFaults, SoundEnginesHaveNone) {
    for (const Scene& scene : {thrown(), on_slope(), rolling()})
        for (const int steps : {16, 1}) {
            const std::vector<Diagnosis> found = contact_faults(scene, roll(scene, {}, 1.0 / (60 * steps), steps));
            EXPECT_TRUE(found.empty()) << found[0].message;
        }
}

// The methods of the catalogue that follow a circular cone, on its scenes of balls.
TEST(ContactFaults, SoundMethodsHaveNone) {
    for (const char* name : {"contact/bowling_ball", "contact/billiard_side_spin", "contact/ball_incline_rolls",
                             "contact/ball_incline_slides", "contact/ball_bounces_and_rolls"}) {
        const Scene scene = find_scene(name);
        Settings settings;
        settings.samples = 120, settings.tolerance = 1e-9;
        const Trajectory run = solve(scene, *find_method("taylor"), settings);
        ASSERT_EQ(run.status, Status::ok) << run.message;
        TrajectoryFile file;
        file.has_angular_velocity = file.has_position = file.has_velocity = true;
        for (const Sample& s : run.samples)
            file.rows.push_back({s.t, s.q, rotate(s.q, s.angular_velocity_B), s.position_W, s.velocity_W});
        const std::vector<Diagnosis> found = contact_faults(scene, file);
        EXPECT_TRUE(found.empty()) << name << ": " << found[0].message;
    }
}

TEST(ContactFaults, FrictionIsMissingOrScaled) {
    ContactKnobs none, half, twice;
    none.friction_factor = 0, half.friction_factor = 0.5, twice.friction_factor = 1.5;
    expect_fault(thrown(), none, "friction_missing");
    expect_fault(thrown(), half, "friction_scaled");
    expect_fault(thrown(), twice, "friction_scaled");
}

TEST(ContactFaults, FrictionIsAPyramidOrActsAtTheCenter) {
    ContactKnobs pyramid, center;
    pyramid.pyramid = true, center.at_center = true;
    expect_fault(thrown(), pyramid, "friction_pyramid");
    expect_fault(thrown(), center, "friction_at_center");
}

// A hollow ball is recognised while it slides and while it rolls down a slope.
TEST(ContactFaults, InertiaIsThatOfAHollowBall) {
    ContactKnobs hollow;
    hollow.inertia_factor = 5.0 / 3;
    expect_fault(thrown(), hollow, "hollow_inertia");
    expect_fault(on_slope(), hollow, "hollow_inertia");
}

TEST(ContactFaults, RollingSlipsOrIsSlowedOrSleeps) {
    ContactKnobs slips, damped, sleeps;
    slips.rolling_slip = 0.8, damped.linear_damping = 0.05, sleeps.sleep_speed = 0.4;
    expect_fault(rolling(), damped, "rolling_slowed");
    Scene slow = rolling();
    slow.initial.velocity_W = {0.5, 0, 0};
    ContactKnobs both = sleeps;
    both.linear_damping = 0.2;
    expect_fault(slow, both, "rolling_sleeps");
    const Scene slope = on_slope();
    const std::vector<Diagnosis> found = contact_faults(slope, roll(slope, slips, 1.0 / 60, 1));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].fault, "rolling_slips") << found[0].message;
}

// Jolt issue 2121 and others: accelerations that are wrong by 1.5 %.
TEST(ContactFaults, RollingAccelerationIsTooLow) {
    ContactKnobs loss;
    loss.rolling_loss = 0.015;
    expect_fault(on_slope(), loss, "rolling_slowed");
}

// The diagnosis of a whole file contains the fault, also with a coarse step.
TEST(ContactFaults, ArePartOfTheDiagnosis) {
    ContactKnobs twice;
    twice.friction_factor = 2;
    const Scene scene = thrown();
    for (const int steps : {16, 1}) {
        const std::vector<Diagnosis> faults = diagnose(scene, roll(scene, twice, 1.0 / (60 * steps), steps)).faults;
        EXPECT_TRUE(std::ranges::any_of(faults, [](const Diagnosis& d) { return d.fault == "friction_scaled"; }));
    }
}

TEST(ContactFaults, SpinIsDamped) {
    ContactKnobs spin;
    spin.spin_damping = 0.2;
    expect_fault(thrown(), spin, "spin_friction");
}

TEST(ContactFaults, OtherBodiesAreNotTested) {
    const Scene scene = find_scene("contact/rolling_ellipsoid");
    EXPECT_TRUE(contact_faults(scene, roll(thrown(), {}, 1.0 / 60, 1)).empty());
}

}  // namespace
}  // namespace polhode
