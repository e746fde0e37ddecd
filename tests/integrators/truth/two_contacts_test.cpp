// A ball that touches two planes, compared with closed forms. Both formulations of the reference agree to 25 digits.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "integrators/method.h"
#include "integrators/truth/reference.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

constexpr std::size_t place = 7, rate = 10;  // columns of a row of the reference after t

std::string plane_text(const std::string& name, const std::string& normal, double friction, double restitution = 0) {
    return R"({"restitution": )" + std::to_string(restitution) + R"(, "offset": 0, "name": ")" + name +
           R"(", "normal": )" + normal + R"(, "friction": )" + std::to_string(friction) + "}";
}

// gravity is the first load
Scene two_planes_scene(double radius, const std::string& initial, const std::string& loads, const std::string& planes,
                       double duration) {
    return parse_scene(R"({"name": "two planes", "duration": )" + std::to_string(duration) +
                           R"(, "body": {"shape": {"type": "sphere", "radius": )" + std::to_string(radius) +
                           R"(}, "mass": 2}, "initial": )" + initial +
                           R"(, "loads": [{"type": "gravity", "acceleration": )" + loads + R"(], "planes": [)" +
                           planes + "]}",
                       "test");
}

// normals (0, 0.8, 0.6) and (0, -0.8, 0.6); the chord between the contacts is 0.6 r below the centre
Scene gutter_scene(const std::string& velocity, const std::string& gravity, double friction) {
    return two_planes_scene(
        0.375, R"({"position": [0, 0, 0.625], "velocity": )" + velocity + "}", gravity + "}",
        plane_text("left", "[0, 4, 3]", friction) + ", " + plane_text("right", "[0, -4, 3]", friction), 2);
}
// the ball is pressed with 16 N to the floor and 6 N to the wall; 8 N pull it from the wall from t = 3 on
Scene wall_scene(const std::string& initial, const std::string& gravity, double floor, double wall, double duration) {
    return two_planes_scene(
        0.5, initial,
        gravity + R"(}, {"type": "force", "vector": [0, 8, 0], "frame": "world", "point": [0, 0, 0], "from": 3})",
        plane_text("floor", "[0, 0, 1]", floor) + ", " + plane_text("wall", "[0, 1, 0]", wall), duration);
}

DecimalReference truth_of(const Scene& scene) {
    DecimalReference truth = decimal_reference(scene, 2, 25);
    EXPECT_TRUE(truth.available) << truth.message;
    EXPECT_LE(truth.bound, 1e-24);
    return truth;
}
void expect_digits(const std::string& decimal, long double expected, long double tolerance = 1e-17L) {
    EXPECT_LE(std::abs(std::stold(decimal) - expected), tolerance)
        << decimal << " instead of " << static_cast<double>(expected);
}
std::string sequence_of(const DecimalReference& truth) {
    std::string all;
    for (const DecimalContactEvent& event : truth.contact_events)
        all += event.event + " " + std::to_string(event.plane) + ", ";
    return all;
}

/// A solid ball rolls in a gutter about the chord between its contacts, at the height b = 0.6 r below the centre:
/// acceleration g_x / (1 + 2/5 (r/b)^2).
TEST(TwoContacts, BallRollsDownAGutter) {
    const DecimalReference truth = truth_of(gutter_scene("[0, 0, 0]", "[3.5, 0, -9]", 0.5));
    const long double a = 3.5L / (1 + 0.4L / 0.36L);
    expect_digits(truth.columns[2][place], 2 * a);
    expect_digits(truth.columns[2][rate], 2 * a);
    EXPECT_EQ(sequence_of(truth), "");
    ASSERT_EQ(truth.contact_intervals.size(), 2U);
    // N = m g_z / 1.2 and A = m (g_x - a) / 2 at each contact
    for (const DecimalContactInterval& in : truth.contact_intervals) {
        EXPECT_EQ(in.mode, "rolling");
        EXPECT_NEAR(in.largest_ratio, static_cast<double>((3.5L - a) / 2 / (0.5L * 7.5L)), 1e-14);
    }
    // forces of both planes at each time: (-A, +-0.8 N, 0.6 N)
    expect_digits(truth.reactions[2][0], a - 3.5L);
    expect_digits(truth.reactions[2][1], 12, 1e-16L);
    expect_digits(truth.reactions[3][1], -12, 1e-16L);
    expect_digits(truth.reactions[3][2], 9, 1e-16L);
}

