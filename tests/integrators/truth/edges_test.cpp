// Contact along an edge in planar motion: cylinders and capsules on their sides, a box on an edge; closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "integrators/method.h"
#include "integrators/truth/reference.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

constexpr std::size_t place_x = 7, rate_w = 4, rate_x = 10;

// `gravity`: the plane z = 0 is inclined if it has a component along x
Scene edge_scene(const std::string& shape, const std::string& initial, const std::string& gravity, double friction,
                 const std::string& more = "") {
    return parse_scene(
        R"({"name": "edge", "duration": 1, "body": {"shape": )" + shape + R"(, "mass": 2}, "initial": )" + initial +
            R"(, "loads": [{"type": "gravity", "acceleration": )" + gravity +
            R"(}], "planes": [{"normal": [0, 0, 1], "offset": 0, "name": "floor", "restitution": 0.5, )" + more +
            R"("friction": )" + std::to_string(friction) + "}]}",
        "edge.json");
}
// a cylinder whose axis is parallel to y
const std::string lying_cylinder = R"({"type": "cylinder", "radius": 0.125, "half_height": 0.25})";
std::string lying(const std::string& more = "") {
    return R"({"orientation": [0.7071067811865476, 0.7071067811865476, 0, 0], "position": [0, 0, 0.125])" + more + "}";
}
DecimalReference edge_truth(const Scene& scene) {
    DecimalReference truth = decimal_reference(scene, 2, 22);
    EXPECT_TRUE(truth.available) << truth.message;
    EXPECT_LE(truth.bound, 1e-21);
    for (const char* name : {"taylor", "dop853", "cvode_bdf"}) {
        Settings settings;
        settings.samples = 2, settings.tolerance = 1e-10;
        const Trajectory run = solve(scene, *find_method(name), settings);
        EXPECT_EQ(run.status, Status::ok) << name << ": " << run.message;
        if (run.samples.size() < 3 || !truth.available) continue;
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(run.samples[2].position_W[axis],
                        std::stod(truth.columns[2][place_x + static_cast<std::size_t>(axis)]), 1e-6)
                << name;
    }
    return truth;
}
void expect_at_edge(const std::string& decimal, long double expected) {
    EXPECT_LE(std::abs(std::stold(decimal) - expected), 1e-18L)
        << decimal << " instead of " << static_cast<double>(expected);
}

// 2/3 g sin a, with |F| / (mu N) = tan a / (3 mu)
TEST(Edges, CylinderRollsDownASlope) {
    const DecimalReference truth = edge_truth(edge_scene(lying_cylinder, lying(), "[3, 0, -9]", 0.25));
    expect_at_edge(truth.columns[2][place_x], 1);
    expect_at_edge(truth.columns[2][rate_x], 2);
    ASSERT_EQ(truth.contact_intervals.size(), 1U);
    EXPECT_EQ(truth.contact_intervals[0].mode, "rolling");
    EXPECT_NEAR(truth.contact_intervals[0].largest_ratio, 4.0 / 9, 1e-14);
}

// tan a > 3 mu: a = g sin a - mu g cos a, and 1/2 m r dw/dt = mu m g cos a
TEST(Edges, CylinderSlidesDownASteepSlope) {
    const DecimalReference truth = edge_truth(edge_scene(lying_cylinder, lying(), "[8, 0, -8]", 0.25));
    expect_at_edge(truth.columns[2][rate_x], 6);
    expect_at_edge(truth.columns[2][rate_w + 1], 32);
}

// The slip v - w r decreases at 3 mu g and ends at v_0 / (3 mu g), v = 2/3 v_0.
TEST(Edges, SlidingCylinderStartsToRoll) {
    const DecimalReference truth =
        edge_truth(edge_scene(lying_cylinder, lying(R"(, "velocity": [3, 0, 0])"), "[0, 0, -8]", 0.25));
    ASSERT_EQ(truth.contact_events.size(), 1U);
    EXPECT_EQ(truth.contact_events[0].event, "rolls");
    expect_at_edge(truth.contact_events[0].t, 0.5L);
    expect_at_edge(truth.columns[2][rate_x], 2);
}

// along its axis, a capsule slides without rotation
TEST(Edges, CapsuleSlidesAlongItsAxis) {
    const DecimalReference truth = edge_truth(edge_scene(R"({"type": "capsule", "radius": 0.125, "half_height": 0.5})",
                                                         lying(R"(, "velocity": [0, 1, 0])"), "[0, 0, -8]", 0.25));
    ASSERT_EQ(truth.contact_events.size(), 1U);
    EXPECT_EQ(truth.contact_events[0].event, "stops");
    expect_at_edge(truth.contact_events[0].t, 0.5L);
    expect_at_edge(truth.columns[2][place_x + 1], 0.25L);
}

// A box that is released on an edge rotates about it: 1/2 (I + m r^2) w^2 = m g (fall of its centre), I = m r^2 / 3.
TEST(Edges, BoxRotatesAboutAnEdge) {
    const long double r = 1.25L;
    Scene scene = edge_scene(R"({"type": "box", "half_extents": [1, 2, 0.75]})",
                             R"({"orientation": [0.96, 0, 0.28, 0], "position": [0, 0, 1.17]})", "[0, 0, -8]", 1);
    scene.duration = 0.25;
    const DecimalReference truth = edge_truth(scene);
    const long double w = std::stold(truth.columns[2][rate_w + 1]), z = std::stold(truth.columns[2][place_x + 2]),
                      start = std::stold(truth.columns[0][place_x + 2]);
    EXPECT_GT(std::abs(w), 0.3L);
    EXPECT_LE(std::abs(2 * r * r / 3 * w * w - 8 * (start - z)), 1e-17L);
}

TEST(Edges, RefusesOtherMotions) {
    const auto has = [](const Scene& scene, const char* text) {
        const std::string fault = decimal_reference(scene, 2, 22).message;
        EXPECT_NE(fault.find(text), std::string::npos) << fault;
    };
    // about the normal
    has(edge_scene(lying_cylinder, lying(R"(, "angular_velocity": [0, 1, 0])"), "[0, 0, -8]", 0.25),
        "touches floor along an edge at t = 0 s");
    // sliding along and across the axis: the pressure is not in the middle, so friction turns the cylinder
    has(edge_scene(lying_cylinder, lying(R"(, "velocity": [1, 1, 0])"), "[0, 0, -8]", 0.25),
        "touches floor along an edge at t = 0 s");
    has(edge_scene(lying_cylinder, lying(), "[0, 0, -8]", 0.25, R"("rolling_friction": 0.001, )"),
        "torsional and rolling friction are not supported there");
    // the friction at half the diameter's height lifts one end
    has(edge_scene(
            R"({"type": "capsule", "radius": 0.5, "half_height": 0.125})",
            R"({"orientation": [0.7071067811865476, 0.7071067811865476, 0, 0], "position": [0, 0, 0.5], "velocity": [0, 1, 0]})",
            "[0, 0, -8]", 0.5),
        "tips over at t = 0 s");
}

}  // namespace
}  // namespace polhode
