// Torsional and rolling friction of planes in the reference, compared with closed forms of balls.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/method.h"
#include "integrators/truth/reference.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

// A solid ball: radius 1/2 m, 2 kg, moment 1/5 kg m^2, and 7/10 kg m^2 about the contact point.
Scene ball_scene(const std::string& initial, const std::string& gravity, const std::string& coefficients,
                 double duration,
                 const std::string& body = R"({"shape": {"type": "sphere", "radius": 0.5}, "mass": 2})") {
    return parse_scene(R"({"name": "ball", "duration": )" + std::to_string(duration) + R"(, "body": )" + body +
                           R"(, "initial": {"position": [0, 0, 0.5], )" + initial +
                           R"(}, "loads": [{"type": "gravity", "acceleration": )" + gravity +
                           R"(}], "planes": [{"normal": [0, 0, 1], "restitution": 0.5, )" + coefficients + "}]}",
                       "test");
}

DecimalReference available_reference(const Scene& scene, long samples = 2) {
    DecimalReference truth = decimal_reference(scene, samples, 25);
    EXPECT_TRUE(truth.available) << truth.message;
    EXPECT_LE(truth.bound, 1e-24);
    return truth;
}

long double number(const std::string& decimal) { return std::stold(decimal); }

// EXPECT_NEAR compares in double, which has fewer digits than the reference
void expect_equal(const std::string& decimal, long double expected) {
    EXPECT_LE(std::abs(number(decimal) - expected), 1e-17L * std::max(1.0L, std::abs(expected)))
        << decimal << " instead of " << static_cast<double>(expected);
}

std::string events_of(const DecimalReference& truth) {
    std::string events;
    for (const DecimalContactEvent& event : truth.contact_events) events += event.event + " ";
    return events;
}

const char* const both_frictions = R"("friction": 0.5, "rolling_friction": 0.03125, "torsional_friction": 0.0625)";

/// On level ground the spin decays at sigma N / I and the rolling velocity at rho N / (I + m r^2).
TEST(RotationFriction, RollingBallStops) {
    const Scene scene =
        ball_scene(R"("velocity": [1, 0, 0], "angular_velocity": [0, 2, 3])", "[0, 0, -10]", both_frictions, 4);
    const DecimalReference truth = available_reference(scene, 10);
    ASSERT_EQ(events_of(truth), "spin_stops stops ");
    const long double spin_rate = 0.0625L * 20 / 0.2L, rate = 0.03125L * 20 / 0.7L;
    expect_equal(truth.contact_events[0].t, 3 / spin_rate);
    expect_equal(truth.contact_events[1].t, 2 / rate);
    // at 2 s: v = 1 - rate r t; at the end: the distance v^2 / (2 rate r)
    expect_equal(truth.columns[5][10], 1 - rate);
    expect_equal(truth.columns[10][7], 1 / rate);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(number(truth.columns[10][4 + i]), 0);
        EXPECT_EQ(number(truth.columns[10][10 + i]), 0);
    }
    ASSERT_EQ(truth.contact_intervals.size(), 3U);
    EXPECT_EQ(truth.contact_intervals[0].mode, "rolling");
    EXPECT_EQ(truth.contact_intervals[1].mode, "rolling_without_spin");
    EXPECT_EQ(truth.contact_intervals[2].mode, "resting");
    // torque about the contact point: -sigma N about the normal, -rho N against the rolling velocity
    expect_equal(truth.reactions[1][5], -0.0625L * 20);
    expect_equal(truth.reactions[5][4], -0.03125L * 20);
}

/// A ball at rest on a slope starts to roll if tan a > rho / r. It then accelerates by r (m g_x r - rho N) / (I + m
/// r^2).
TEST(RotationFriction, BallOnASlopeStartsAboveTheLimit) {
    const std::string start = R"("velocity": [0, 0, 0])";
    const DecimalReference rests = available_reference(ball_scene(start, "[0.62, 0, -10]", both_frictions, 2));
    ASSERT_EQ(rests.contact_intervals.size(), 1U);
    EXPECT_EQ(rests.contact_intervals[0].mode, "resting");
    EXPECT_EQ(number(rests.columns[2][7]), 0);
    // the moment of the weight about the contact point, held by the plane
    expect_equal(rests.reactions[1][4], -0.62 * 2 / 2.0L);
    const DecimalReference rolls = available_reference(ball_scene(start, "[0.75, 0, -10]", both_frictions, 2));
    ASSERT_EQ(rolls.contact_intervals.size(), 1U);
    EXPECT_EQ(rolls.contact_intervals[0].mode, "rolling_without_spin");
    expect_equal(rolls.columns[2][10], 0.5L * (0.75L - 0.625L) / 0.7L * 2);
}