/// The angular momentum about the chord is constant: without rotation at first, the ball rolls with v_0 / (1 + 2/5
/// (r/b)^2), from the time on at which the friction 2 mu N has taken the rest.
TEST(TwoContacts, BallStartsToRollInAGutter) {
    const DecimalReference truth = truth_of(gutter_scene("[4, 0, 0]", "[0, 0, -9]", 0.25));
    const long double end = 4 / (1 + 0.4L / 0.36L), rolls = (4 - end) / (0.25L * 15);
    ASSERT_EQ(sequence_of(truth), "rolls 0, rolls 1, ");
    expect_digits(truth.contact_events[0].t, rolls, 1e-18L);
    expect_digits(truth.columns[2][rate], end);
    expect_digits(truth.columns[2][place], rolls * (4 + end) / 2 + (2 - rolls) * end, 1e-16L);
    Settings settings;
    settings.samples = 2;
    const Trajectory run = solve(gutter_scene("[4, 0, 0]", "[0, 0, -9]", 0.25), *find_method("taylor"), settings);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    EXPECT_NEAR(run.samples[2].velocity_W[0], static_cast<double>(end), 1e-12);
}

/// With too little friction the ball slides at both contacts: g_x - 2 mu N / m.
TEST(TwoContacts, BallSlidesDownAGutter) {
    const DecimalReference truth = truth_of(gutter_scene("[0, 0, 0]", "[3.5, 0, -9]", 0.0625));
    expect_digits(truth.columns[2][rate], 2 * (3.5L - 0.0625L * 15));
    ASSERT_EQ(truth.contact_intervals.size(), 2U);
    EXPECT_EQ(truth.contact_intervals[1].mode, "sliding");
    const DecimalReference smooth = truth_of(gutter_scene("[0, 0, 0]", "[3.5, 0, -9]", 0));
    expect_digits(smooth.columns[2][rate], 7);
}

/// Floor and wall. Per unit of mass, the floor rubs with 2 and the wall with 0.375. The slips change by 7/2 of the own
/// friction and 1 of the other one; a contact that rolls transmits 2/7 of the other friction. The slip at the floor
/// ends first. From t = 3 on the ball leaves the wall with 5/7 of 1 m/s^2.
TEST(TwoContacts, BallRollsAtTheFloorThenAtTheWallAndLeavesIt) {
    const DecimalReference truth =
        truth_of(wall_scene(R"({"position": [0, 0.5, 0.5], "velocity": [4, 0, 0]})", "[0, -3, -8]", 0.25, 0.125, 4));
    const long double first = 4 / (7 + 0.375L), slip = 4 - (2 + 3.5L * 0.375L) * first,
                      second = first + slip / (45.0L / 14 * 0.375L), at_first = 4 - 2.375L * first,
                      end = at_first - 5.0L / 7 * 0.375L * (second - first);
    ASSERT_EQ(sequence_of(truth), "rolls 0, rolls 1, lifts_off 1, ");
    expect_digits(truth.contact_events[0].t, first, 1e-18L);
    expect_digits(truth.contact_events[1].t, second, 1e-18L);
    expect_digits(truth.contact_events[2].t, 3, 0);
    expect_digits(truth.columns[2][rate], end);
    expect_digits(truth.columns[2][place + 1], 0.5L + 5.0L / 14);
}

/// The slip passes through zero at one contact after the other, where friction does not suffice for rolling.
TEST(TwoContacts, SlipReversesAtFloorAndWall) {
    const DecimalReference truth =
        truth_of(wall_scene(R"({"position": [0, 0.5, 0.5], "velocity": [-1, 0, 0]})", "[3, -3, -8]", 0.0625, 0.125, 2));
    const long double first = 1 / (3 + 3.5L * 0.5L + 0.375L), slip = 1 - (3.5L + 3.5L * 0.375L) * first,
                      second = first + slip / (3 - 0.5L + 3.5L * 0.375L);
    expect_digits(truth.columns[2][rate], -1 + 3.875L * first + 2.875L * (second - first) + 2.125L * (2 - second));
    EXPECT_EQ(sequence_of(truth), "");
}

