// Errors at contacts, on trajectories and references from closed forms.
#include "measure/contact_errors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scene/body_source.h"

namespace polhode {
namespace {

constexpr double contact_radius = 0.125, contact_gravity = 10, contact_mass = 2;

// A ball of 2 kg on the plane z = 0.
Scene ball_on_floor() {
    Scene scene;
    scene.name = "ball", scene.duration = 1;
    scene.body = body_of(body_source(ShapedBody{SolidSphere{contact_radius}, {contact_mass, false}}));
    scene.initial.position_W = {0, 0, contact_radius};
    scene.loads = {Gravity{{0, 0, -contact_gravity}, {}}};
    scene.planes = {{{0, 0, 1}, 0, 0.5, 0.25}};
    return scene;
}

// A ball with the velocity `speed` along x, at the height `height` above the plane, with the spin `rate` about y.
Sample moving_ball(double t, double speed, double height, double rate) {
    return {t, {1, 0, 0, 0}, {0, rate, 0}, {speed * t, 0, contact_radius + height}, {speed, 0, 0}};
}

// The ball slides with 3 m/s until t = 0.5, then rolls with 2 m/s: rate = speed / radius, exact in binary64.
Reference rolls_after_half() {
    Reference reference;
    reference.available = true;
    for (int k = 0; k <= 4; ++k) {
        const double t = k / 4.0, speed = t < 0.5 ? 3 : 2, rate = t < 0.5 ? 0 : speed / contact_radius;
        ReferenceSample s;
        s.t = t, s.q.w = 1;
        s.angular_velocity_B[1] = rate;
        s.position_W[0] = speed * t, s.position_W[2] = contact_radius;
        s.velocity_W[0] = speed;
        reference.samples.push_back(s);
    }
    return reference;
}

Trajectory sampled(const std::vector<Sample>& samples) {
    Trajectory trajectory;
    trajectory.samples = samples;
    return trajectory;
}

TEST(ContactErrors, MeasureDepthAndSlipWhereTheTruthRolls) {
    const Scene scene = ball_on_floor();
    // the slip v - r w is 3 m/s while the truth slides, then 2 - 0.125 rate
    const Trajectory run =
        sampled({moving_ball(0, 3, 0, 0), moving_ball(0.25, 3, -0.0625, 0), moving_ball(0.5, 2, 0, 16),
                 moving_ball(0.75, 2, 0.5, 15), moving_ball(1, 2, 0, 16.5)});
    const ContactErrors errors = contact_errors(scene, run, rolls_after_half());
    EXPECT_EQ(errors.penetration, 0.0625);
    EXPECT_EQ(errors.slip, 0.125);
    EXPECT_FALSE(errors.event_time);
    const ContactErrors alone = contact_errors(scene, run, {});
    EXPECT_EQ(alone.penetration, 0.0625);
    EXPECT_FALSE(alone.slip);
}

// E = m (g z + v^2 / 2 + r^2 w^2 / 5): the largest rise is that from the lowest earlier energy.
TEST(ContactErrors, EnergyGainIsTheLargestRise) {
    Scene scene = ball_on_floor();
    const Trajectory run = sampled({moving_ball(0, 3, 0.5, 0), moving_ball(0.25, 1, 0, 0), moving_ball(0.5, 2, 0, 0),
                                    moving_ball(0.75, 1.5, 0.25, 8), moving_ball(1, 0, 0, 0)});
    const double lowest = 0.5, highest = contact_gravity * 0.25 + 1.5 * 1.5 / 2 + 0.125 * 0.125 * 64 / 5;
    EXPECT_NEAR(*contact_errors(scene, run, {}).energy_gain, contact_mass * (highest - lowest), 1e-14);
    scene.loads.push_back(Torque{{0, 1, 0}, Frame::body, {}});
    EXPECT_FALSE(contact_errors(scene, run, {}).energy_gain);
    EXPECT_TRUE(contact_errors(scene, run, {}).penetration);
}

TEST(ContactErrors, AreEmptyWithoutPlanesAndForFailedRuns) {
    Scene scene = ball_on_floor();
    Trajectory run = sampled({moving_ball(0, 3, -1, 0)});
    EXPECT_EQ(contact_errors(scene, run, {}).penetration, 1.0);
    run.status = Status::failed;
    EXPECT_FALSE(contact_errors(scene, run, {}).penetration);
    run.status = Status::ok, scene.planes.clear();
    EXPECT_FALSE(contact_errors(scene, run, {}).penetration);
    EXPECT_FALSE(contact_errors(scene, run, {}).energy_gain);
}

// The lowest vertex of a cube of side 1 that stands on an edge is sqrt(1/2) below its centre.
TEST(ContactErrors, MeasureTheDepthOfTheHull) {
    Scene scene = ball_on_floor();
    scene.body = body_of(body_source(ShapedBody{Box{{0.5, 0.5, 0.5}}, {contact_mass, false}}));
    const double eighth = std::acos(-1.0) / 8;
    Trajectory run = sampled({{0, {std::cos(eighth), std::sin(eighth), 0, 0}, {}, {0, 0, 0.5}, {}}});
    EXPECT_NEAR(*contact_errors(scene, run, {}).penetration, std::sqrt(0.5) - 0.5, 1e-15);
}

TEST(ContactEvents, AreMatchedInOrder) {
    const std::vector<ContactEvent> truth{{0.5, "impact", 0}, {1, "lands", 0}, {1.25, "rolls", 0}};
    std::vector<ContactEvent> run = truth;
    EXPECT_EQ(compare_events(run, truth).time_error, 0.0);
    EXPECT_EQ(compare_events(run, truth).message, "");
    run[1].t = 0.875, run[2].t = 1.3125;
    EXPECT_EQ(compare_events(run, truth).time_error, 0.125);
    run.pop_back();
    EXPECT_EQ(compare_events(run, truth).time_error, 0.125);
    EXPECT_EQ(compare_events(run, truth).message, "no event \"rolls\" at 1.25 s; 2 events, the reference has 3");
    EXPECT_EQ(compare_events(truth, run).message,
              "additional event \"rolls\" at 1.25 s; 3 events, the reference has 2");
    run[0].kind = "lands";
    EXPECT_FALSE(compare_events(run, truth).time_error);
    EXPECT_EQ(compare_events(run, truth).message, "event \"lands\" at 0.5 s: the reference has \"impact\" at 0.5 s");
    run = truth, run[2].plane = 1;
    EXPECT_EQ(compare_events(run, truth).time_error, 0.0);
    EXPECT_NE(compare_events(run, truth).message, "");
    EXPECT_FALSE(compare_events({}, {}).time_error);
}

// A series of impacts with a limit: one of the lists may stop counting earlier.
TEST(ContactEvents, SkipImpactsBeforeTheirLimit) {
    const std::vector<ContactEvent> truth{{0.5, "impact", 0}, {0.75, "impact", 0}, {1, "accumulates", 0}};
    const std::vector<ContactEvent> run{{0.5, "impact", 0}, {1.25, "accumulates", 0}};
    EXPECT_EQ(compare_events(run, truth).time_error, 0.25);
    EXPECT_EQ(compare_events(run, truth).message, "");
    EXPECT_EQ(compare_events(truth, run).time_error, 0.25);
}

// Differences of times are formed in two parts.
TEST(ContactEvents, ResolveTimesBeyondBinary64) {
    const std::vector<ContactEvent> truth{{{1, 0x1p-60}, "impact", 0}}, run{{1, "impact", 0}};
    EXPECT_EQ(compare_events(run, truth).time_error, 0x1p-60);
}

// The times of impacts that a method reports, without kinds.
TEST(ContactErrors, CompareImpactTimes) {
    Reference reference = rolls_after_half();
    reference.impact_times = {0.25, 0.5};
    Trajectory run = sampled({moving_ball(0, 3, 0, 0)});
    run.impact_times = {0.375, 0.5};
    EXPECT_EQ(contact_errors(ball_on_floor(), run, reference).event_time, 0.125);
}

}  // namespace
}  // namespace polhode