/// A ball that rolls across a slope: with the angle psi between the velocity and the fall line, v sin psi =
/// v_0 tan(psi / 2)^k, k = rho N r / (I + m r^2) / (5/7 g_x), as for a block with friction.
TEST(RotationFriction, BallTurnsDownASlope) {
    const Scene scene =
        ball_scene(R"("velocity": [0, 1, 0], "angular_velocity": [-2, 0, 3])", "[0.5, 0, -10]", both_frictions, 4);
    const DecimalReference truth = available_reference(scene);
    const long double k = (0.625L * 0.5L / 0.7L) / (5.0L / 7 * 0.5L);
    for (std::size_t i = 1; i <= 2; ++i) {
        const long double vx = number(truth.columns[i][10]), vy = number(truth.columns[i][11]);
        const long double tangent = vy / (std::hypot(vx, vy) + vx);
        EXPECT_LE(std::abs(vy - std::pow(tangent, k)), 1e-17L);
    }
}

/// While a ball without initial rotation slides, rolling friction opposes its rolling velocity: the slip decreases by
/// mu g (1 + m r^2 / I) - rho m g r / I.
TEST(RotationFriction, SlidingBallStartsToRoll) {
    const Scene scene =
        ball_scene(R"("velocity": [4, 0, 0])", "[0, 0, -10]", R"("friction": 0.25, "rolling_friction": 0.03125)", 7);
    const DecimalReference truth = available_reference(scene);
    ASSERT_EQ(events_of(truth), "rolls stops ");
    const long double rolls = 4 / (2.5L * 3.5L - 0.03125L * 20 * 0.5L / 0.2L);
    expect_equal(truth.contact_events[0].t, rolls);
    const long double w = (4 - 2.5L * rolls) / 0.5L;
    expect_equal(truth.contact_events[1].t, rolls + w / (0.625L / 0.7L));
    Settings settings;
    settings.tolerance = 1e-12, settings.samples = 2;
    const Trajectory run = solve(scene, *find_method("taylor"), settings);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    for (std::size_t i = 0; i <= 2; ++i)
        EXPECT_NEAR(run.samples[i].position_W[0], static_cast<double>(number(truth.columns[i][7])), 1e-10);
}

/// A ball at rest on a steep slope starts to slide and to roll at once: a = g_x - mu N / m.
TEST(RotationFriction, SlidingAndRollingStartTogether) {
    const Scene scene =
        ball_scene(R"("velocity": [0, 0, 0])", "[10, 0, -5]", R"("friction": 0.25, "rolling_friction": 0.03125)", 2);
    const DecimalReference truth = available_reference(scene);
    ASSERT_EQ(truth.contact_intervals.size(), 1U);
    EXPECT_EQ(truth.contact_intervals[0].mode, "sliding");
    expect_equal(truth.columns[2][10], (10 - 1.25L) * 2);
    expect_equal(truth.columns[2][5], (2.5L * 0.5L - 0.3125L) / 0.2L * 2);
}

/// A rolling velocity that changes its sign while the ball slides is not held, because sliding friction turns the ball
/// more strongly than rolling friction can hold it. Without sliding friction it is held.
TEST(RotationFriction, RollingVelocityPassesThroughZero) {
    const Scene scene = ball_scene(R"("velocity": [4, 0, 0], "angular_velocity": [0, -2, 0])", "[0, 0, -10]",
                                   R"("friction": 0.25, "rolling_friction": 0.03125)", 0.5);
    const DecimalReference truth = available_reference(scene, 1);
    ASSERT_EQ(events_of(truth), "");
    const long double drive = 2.5L * 2 * 0.5L, opposing = 0.625L, zero = 2 * 0.2L / (drive + opposing);
    expect_equal(truth.columns[1][5], (drive - opposing) / 0.2L * (0.5L - zero));
    const Scene smooth = ball_scene(R"("velocity": [1, 0, 0], "angular_velocity": [0, 2, 0])", "[0, 0, -10]",
                                    R"("friction": 0, "rolling_friction": 0.03125)", 2);
    const DecimalReference held = available_reference(smooth, 1);
    ASSERT_EQ(events_of(held), "rolling_stops ");
    expect_equal(held.contact_events[0].t, 2 * 0.2L / 0.625L);
    EXPECT_EQ(held.contact_intervals.back().mode, "sliding_without_rolling");
}

