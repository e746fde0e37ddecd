// Discs that are parallel to a plane, in the reference and in binary64: closed forms of the first impact after a start
// or a passage through that attitude, rims as faces, and what rigid laws do not determine.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "integrators/method.h"
#include "integrators/truth/reference.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

constexpr std::size_t column_px = 7, column_vx = 10;

Scene rim_scene(const std::string& shape, const std::string& initial, double friction, double restitution,
                double duration = 1) {
    return parse_scene(
        R"({"name": "rim", "duration": )" + std::to_string(duration) + R"(, "body": {"shape": )" + shape +
            R"(, "mass": 2}, "initial": )" + initial +
            R"(, "loads": [{"type": "gravity", "acceleration": [0, 0, -10]}], "planes": [{"normal": [0, )"
            R"(0, 1], "offset": 0, "name": "floor", "restitution": )" +
            std::to_string(restitution) + R"(, "friction": )" + std::to_string(friction) + "}]}",
        "rim.json");
}
const std::string thin_disc = R"({"type": "disc", "radius": 0.25})",
                  upright_cylinder = R"({"type": "cylinder", "radius": 0.25, "half_height": 0.125})";

DecimalReference rim_truth(const Scene& scene) {
    DecimalReference truth = decimal_reference(scene, 2, 22);
    EXPECT_TRUE(truth.available) << truth.message;
    EXPECT_LE(truth.bound, 1e-21);
    return truth;
}
std::string rim_fault(const Scene& scene) { return decimal_reference(scene, 2, 22).message; }
// the zero of a function that falls from `low` to `high`
long double zero_of(const std::function<long double(long double)>& f, long double low, long double high) {
    for (int i = 0; i < 200; ++i) {
        const long double middle = (low + high) / 2;
        (f(middle) > 0 ? low : high) = middle;
    }
    return low;
}
void expect_first_impact(const Scene& scene, long double expected) {
    const DecimalReference truth = rim_truth(scene);
    ASSERT_FALSE(truth.contact_events.empty());
    EXPECT_EQ(truth.contact_events.front().event, "impact");
    EXPECT_LE(std::abs(std::stold(truth.contact_events.front().t) - expected), 1e-18L);
    Scene one_impact = scene;
    one_impact.duration = std::stod(truth.contact_events.front().t) + 1e-3;
    const DecimalReference exact = rim_truth(one_impact);
    for (const char* name : {"taylor", "dop853", "radau", "cvode_adams"}) {
        Settings settings;
        settings.samples = 2, settings.tolerance = 1e-10;
        const Trajectory run = solve(one_impact, *find_method(name), settings);
        ASSERT_EQ(run.status, Status::ok) << name << ": " << run.message;
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(run.samples[2].velocity_W[axis],
                        std::stod(exact.columns[2][column_vx + static_cast<std::size_t>(axis)]), 1e-6)
                << name;
    }
}

// The axis of a free axisymmetric body rotates about the constant angular momentum at the rate L / I_t, so the height
// of the lowest point of a cylinder is known: z - h |a_z| - R sqrt(1 - a_z^2).
TEST(FlatRims, CylinderStartsParallelToTheFloor) {
    const long double m = 2, R = 0.25L, h = 0.125L, g = 10;
    const long double along = m * R * R / 2, across = m * (3 * R * R + 4 * h * h) / 12;
    const long double Lx = across, Ly = 2 * across, Lz = 3 * along, L2 = Lx * Lx + Ly * Ly + Lz * Lz,
                      rate = std::sqrt(L2) / across;
    const auto gap = [&](long double t) {
        const long double a = Lz * Lz / L2 + (1 - Lz * Lz / L2) * std::cos(rate * t);
        return 1 - g * t * t / 2 - h * std::abs(a) - R * std::sqrt(1 - a * a);
    };
    expect_first_impact(
        rim_scene(upright_cylinder, R"({"position": [0, 0, 1], "angular_velocity": [1, 2, 3]})", 0.25, 0.5),
        zero_of(gap, 0.2L, 0.45L));
}

// A disc that rotates about a diameter passes through the attitude parallel to the floor before the first impact.
TEST(FlatRims, DiscPassesThroughParallelAttitudes) {
    const auto gap = [](long double t) { return 1 - 5 * t * t - 0.25L * std::abs(std::sin(10 * t)); };
    expect_first_impact(
        rim_scene(thin_disc, R"({"position": [0, 0, 1], "angular_velocity": [10, 0, 0]})", 0.25, 0.5, 0.5),
        zero_of(gap, 0.35L, 0.44L));
}

