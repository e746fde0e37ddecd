// The reference of spheres in lasting contact: both formulations agree to 25 digits, compared with closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "integrators/method.h"
#include "integrators/truth/reference.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

constexpr std::size_t touching_place = 7, touching_rate = 10;  // columns of a row of the reference after t

std::string ball_entry(const std::string& name, const std::string& initial) {
    return R"({"name": ")" + name +
           R"(", "body": {"shape": {"type": "sphere", "radius": 0.125}, "mass": 1}, "initial": {)" + initial + "}}";
}
Scene touching_scene(const std::string& bodies, const std::string& more, double duration,
                     const std::string& gravity = "[0, 0, -10]") {
    return parse_scene(R"({"name": "touching", "duration": )" + std::to_string(duration) + R"(, "bodies": [)" + bodies +
                           R"(], "loads": [{"type": "gravity", "acceleration": )" + gravity + "}], " + more + "}",
                       "touching.json");
}
// rows of two bodies at the start, the middle and the end
DecimalReference touching_truth(const Scene& scene) {
    DecimalReference truth = decimal_reference(scene, 2, 25);
    EXPECT_TRUE(truth.available) << truth.message;
    EXPECT_LE(truth.bound, 1e-24);
    return truth;
}
void expect_touching_decimal(const std::string& decimal, long double expected, long double tolerance = 1e-17L) {
    EXPECT_LE(std::abs(std::stold(decimal) - expected), tolerance)
        << decimal << " instead of " << static_cast<double>(expected);
}
std::string kinds_of(const DecimalReference& truth) {
    std::string all;
    for (const DecimalContactEvent& event : truth.contact_events) all += event.event + " ";
    return all;
}

const std::string rough_floor = R"("planes": [{"normal": [0, 0, 1], "offset": 0, "restitution": 0, "friction": 0.25}])";

// A ball that rolls arrives without restitution at a ball at rest, off its centre line.
TEST(TouchingSpheres, RollingBallPushesAnother) {
    const DecimalReference truth = touching_truth(touching_scene(
        ball_entry("a", R"("position": [0, 0.03125, 0.125], "velocity": [1, 0, 0], "angular_velocity": [0, 8, 0])") +
            "," + ball_entry("b", R"("position": [0.5, 0, 0.125])"),
        rough_floor + R"(, "contacts": [{"all": true, "restitution": 0, "friction": 0}])", 2));
    EXPECT_NE(kinds_of(truth).find("lands"), std::string::npos);
    EXPECT_NE(kinds_of(truth).find("lifts_off"), std::string::npos);
    // m v + I w/r of each ball changes only by the force between the balls, and is 7/5 m v while it rolls
    long double sum = 0;
    for (const std::size_t body : {4u, 5u}) sum += std::stold(truth.columns[body][touching_rate]);
    EXPECT_LE(std::abs(sum - 1), 1e-17L);
}

// A ball rolls and slides off another one that rolls on the floor, in space.
TEST(TouchingSpheres, BallFallsOffABall) {
    const DecimalReference truth = touching_truth(
        touching_scene(ball_entry("a", R"("position": [0, 0, 0.125], "angular_velocity": [0, 0, 5])") + "," +
                           ball_entry("b", R"("position": [0.09, 0.12, 0.325])"),
                       rough_floor + R"(, "contacts": [{"all": true, "restitution": 0, "friction": 0.5}])", 0.5));
    EXPECT_NE(kinds_of(truth).find("rolls"), std::string::npos) << kinds_of(truth);
    EXPECT_NE(kinds_of(truth).find("lifts_off"), std::string::npos) << kinds_of(truth);
}