/// A torque about the normal above sigma N spins a ball that rests: (tau - sigma N) / I, then -sigma N / I. Below the
/// limit the ball stays at rest.
TEST(RotationFriction, TorqueSpinsABallAtRest) {
    const std::string start = R"("velocity": [0, 0, 0])";
    const auto with_torque = [](const std::string& torque) {
        return R"([0, 0, -10]}, {"type": "torque", "frame": "world", "from": 0.5, "until": 2, "vector": [0, 0, )" +
               torque + "]";
    };
    const DecimalReference spins = available_reference(ball_scene(start, with_torque("2"), both_frictions, 4));
    ASSERT_EQ(events_of(spins), "spin_starts stops ");
    const long double limit = 0.0625L * 20, rate = (2 - limit) / 0.2L * 1.5L;
    expect_equal(spins.columns[1][6], rate);
    expect_equal(spins.contact_events[1].t, 2 + rate / (limit / 0.2L));
    ASSERT_EQ(spins.contact_intervals.size(), 3U);
    EXPECT_EQ(spins.contact_intervals[0].mode, "resting");
    EXPECT_EQ(spins.contact_intervals[1].mode, "spinning");
    EXPECT_EQ(spins.contact_intervals[2].mode, "resting");
    EXPECT_EQ(spins.contact_intervals[2].largest_ratio, 0);
    const DecimalReference rests = available_reference(ball_scene(start, with_torque("1.2"), both_frictions, 1));
    EXPECT_EQ(events_of(rests), "");
    expect_equal(rests.reactions[2][5], -1.2);
}

/// A spheroid that spins upright slows down at sigma N / I about its axis; a sphere with three different moments that
/// rolls about a principal axis slows down at rho N / (I + m r^2).
TEST(RotationFriction, StopsBodiesThatAreNoBalls) {
    const DecimalReference spins = available_reference(
        ball_scene(R"("angular_velocity": [0, 0, 3])", "[0, 0, -10]", both_frictions, 2,
                   R"({"shape": {"type": "ellipsoid", "semi_axes": [0.75, 0.75, 0.5]}, "mass": 2})"));
    ASSERT_EQ(events_of(spins), "stops ");
    expect_equal(spins.contact_events[0].t, 3 / (0.0625L * 20 / 0.45L));
    const DecimalReference rolls = available_reference(ball_scene(
        R"("velocity": [1, 0, 0], "angular_velocity": [0, 2, 0])", "[0, 0, -10]", both_frictions, 4,
        R"({"mass": 2, "inertia": [0.25, 0.375, 0.3125], "contact_shape": {"type": "sphere", "radius": 0.5}})"));
    ASSERT_EQ(events_of(rolls), "stops ");
    const long double rate = 0.03125L * 20 / (0.375L + 2 * 0.25L);
    expect_equal(rolls.contact_events[0].t, 2 / rate);
    expect_equal(rolls.columns[2][7], 1 / rate);
}

/// A tumbling ellipsoid slides, rolls and comes to rest; it does not gain energy on the way.
TEST(RotationFriction, EllipsoidLosesEnergyUntilItRests) {
    const Scene scene =
        ball_scene(R"("velocity": [0.5, 0.25, 0], "angular_velocity": [1, 2, 3])", "[0, 0, -10]", both_frictions, 6,
                   R"({"shape": {"type": "ellipsoid", "semi_axes": [0.75, 0.625, 0.5]}, "mass": 2})");
    available_reference(scene, 12);
    const Reference truth = reference(scene, 60);
    for (std::size_t i = 1; i < truth.samples.size(); ++i)
        EXPECT_LE(truth.samples[i].energy.high, truth.samples[i - 1].energy.high + 1e-14);
    EXPECT_EQ(truth.samples.back().energy.high, truth.samples[truth.samples.size() - 2].energy.high);
    Settings settings;
    settings.tolerance = 1e-11, settings.samples = 60;
    for (const char* method : {"taylor", "dop853"}) {
        const Trajectory run = solve(scene, *find_method(method), settings);
        ASSERT_EQ(run.status, Status::ok) << method << ": " << run.message;
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_NEAR(run.samples.back().position_W[i], truth.samples.back().rounded().position_W[i], 1e-8) << method;
    }
}

}  // namespace
}  // namespace polhode