// v_0^2 / (2 mu g) to the stop
TEST(FlatRims, BodiesSlideOnTheirRims) {
    for (const std::string& shape :
         {upright_cylinder, std::string(R"({"type": "torus", "major_radius": 0.25, "minor_radius": 0.125})"),
          std::string(R"({"type": "cone", "radius": 0.25, "height": 0.5})")}) {
        const Scene scene = rim_scene(shape, R"({"position": [0, 0, 0.125], "velocity": [1.5, 2, 0]})", 0.5, 0.5);
        const DecimalReference truth = rim_truth(scene);
        ASSERT_EQ(truth.contact_events.size(), 1U) << shape;
        EXPECT_EQ(truth.contact_events.front().event, "stops");
        EXPECT_LE(std::abs(std::stold(truth.contact_events.front().t) - 0.5L), 1e-19L);
        EXPECT_LE(std::abs(std::stold(truth.columns[2][column_px]) - 0.375L), 1e-19L);
        EXPECT_LE(std::abs(std::stold(truth.columns[2][column_px + 1]) - 0.5L), 1e-19L);
    }
}

// An impact without slip acts at the centre of the rim: v_0 = sqrt(2 g h), and the impacts end after v_0 / g (1 + 2 (e
// + e^2 + ..)).
TEST(FlatRims, PuckBouncesToRest) {
    const DecimalReference truth = rim_truth(rim_scene(upright_cylinder, R"({"position": [0, 0, 0.325]})", 0.25, 0.5));
    ASSERT_FALSE(truth.contact_events.empty());
    EXPECT_EQ(truth.contact_events.back().event, "accumulates");
    const long double height = static_cast<long double>(0.325) - 0.125L;
    EXPECT_LE(std::abs(std::stold(truth.contact_events.back().t) - 3 * std::sqrt(height / 5)), 1e-18L);
    EXPECT_LE(std::abs(std::stold(truth.columns[2][column_px + 2]) - 0.125L), 1e-20L);
}

// Without friction nothing changes the spin and the velocity along the floor.
TEST(FlatRims, SmoothPuckAndBoxSpin) {
    for (const std::string& shape :
         {upright_cylinder, std::string(R"({"type": "box", "half_extents": [0.5, 0.25, 0.125]})")}) {
        const DecimalReference truth = rim_truth(rim_scene(
            shape, R"({"position": [0, 0, 0.25], "velocity": [1, 0, 0], "angular_velocity": [0, 0, 8]})", 0, 0.5));
        ASSERT_FALSE(truth.contact_events.empty());
        EXPECT_EQ(truth.contact_events.back().event, "accumulates");
        constexpr std::size_t column_qw = 0, column_wz = 6;
        EXPECT_LE(std::abs(std::stold(truth.columns[2][column_qw]) - std::cos(4.0L)), 1e-18L) << shape;
        EXPECT_LE(std::abs(std::stold(truth.columns[2][column_wz]) - 8), 1e-19L) << shape;
        EXPECT_LE(std::abs(std::stold(truth.columns[2][column_px]) - 1), 1e-19L) << shape;
        EXPECT_LE(std::abs(std::stold(truth.columns[2][column_px + 2]) - 0.125L), 1e-19L) << shape;
    }
}

TEST(FlatRims, NamesWhatIsNotDetermined) {
    const auto has = [](const std::string& fault, const char* text) {
        EXPECT_NE(fault.find(text), std::string::npos) << fault;
    };
    has(rim_fault(rim_scene(upright_cylinder, R"({"position": [0, 0, 0.5], "velocity": [1, 0, 0]})", 0.25, 0.5)),
        "lands flat on floor at t = ");
    has(rim_fault(rim_scene(thin_disc, R"({"orientation": [0.96, 0.28, 0, 0], "position": [0, 0, 0.1344]})", 0.5, 0.5)),
        "falls flat on floor at t = ");
    has(rim_fault(rim_scene(upright_cylinder, R"({"position": [0, 0, 0.125], "angular_velocity": [0, 0, 1]})", 0.5, 0)),
        "spins on a face at t = 0 s");
    has(rim_fault(rim_scene(R"({"type": "cylinder", "radius": 0.125, "half_height": 0.5})",
                            R"({"position": [0, 0, 0.5], "velocity": [1, 0, 0]})", 0.5, 0)),
        "tips over at t = 0 s");
    Scene walled = rim_scene(upright_cylinder, R"({"position": [0, 0, 0.125], "velocity": [1, 0, 0]})", 0.05, 0);
    Plane wall = walled.planes.front();
    wall.name = "wall", wall.normal_W = {-1, 0, 0}, wall.offset = -0.5;
    walled.planes.push_back(wall);
    has(rim_fault(walled), "reaches wall at t = 0.2679");
}

}  // namespace
}  // namespace polhode
