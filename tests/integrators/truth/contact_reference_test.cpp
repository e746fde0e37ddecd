// Contact with friction in the reference, compared with closed forms of balls and with invariants.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/method.h"
#include "integrators/truth/reference.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

Scene contact_scene(const std::string& body, const std::string& initial, const std::string& gravity,
                    const std::string& plane, double duration) {
    return parse_scene(R"({"name": "contact", "duration": )" + std::to_string(duration) + R"(, "body": )" + body +
                           R"(, "initial": )" + initial + R"(, "loads": [{"type": "gravity", "acceleration": )" +
                           gravity + R"(}], "planes": [{"normal": [0, 0, 1], )" + plane + "}]}",
                       "test");
}

const char* const solid_ball = R"({"shape": {"type": "sphere", "radius": 0.5}, "mass": 2})";

DecimalReference available(const Scene& scene, long samples = 2, int digits = 25) {
    DecimalReference truth = decimal_reference(scene, samples, digits);
    EXPECT_TRUE(truth.available) << truth.message;
    EXPECT_LE(truth.bound, std::pow(10, 1 - digits));
    return truth;
}

long double value(const std::string& decimal) { return std::stold(decimal); }

// EXPECT_NEAR compares in double, which has fewer digits than the reference
void expect_close(long double value, long double expected, long double tolerance) {
    EXPECT_LE(std::abs(value - expected), tolerance)
        << static_cast<double>(value) << " instead of " << static_cast<double>(expected);
}

/// A solid ball that rolls down a slope has the acceleration 5/7 g sin a; it needs |F| = 2/7 m g sin a.
TEST(ContactReference, BallRollsDownASlope) {
    const Scene scene = contact_scene(solid_ball, R"({"position": [0, 0, 0.5]})", "[3, 0, -9]",
                                      R"("restitution": 0.5, "friction": 0.3)", 2);
    const DecimalReference truth = available(scene);
    expect_close(value(truth.columns[2][7]), 5.0L / 7 * 3 * 2, 1e-17L);
    expect_close(value(truth.columns[2][10]), 5.0L / 7 * 3 * 2, 1e-17L);
    ASSERT_EQ(truth.contact_intervals.size(), 1U);
    EXPECT_EQ(truth.contact_intervals[0].mode, "rolling");
    EXPECT_NEAR(truth.contact_intervals[0].largest_ratio, 2.0 / 7 * 3 / (0.3 * 9), 1e-14);
    EXPECT_TRUE(truth.contact_events.empty());
    expect_close(value(truth.reactions[1][0]), -2.0L / 7 * 2 * 3, 1e-17L);
    expect_close(value(truth.reactions[1][2]), 18, 1e-16L);
}

/// At tan a = 7/2 mu rolling needs exactly the limit of friction and the laws of rolling and sliding agree: released
/// from rest, the ball rolls with 5/7 g sin a = 5. A ball that moves up the slope without rotation starts to roll at
/// t = u_0 / (7 g sin a); one that moves down keeps its slip.
TEST(ContactReference, BallRollsWhereItNeedsTheLimitOfFriction) {
    const std::string gravity = "[7, 0, -8]", plane = R"("restitution": 0, "friction": 0.25)";
    const auto start = [](const std::string& speed) {
        return R"({"position": [0, 0, 0.5], "velocity": [)" + speed + ", 0, 0]}";
    };
    const DecimalReference released = available(contact_scene(solid_ball, start("0"), gravity, plane, 2));
    expect_close(value(released.columns[2][10]), 10, 1e-17L);
    ASSERT_EQ(released.contact_intervals.size(), 1U);
    EXPECT_EQ(released.contact_intervals[0].mode, "rolling");
    EXPECT_NEAR(released.contact_intervals[0].largest_ratio, 1, 1e-14);
    // du/dt = g sin a + 7/2 mu g cos a = 14
    const DecimalReference up = available(contact_scene(solid_ball, start("-7"), gravity, plane, 2));
    ASSERT_EQ(up.contact_events.size(), 1U);
    EXPECT_EQ(up.contact_events[0].event, "rolls");
    expect_close(value(up.contact_events[0].t), 0.5L, 1e-18L);
    // 9 m/s^2 for 0.5 s, then 5 m/s^2
    expect_close(value(up.columns[2][10]), -7 + 4.5L + 7.5L, 1e-17L);
    const DecimalReference down = available(contact_scene(solid_ball, start("1"), gravity, plane, 2));
    EXPECT_TRUE(down.contact_events.empty());
    expect_close(value(down.columns[2][10]), 11, 1e-16L);
    Settings settings;
    settings.samples = 2;
    const Trajectory run =
        solve(contact_scene(solid_ball, start("0"), gravity, plane, 2), *find_method("taylor"), settings);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    EXPECT_NEAR(run.samples[2].velocity_W[0], 10, 1e-12);
}