// Forces of 4 N press two balls together from the distance 0.2: impacts end at 3 sqrt(0.05).
TEST(TouchingSpheres, ImpactsAccumulate) {
    const auto push = [](const std::string& body, const std::string& force) {
        return R"({"type": "force", "body": ")" + body + R"(", "frame": "world", "point": [0, 0, 0], "vector": )" +
               force + "}";
    };
    const Scene scene = parse_scene(R"({"name": "pressed", "duration": 1, "bodies": [)" + ball_entry("a", "") + "," +
                                        ball_entry("b", R"("position": [0.45, 0, 0])") + R"(], "loads": [)" +
                                        push("a", "[4, 0, 0]") + "," + push("b", "[-4, 0, 0]") +
                                        R"(], "contacts": [{"all": true, "restitution": 0.5, "friction": 0.25}]})",
                                    "pressed.json");
    const DecimalReference truth = touching_truth(scene);
    ASSERT_FALSE(truth.contact_events.empty());
    EXPECT_EQ(truth.contact_events.back().event, "accumulates");
    const long double apart = static_cast<long double>(0.45) - 0.25L;
    expect_touching_decimal(truth.contact_events.back().t, 3 * std::sqrt(apart / 4));
    expect_touching_decimal(truth.columns[4][touching_place], apart / 2);
}

// A ball falls on a ball that rests on the floor. Each of their impacts, which accumulate, is followed by impacts on
// the floor, which accumulate, too.
TEST(TouchingSpheres, AccumulationsWithinAnAccumulation) {
    const Scene scene = touching_scene(
        ball_entry("a", R"("position": [0, 0, 0.125])") + "," +
            ball_entry("b", R"("position": [0.0625, 0.03125, 0.4375], "angular_velocity": [-1.5, 0.75, 2])"),
        R"("planes": [{"normal": [0, 0, 1], "offset": 0, "restitution": 0.25, "friction": 0.125}],
           "contacts": [{"all": true, "restitution": 0.25, "friction": 0.25}])",
        0.5);
    const DecimalReference truth = decimal_reference(scene, 2, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    EXPECT_LE(truth.bound, 1e-22);
    EXPECT_GE(truth.contact_events.size(), 100u);
    Settings settings;
    settings.samples = 2, settings.tolerance = 1e-10;
    const Trajectory run = solve(scene, *find_method("taylor"), settings);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    for (std::size_t body = 0; body < 2; ++body)
        for (int axis = 0; axis < 3; ++axis) {
            const std::string& exact = truth.columns[4 + body][touching_place + static_cast<std::size_t>(axis)];
            EXPECT_NEAR(run.samples[4 + body].position_W[axis], std::stod(exact), 1e-9);
        }
}

// Checks m v + (I / r) n x w, summed over two balls of mass 1 on a horizontal floor. Smooth impacts between the balls
// and friction on the floor do not change it; gravity along y does.
void expect_momentum(const DecimalReference& truth, double duration, double gravity_y) {
    constexpr std::size_t place_of_rotation = 4;
    constexpr long double moment_by_radius = 0.4L * 0.125L;
    for (std::size_t row = 2; row < 6; row += 2) {
        long double along_x = 0, along_y = 0;
        for (std::size_t body = row; body < row + 2; ++body) {
            const auto& at = truth.columns[body];
            along_x += std::stold(at[touching_rate]) + moment_by_radius * std::stold(at[place_of_rotation + 1]);
            along_y += std::stold(at[touching_rate + 1]) - moment_by_radius * std::stold(at[place_of_rotation]);
        }
        const double time = duration * static_cast<double>(row) / 4;
        EXPECT_LE(std::abs(along_x), 1e-17L);
        EXPECT_LE(std::abs(along_y - 2 * gravity_y * time), 1e-17L);
    }
}

// Each flight of the upper ball contains a limit of impacts on the floor and the end of a slip. The flights shorten to
// 1e-31 s, so errors relative to the size of the scene would exceed their gaps.
TEST(TouchingSpheres, FlightsShortenToALimit) {
    const DecimalReference truth = touching_truth(touching_scene(
        ball_entry("a", R"("position": [0, 0, 0.125])") + "," + ball_entry("b", R"("position": [0.03125, 0, 0.40625])"),
        R"("planes": [{"normal": [0, 0, 1], "offset": 0, "restitution": 0.5, "friction": 0.25}],
           "contacts": [{"all": true, "restitution": 0.5, "friction": 0}])",
        0.5, "[0, 1.25, -10]"));
    EXPECT_GE(truth.contact_events.size(), 1000u);
    expect_momentum(truth, 0.5, 1.25);
}

