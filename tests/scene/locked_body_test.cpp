// Free bodies with locked degrees of freedom: initial states, degrees of freedom and accelerations.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "motion/mechanism.h"
#include "scene/scene_file.h"

namespace polhode::locked_body_test {
namespace {

std::string file_with(const std::string& locked, const std::string& initial) {
    return R"({"name": "a", "duration": 1,
  "bodies": [{"name": "box", "body": {"mass": 2, "inertia": [1, 4, 3], "center_of_mass": [0.5, 0, 0.25]},
              "locked": )" +
           locked + ", \"initial\": {" + initial + R"(}}],
  "loads": [{"type": "gravity", "acceleration": [1, 2, -8]},
            {"type": "torque", "body": "box", "vector": [1, 2, 3], "frame": "body"}]})";
}

struct Rates {
    int freedoms = 0;
    BodyMotion<double> start;
    Vector3<double> acceleration, angular;  // world axes of the centre of mass, body axes
};

// Accelerations by differences of the motion over a short time: first-order steps of the exact derivative.
Rates rates_of(const std::string& text) {
    const auto scene = std::make_shared<const Scene>(parse_scene(text, "a.json"));
    MechanismModel model(scene);
    std::vector<double> y(static_cast<std::size_t>(model.dimension())), dy(y.size());
    model.initial(y.data()), model.enter(0, y.data()), model.derivative(y.data(), dy.data());
    Rates result;
    result.freedoms = model.tree().links().rates;
    result.start = mechanism_initial_motions(*scene)[0];
    constexpr double h = 0x1p-20;
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += h * dy[i];
    const BodyMotion<double> after = model.tree().motions(y.data())[0];
    result.acceleration = (1 / h) * (after.velocity_W - result.start.velocity_W);
    result.angular = (1 / h) * (after.angular_velocity_B - result.start.angular_velocity_B);
    return result;
}

void expect_near(const Vector3<double>& a, const Vector3<double>& b, double within) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], within) << i;
}

TEST(LockedBody, PlanarMotionKeepsThreeDegreesOfFreedom) {
    const Rates planar = rates_of(file_with(
        R"(["y", "rx", "rz"])",
        R"("position": [1, 2, 3], "velocity": [4, 0, 5], "orientation": [0.8, 0, 0.6, 0], "angular_velocity": [0, 7, 0])"));
    EXPECT_EQ(planar.freedoms, 3);
    expect_near(planar.start.position_W, {1, 2, 3}, 1e-15);
    expect_near(planar.start.velocity_W, {4, 0, 5}, 1e-14);
    expect_near(planar.start.angular_velocity_B, {0, 7, 0}, 1e-14);
    EXPECT_NEAR(planar.start.q.y, 0.6, 1e-16);
    expect_near(planar.acceleration, {1, 0, -8}, 1e-6);
    expect_near(planar.angular, {0, 0.5, 0}, 1e-6);
}

TEST(LockedBody, TranslationOrRotationAlone) {
    const Rates slides =
        rates_of(file_with(R"(["rx", "ry", "rz"])", R"("position": [1, 2, 3], "velocity": [4, 5, 6])"));
    EXPECT_EQ(slides.freedoms, 3);
    expect_near(slides.start.position_W, {1, 2, 3}, 1e-15);
    expect_near(slides.start.velocity_W, {4, 5, 6}, 1e-15);
    expect_near(slides.acceleration, {1, 2, -8}, 1e-6);
    expect_near(slides.angular, {0, 0, 0}, 1e-6);
    // Euler's equations about the centre of mass: I w' = torque - w x I w
    const Rates turns =
        rates_of(file_with(R"(["x", "y", "z"])", R"("position": [1, 2, 3], "angular_velocity": [1, 2, 3])"));
    EXPECT_EQ(turns.freedoms, 3);
    expect_near(turns.start.position_W, {1, 2, 3}, 1e-15);
    expect_near(turns.acceleration, {0, 0, 0}, 1e-6);
    expect_near(turns.angular, {1.0 + 6, (2.0 + 6) / 4, (3.0 - 6) / 3}, 2e-5);
    const Rates rail = rates_of(file_with(R"(["x", "z", "rx", "ry", "rz"])", R"("velocity": [0, 5, 0])"));
    EXPECT_EQ(rail.freedoms, 1);
    expect_near(rail.acceleration, {0, 2, 0}, 1e-6);
}

TEST(LockedBody, FaultsAreNamed) {
    for (const auto& [locked, initial, fault] :
         {std::array{R"([])", "", "/bodies/0/locked"},
          {R"(["q"])", "", "/bodies/0/locked/0"},
          {R"(["x", "x"])", "", "/bodies/0/locked/1: is given twice"},
          {R"(["rx"])", "", "locks one rotation about a body axis"},
          {R"(["x", "y", "z", "rx", "ry", "rz"])", "", "locks all degrees of freedom"},
          {R"(["x"])", R"("velocity": [1, 0, 0])", "locks \"x\", but the initial velocity"},
          {R"(["ry", "rz"])", R"("angular_velocity": [1, 2, 0])", "locks \"ry\", but the initial angular velocity"},
          {R"(["ry", "rz"])",
           R"("angular_velocity": [1, 0, 0], "angular_velocity_frame": "world", "orientation": [0.8, 0.6, 0, 0])",
           "in body axes"}})
        try {
            parse_scene(file_with(locked, initial), "a.json");
            FAIL() << locked;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(fault), std::string::npos) << error.what();
        }
    const Scene scene = parse_scene(file_with(R"(["y", "rx", "rz"])", ""), "a.json");
    EXPECT_EQ(write_scene(parse_scene(write_scene(scene), "a.json")), write_scene(scene));
}

}  // namespace
}  // namespace polhode::locked_body_test