/// A sliding ball rolls from t = 2 |u_0| / (7 mu g) on, with v = (5 v_0 + 2 r w_0 x n) / 7 (Hopkins and Patterson 1977,
/// Am. J. Phys. 45, 263).
TEST(ContactReference, SlidingBallStartsToRoll) {
    const Scene scene =
        contact_scene(solid_ball, R"({"position": [0, 0, 0.5], "velocity": [4, 0, 0], "angular_velocity": [3, 0, 5]})",
                      "[0, 0, -10]", R"("restitution": 0.5, "friction": 0.25)", 2);
    const DecimalReference truth = available(scene);
    ASSERT_EQ(truth.contact_events.size(), 1U);
    EXPECT_EQ(truth.contact_events[0].event, "rolls");
    expect_close(value(truth.contact_events[0].t), 2 * std::sqrt(16 + 2.25L) / (7 * 0.25L * 10), 1e-18L);
    // w_0 x n = (0, -3, 0) up to the spin; r = 0.5
    expect_close(value(truth.columns[2][10]), 20.0L / 7, 1e-17L);
    expect_close(value(truth.columns[2][11]), -3.0L / 7, 1e-17L);
    expect_close(value(truth.columns[2][6]), 5, 1e-16L);
}

/// Impacts of a ball dropped from the height h end at t_1 + 2 v_1 / g e / (1 - e), with v_1 = sqrt(2 g h).
TEST(ContactReference, BouncingBallComesToRoll) {
    const Scene scene =
        contact_scene(solid_ball, R"({"position": [0, 0, 1.5], "velocity": [1, 0, 0], "angular_velocity": [3, 0, 5]})",
                      "[0, 0, -10]", R"("restitution": 0.5, "friction": 0.25)", 4);
    const DecimalReference truth = available(scene);
    const long double first = std::sqrt(0.2L), limit = first + 2 * first;
    ASSERT_FALSE(truth.contact_events.empty());
    EXPECT_EQ(truth.contact_events.front().event, "impact");
    expect_close(value(truth.contact_events.front().t), first, 1e-18L);
    // normal impulse m (1 + e) v_1
    expect_close(value(truth.contact_events.front().normal_impulse), 3 * 10 * first, 1e-16L);
    EXPECT_EQ(truth.contact_events.back().event, "accumulates");
    expect_close(value(truth.contact_events.back().t), limit, 1e-18L);
    EXPECT_EQ(truth.contact_intervals.back().mode, "rolling");
    expect_close(value(truth.columns[2][10]), 5.0L / 7, 1e-17L);
    expect_close(value(truth.columns[2][11]), -3.0L / 7, 1e-17L);
}