/// A ball on a smooth floor lands on the wall with v_y: friction takes mu v_y from its speed and 7/2 mu v_y from its
/// slip, and at the wall it then starts to roll.
TEST(TwoContacts, BallLandsOnTheWall) {
    const DecimalReference truth =
        truth_of(wall_scene(R"({"position": [0, 1.5, 0.5], "velocity": [4, -2, 0]})", "[0, -3.5, -8]", 0, 0.125, 2.5));
    const long double v = std::sqrt(11.0L), arrives = (v - 2) / 3.5L, slip = 4 - 3.5L * 0.125L * v,
                      rolls = slip / (3.5L * 0.125L * 3.5L);
    ASSERT_EQ(sequence_of(truth), "lands 1, rolls 1, ");
    expect_digits(truth.contact_events[0].t, arrives, 1e-18L);
    expect_digits(truth.contact_events[0].normal_impulse, 2 * v, 1e-17L);
    expect_digits(truth.contact_events[0].tangential_impulse[0], -0.25L * v, 1e-17L);
    expect_digits(truth.contact_events[1].t, arrives + rolls, 1e-18L);
    expect_digits(truth.columns[2][rate], 4 - 0.125L * v - 0.4375L * rolls);
}

/// A ball slides on a smooth floor and is pressed to the wall with 3 m/s^2. It arrives at 0.5 s with 1.5 m/s and
/// bounces with e = 0.5, so that the impacts end 1 s later. It then touches both planes.
TEST(TwoContacts, ImpactsOnTheWallAccumulateOnTheFloor) {
    const DecimalReference truth = truth_of(
        two_planes_scene(0.5, R"({"position": [0, 0.875, 0.5], "velocity": [1, 0, 0]})", "[0, -3, -8]}",
                         plane_text("floor", "[0, 0, 1]", 0, 0.5) + ", " + plane_text("wall", "[0, 1, 0]", 0, 0.5), 2));
    ASSERT_GE(truth.contact_events.size(), 50u);
    for (const DecimalContactEvent& event : truth.contact_events) EXPECT_EQ(event.plane, 1u);
    expect_digits(truth.contact_events.front().t, 0.5L, 1e-18L);
    EXPECT_EQ(truth.contact_events.back().event, "accumulates");
    expect_digits(truth.contact_events.back().t, 1.5L, 1e-18L);
    expect_digits(truth.columns[2][place], 2);
    expect_digits(truth.columns[2][place + 1], 0.5L);
}

/// A ball on a smooth floor lands on a smooth wall, to which no load presses it. It slides along the wall; rounding
/// errors of the acceleration are no further events.
TEST(TwoContacts, NothingPressesTheBallToTheWall) {
    const DecimalReference truth = truth_of(two_planes_scene(
        0.5, R"({"position": [1, 0.5, 0.5], "velocity": [-1, 0, 0], "angular_velocity": [1, 2, 3]})", "[0, 0, -8]}",
        plane_text("floor", "[0, 0, 1]", 0) + ", " + plane_text("wall", "[3, 4, 0]", 0), 2));
    ASSERT_EQ(sequence_of(truth).substr(0, 9), "lands 1, ");
    const long double arrives = 5.0L / 6, left = 2 - arrives;
    expect_digits(truth.contact_events[0].t, arrives, 1e-18L);
    expect_digits(truth.columns[2][place], 1 - arrives - 0.64L * left);
    expect_digits(truth.columns[2][place + 1], 0.5L + 0.48L * left);
    EXPECT_LE(truth.contact_events.size(), 2u) << sequence_of(truth);
}

TEST(TwoContacts, UndeterminedMotionsAreNamed) {
    const auto fault = [](const Scene& scene) { return decimal_reference(scene, 2).message; };
    // rolling needs A = 1.0088 mu N here, which the ball pressed between the planes could have
    EXPECT_EQ(fault(gutter_scene("[0, 0, 0]", "[3.8, 0, -9]", 0.1325)),
              "no truth: the friction that presses a ball between two planes is not determined by rigid laws: the ball "
              "touches left and right at t = 0 s");
    EXPECT_EQ(fault(wall_scene(R"({"position": [0, 0.5, 0.5], "angular_velocity": [1, 0, 0]})", "[0, -3, -8]", 0.25,
                               0.125, 2)),
              "no truth: rotation about the line of two planes with friction is not supported: the ball touches floor "
              "and wall at t = 0 s");
}

}  // namespace
}  // namespace polhode