// Impacts on the upper ball and without restitution on the floor alternate at one instant. The runs may stop after
// different numbers of them.
TEST(TouchingSpheres, ImpactsAlternateAtOneInstant) {
    const DecimalReference truth = touching_truth(touching_scene(
        ball_entry("a", R"("position": [0, 0, 0.125])") + "," + ball_entry("b", R"("position": [0.03125, 0, 0.40625])"),
        R"("planes": [{"normal": [0, 0, 1], "offset": 0, "restitution": 0, "friction": 0.25}],
           "contacts": [{"all": true, "restitution": 0.5, "friction": 0}])",
        0.5, "[0, 1.25, -10]"));
    EXPECT_GE(truth.contact_events.size(), 100u);
    expect_momentum(truth, 0.5, 1.25);
}

// A smooth ball falls between two smooth ones of half its mass, which it pushes apart. All angles to the vertical are
// equal, also for unequal masses, so both contacts open at one instant: where the speed of the lower balls, with
// v^2 = 2 g d cos^2 a (cos a_0 - cos a), is largest, at cos a = 2/3 cos a_0.
TEST(TouchingSpheres, ContactsOpenAtOneInstant) {
    const auto ball = [](const std::string& name, const std::string& mass, const std::string& position) {
        return R"({"name": ")" + name + R"(", "body": {"shape": {"type": "sphere", "radius": 0.15625}, "mass": )" +
               mass + R"(}, "initial": {"position": )" + position + "}}";
    };
    const auto scene = [&](const std::string& second_mass) {
        return touching_scene(ball("a", "1", "[-0.1875, 0, 0.15625]") + "," +
                                  ball("b", second_mass, "[0.1875, 0, 0.15625]") + "," +
                                  ball("c", "2", "[0, 0, 0.40625]"),
                              R"("planes": [{"normal": [0, 0, 1], "offset": 0, "restitution": 0}],
                                 "contacts": [{"all": true, "restitution": 0}])",
                              0.75);
    };
    const DecimalReference truth = touching_truth(scene("1"));
    EXPECT_EQ(kinds_of(truth), "lifts_off lifts_off lands ");
    const long double g = 10, d = 0.3125L, c_0 = 0.8L, c = 2 * c_0 / 3;
    const long double speed = c * std::sqrt(2 * g * d * (c_0 - c)),
                      fall = std::sqrt(2 * g * d * ((1 - c * c) * (c_0 - c) + c));
    expect_touching_decimal(truth.columns[6][touching_rate], -speed);
    expect_touching_decimal(truth.columns[7][touching_rate], speed);
    expect_touching_decimal(truth.contact_events.back().normal_impulse, 2 * fall);
    const Scene unequal = scene("1.5");
    const DecimalReference exact = touching_truth(unequal);
    EXPECT_EQ(kinds_of(exact), "lifts_off lifts_off lands ");
    for (const char* name : {"taylor", "dop853", "cvode_adams"}) {
        Settings settings;
        settings.samples = 2, settings.tolerance = 1e-10;
        const Trajectory run = solve(unequal, *find_method(name), settings);
        ASSERT_EQ(run.status, Status::ok) << name << ": " << run.message;
        for (std::size_t row = 6; row < 9; ++row)
            for (int axis = 0; axis < 3; ++axis)
                EXPECT_NEAR(run.samples[row].position_W[axis],
                            std::stod(exact.columns[row][touching_place + static_cast<std::size_t>(axis)]), 1e-8)
                    << name;
    }
}

}  // namespace
}  // namespace polhode