/// Where an impact of a tilted disc reverses the slip or leaves its direction, all speeds at the contact scale with the
/// approach, and the impulses decrease by a constant ratio near the limit of the impacts.
TEST(ContactReference, ImpactsOfADiscAccumulateWithAConstantRatio) {
    const Scene scene =
        contact_scene(R"({"shape": {"type": "cylinder", "radius": 0.5, "half_height": 0.0625}, "mass": 2})",
                      R"({"orientation": [0.6, 0.8, 0, 0], "position": [0, 0, 0.75], "angular_velocity": [0, 0, 6]})",
                      "[0, 0, -10]", R"("restitution": 0.5, "friction": 0.5)", 1);
    const DecimalReference truth = available(scene, 4);
    std::vector<long double> impulses;
    bool accumulates = false;
    for (const DecimalContactEvent& event : truth.contact_events) {
        if (event.event == "accumulates") accumulates = true;
        if (accumulates || event.event != "impact") continue;
        const long double impulse = value(event.normal_impulse);
        if (impulse < 1e-9L && impulse > 1e-14L) impulses.push_back(impulse);
    }
    EXPECT_TRUE(accumulates);
    ASSERT_GE(impulses.size(), 5U);
    const long double ratio = impulses[1] / impulses[0];
    for (std::size_t i = 1; i < impulses.size(); ++i) expect_close(impulses[i] / impulses[i - 1], ratio, 1e-7L);
}

// The impulses of a tumbling box without friction change its momentum:
// m v = m v_0 + m g t + sum of J.
TEST(ContactReference, BoxWithoutFrictionBounces) {
    const Scene scene =
        contact_scene(R"({"shape": {"type": "box", "half_extents": [0.25, 0.125, 0.0625]}, "mass": 2})",
                      R"({"position": [0, 0, 0.75], "velocity": [0.5, 0, -1], "angular_velocity": [3, -2, 1]})",
                      "[0, 0, -10]", R"("offset": 0, "restitution": 0.75)", 1);
    const DecimalReference truth = available(scene);
    ASSERT_GE(truth.contact_events.size(), 2U);
    long double impulses = 0;
    for (const DecimalContactEvent& event : truth.contact_events) {
        EXPECT_EQ(event.event, "impact");
        EXPECT_GT(value(event.normal_impulse), 0);
        impulses += value(event.normal_impulse);
    }
    constexpr std::size_t vx = 10;
    expect_close(value(truth.columns[2][vx]), 0.5L, 1e-18L);
    expect_close(2 * value(truth.columns[2][vx + 2]), -2 - 20 + impulses, 1e-16L);
}

/// At loose tolerances the slip of an impact ends as well, after few steps.
TEST(ContactReference, LooseTolerancesFollowImpactsWithSlip) {
    const Scene scene =
        contact_scene(solid_ball, R"({"position": [0, 0, 1.5], "velocity": [1, 0, 0], "angular_velocity": [3, 0, 5]})",
                      "[0, 0, -10]", R"("restitution": 0.9, "friction": 0.5)", 1);
    const DecimalReference truth = available(scene);
    for (const char* name : {"taylor", "dop853", "cvode_adams"})
        for (const double tolerance : {1e-3, 1e-4, 1e-5}) {
            Settings settings;
            settings.tolerance = tolerance, settings.samples = 2;
            const Trajectory run = solve(scene, *find_method(name), settings);
            ASSERT_EQ(run.status, Status::ok) << name << ": " << run.message;
            EXPECT_LT(run.steps, 1000) << name << " " << tolerance;
            expect_close(run.samples[2].position_W[0], value(truth.columns[2][7]), 10 * tolerance);
        }
}

/// Reactions of samples that lie at the start of the motion: a block slides on a floor, a ball rolls down a slope.
TEST(ContactReference, ReactionsAtTheStartAreThoseOfTheMode) {
    const DecimalReference slides =
        available(contact_scene(R"({"shape": {"type": "box", "half_extents": [1, 1, 0.5]}, "mass": 2})",
                                R"({"position": [0, 0, 0.5], "velocity": [2, 0, 0]})", "[0, 0, -9]",
                                R"("restitution": 0, "friction": 0.5)", 1));
    ASSERT_EQ(slides.reactions.size(), 3U);
    expect_close(value(slides.reactions[0][2]), 18, 1e-17L);
    expect_close(value(slides.reactions[0][0]), -9, 1e-17L);
    const DecimalReference rolls = available(contact_scene(solid_ball, R"({"position": [0, 0, 0.5]})", "[3, 0, -9]",
                                                           R"("restitution": 0, "friction": 0.5)", 1));
    for (const ReactionDecimals& reaction : rolls.reactions) {
        expect_close(value(reaction[2]), 18, 1e-17L);
        expect_close(value(reaction[0]), -2.0L / 7 * 6, 1e-17L);
    }
}

/// A rolling ellipsoid keeps its energy: m v^2 / 2 + w I w / 2 + m g z.
TEST(ContactReference, RollingEllipsoidKeepsItsEnergy) {
    const Scene scene =
        contact_scene(R"({"shape": {"type": "ellipsoid", "semi_axes": [0.5, 0.375, 0.25]}, "mass": 2})",
                      R"({"position": [0, 0, 0.25], "velocity": [0.5, 0.25, 0], "angular_velocity": [-1, 2, 0.25]})",
                      "[0, 0, -10]", R"("restitution": 0.5, "friction": 2)", 1);
    const DecimalReference truth = available(scene, 8);
    ASSERT_EQ(truth.contact_intervals.size(), 1U);
    EXPECT_EQ(truth.contact_intervals[0].mode, "rolling");
    const Reference reference_ = reference(scene, 8);
    for (const ReferenceSample& sample : reference_.samples) {
        EXPECT_EQ(sample.energy.high, reference_.samples.front().energy.high);
        EXPECT_NEAR(sample.energy.low, reference_.samples.front().energy.low, 1e-24);
    }
}

/// An ellipsoid whose friction does not suffice for rolling starts to slip while it rolls, and rolls again. The method
/// taylor follows the same events in binary64.
TEST(ContactReference, EllipsoidSlipsWhileItRolls) {
    const Scene scene =
        contact_scene(R"({"shape": {"type": "ellipsoid", "semi_axes": [0.5, 0.4, 0.3]}, "mass": 2})",
                      R"({"position": [0, 0, 0.3], "velocity": [1, 0.5, 0], "angular_velocity": [0.5, 3, 0.25]})",
                      "[0, 0, -10]", R"("restitution": 0.5, "friction": 0.25)", 1.25);
    const DecimalReference truth = available(scene);
    std::string events;
    for (const DecimalContactEvent& event : truth.contact_events) events += event.event + " ";
    EXPECT_EQ(events, "rolls slides rolls ");
    Settings settings;
    settings.tolerance = 1e-12, settings.samples = 2;
    const Trajectory run = solve(scene, *find_method("taylor"), settings);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    for (std::size_t i = 0; i < 3; ++i) {
        expect_close(run.samples[2].position_W[i], value(truth.columns[2][7 + i]), 1e-10L);
        expect_close(run.samples[2].velocity_W[i], value(truth.columns[2][10 + i]), 1e-10L);
    }
}

/// Jellett's constant: L . r of an axisymmetric body with a spherical tip, r from the centre of mass to the contact
/// (Gray and Nickel 2000, Am. J. Phys. 68, 821).
TEST(ContactReference, TippeTopKeepsJellettsConstant) {
    const Scene scene = contact_scene(
        R"({"parts": [{"shape": {"type": "sphere", "radius": 0.5}, "mass": 1},
                      {"shape": {"type": "sphere", "radius": 0.125}, "mass": 1, "position": [0, 0, -0.25]}]})",
        R"({"orientation": [0.96, 0.28, 0, 0], "position": [0, 0.0672, 0.39465], "angular_velocity": [0, 0, 20]})",
        "[0, 0, -10]", R"("restitution": 0, "friction": 0.25)", 0.5);
    const Reference truth = reference(scene, 4);
    ASSERT_TRUE(truth.available) << truth.message;
    std::vector<double> jellett;
    for (const ReferenceSample& sample : truth.samples) {
        const Sample s = sample.rounded();
        // the centre of the tip is 0.125 above the centre of mass
        const Vector3<double> r = rotate(s.q, Vector3<double>(0, 0, 0.125)) - Vector3<double>(0, 0, 0.5);
        const Vector3<double> L(sample.angular_momentum_W[0].high, sample.angular_momentum_W[1].high,
                                sample.angular_momentum_W[2].high);
        // the top falls from a small height first
        if (s.t > 0.1) jellett.push_back(dot(L, r));
    }
    ASSERT_EQ(jellett.size(), 4U);
    for (double j : jellett) EXPECT_NEAR(j, jellett.front(), 1e-14);
}

std::string refusal_of(const std::string& body, const std::string& initial, const std::string& planes) {
    const std::string gravity = "[0, 0, -9]", plane = R"("restitution": 0.5, "friction": 0.5)" + planes;
    return decimal_reference(contact_scene(body, initial, gravity, plane, 2), 2).message;
}

TEST(ContactReference, NamesWhatItDoesNotFollow) {
    const std::string flat = R"({"shape": {"type": "box", "half_extents": [1, 1, 0.5]}, "mass": 2})";
    EXPECT_EQ(refusal_of(flat, R"({"position": [0, 0, 0.5], "angular_velocity": [0, 0, 1]})", ""),
              "no truth: spins on a face at t = 0 s: the pressure under a face is not determined by rigid laws");
    // tilted about x: the box stands on an edge, and rotates about the normal
    const std::string cube = R"({"shape": {"type": "box", "half_extents": [0.7, 0.1, 0.1]}, "mass": 2})";
    EXPECT_EQ(
        refusal_of(cube, R"({"orientation": [0.8, 0.6, 0, 0], "position": [0, 0, 0.124], "angular_velocity": [0, 0, 1],
                             "angular_velocity_frame": "world"})",
                   ""),
        "no truth: touches plane 1 along an edge at t = 0 s: the forces at two points are not determined by rigid "
        "laws");
    EXPECT_EQ(
        refusal_of(solid_ball, R"({"position": [0, 0, 0.5]})",
                   R"(}, {"normal": [-0.8, 0, 0.6], "offset": -0.2, "restitution": 0, "friction": 0.5, "name": "a"},
                            {"normal": [0.8, 0, 0.6], "offset": -0.2, "restitution": 0, "friction": 0.5, "name": "b")"),
        "no truth: lasting contacts with several planes are not supported: the body touches plane 1 and a at "
        "t = 0 s");
}

/// A block that slides on a face stops at t = v / (mu g) after v^2 / (2 mu g), if mu h < a for the half edge a and the
/// height h of the centre of mass; otherwise it tips over.
TEST(ContactReference, BlockOnAFaceStopsOrTipsOver) {
    const std::string plane = R"("restitution": 0.5, "friction": 0.5)";
    const std::string start = R"({"position": [0, 0, 0.5], "velocity": [2, 0, 0]})";
    const DecimalReference truth = available(contact_scene(
        R"({"shape": {"type": "box", "half_extents": [1, 1, 0.5]}, "mass": 2})", start, "[0, 0, -9]", plane, 1));
    ASSERT_EQ(truth.contact_events.size(), 1U);
    expect_close(value(truth.contact_events[0].t), 4.0L / 9, 1e-18L);
    expect_close(value(truth.columns[2][7]), 4.0L / 9, 1e-18L);
    expect_close(value(truth.columns[2][10]), 0, 1e-18L);
    const Scene high = contact_scene(R"({"shape": {"type": "box", "half_extents": [0.125, 1, 0.5]}, "mass": 2})", start,
                                     "[0, 0, -9]", plane, 1);
    EXPECT_EQ(decimal_reference(high, 2).message, "no truth: tips over at t = 0 s");
}

}  // namespace
}  // namespace polhode
