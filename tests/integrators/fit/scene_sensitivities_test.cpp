// Derivatives through contacts and friction of joints, against closed forms.
#include "integrators/fit/scene_sensitivities.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scene/scene_file.h"

namespace polhode {
namespace {

// The scene with `number(scene)` changed to both sides.
template <class Number>
SceneChange small_change_of(const Scene& scene, const Number& number) {
    constexpr double by = 0x1p-42;
    SceneChange change{scene, scene, 2 * by};
    number(change.ahead) += by, number(change.behind) -= by;
    return change;
}

double entry(const Sensitivities& found, std::size_t moment, std::size_t quantity, std::size_t parameter) {
    return found.derivatives[(moment * Sensitivities::quantities + quantity) * found.parameters + parameter];
}

constexpr std::size_t turn_y = 1, place_x = 6, place_z = 8, speed_x = 9, speed_z = 11;

// A ball dropped from the height z above its radius: with T = sqrt(2 z / g) and s = t - T after the first impact,
// height = e g T s - g s^2 / 2.
TEST(SceneSensitivities, OfABouncingBall) {
    const Scene scene = parse_scene(R"({"name": "ball", "duration": 1,
        "body": {"shape": {"type": "sphere", "radius": 0.25}, "mass": 1}, "initial": {"position": [0, 0, 1.25]},
        "loads": [{"type": "gravity", "acceleration": [0, 0, -8]}],
        "planes": [{"normal": [0, 0, 1], "restitution": 0.75}]})",
                                    "ball.json");
    const SceneChange changes[] = {small_change_of(scene, [](Scene& s) -> double& { return s.planes[0].restitution; }),
                                   small_change_of(scene, [](Scene& s) -> double& { return s.initial.position_W[2]; })};
    const Sensitivities found = scene_sensitivities(scene, changes, {0.25, 1});
    ASSERT_EQ(found.status, Status::ok) << found.message;
    EXPECT_NEAR(entry(found, 0, place_z, 1), 1, 1e-13);
    // T = 1/2, dT/dz = 1/4
    const double g = 8, e = 0.75, T = 0.5, s = 0.5, T_z = 0.25;
    EXPECT_NEAR(found.samples[1].position_W[2], 0.25 + e * g * T * s - g * s * s / 2, 1e-13);
    EXPECT_NEAR(entry(found, 1, place_z, 0), g * T * s, 1e-13);
    EXPECT_NEAR(entry(found, 1, speed_z, 0), g * T, 1e-13);
    EXPECT_NEAR(entry(found, 1, place_z, 1), T_z * (e * g * s - e * g * T + g * s), 1e-13);
}

// A solid ball thrown without spin slides up to t = 2 v0 / (7 mu g), then rolls: x = 5/7 v0 t + 2 v0^2 / (49 mu g).
TEST(SceneSensitivities, OfABallThatSlidesAndRolls) {
    const Scene scene = parse_scene(R"({"name": "bowl", "duration": 2,
        "body": {"shape": {"type": "sphere", "radius": 0.5}, "mass": 3},
        "initial": {"position": [0, 0, 0.5], "velocity": [2, 0, 0]},
        "loads": [{"type": "gravity", "acceleration": [0, 0, -9.75]}],
        "planes": [{"normal": [0, 0, 1], "restitution": 0, "friction": 0.125}]})",
                                    "bowl.json");
    const SceneChange changes[] = {small_change_of(scene, [](Scene& s) -> double& { return s.planes[0].friction; }),
                                   small_change_of(scene, [](Scene& s) -> double& { return s.initial.velocity_W[0]; }),
                                   small_change_of(scene, [](Scene& s) -> double& { return s.body.mass; })};
    const double mu = 0.125, g = 9.75, v0 = 2, t = 2;
    const Sensitivities found = scene_sensitivities(scene, changes, {0.25, t});
    ASSERT_EQ(found.status, Status::ok) << found.message;
    EXPECT_NEAR(entry(found, 0, place_x, 0), -g * 0.25 * 0.25 / 2, 1e-13);
    EXPECT_NEAR(entry(found, 1, place_x, 0), -2 * v0 * v0 / (49 * mu * mu * g), 1e-13);
    EXPECT_NEAR(entry(found, 1, speed_x, 0), 0, 1e-13);
    EXPECT_NEAR(entry(found, 1, place_x, 1), 5 * t / 7 + 4 * v0 / (49 * mu * g), 1e-13);
    EXPECT_NEAR(entry(found, 1, speed_x, 1), 5.0 / 7, 1e-13);
    // angle = (x - what it slides) / r: w = 5/2 mu g t / r, then 5/7 v0 / r
    EXPECT_NEAR(entry(found, 1, turn_y, 1), (5 * t / 7 - 10 * v0 / (49 * mu * g)) / 0.5, 1e-12);
    EXPECT_NEAR(entry(found, 1, place_x, 2), 0, 1e-13);
}

// A slider that dry friction F stops after m v0^2 / (2 F).
TEST(SceneSensitivities, OfASliderWithFriction) {
    const Scene scene = parse_scene(R"({"name": "slider", "duration": 2,
        "bodies": [{"name": "block", "body": {"mass": 2, "inertia": [1, 1, 1]}}],
        "joints": [{"name": "rail", "type": "prismatic", "parent": "world", "child": "block", "axis": [1, 0, 0],
                    "friction": 3, "initial": {"speed": 1.5}}]})",
                                    "slider.json");
    const SceneChange changes[] = {small_change_of(scene, [](Scene& s) -> double& { return s.joints[0].friction; }),
                                   small_change_of(scene, [](Scene& s) -> double& { return s.bodies[0].body.mass; })};
    const Sensitivities found = scene_sensitivities(scene, changes, {2});
    ASSERT_EQ(found.status, Status::ok) << found.message;
    EXPECT_NEAR(entry(found, 0, place_x, 0), -2 * 1.5 * 1.5 / (2 * 3 * 3), 1e-13);
    EXPECT_NEAR(entry(found, 0, place_x, 1), 1.5 * 1.5 / (2 * 3), 1e-13);
}

// A central impact of two spheres: the second one leaves with (1 + e) m1 v / (m1 + m2) at t = 1/v.
TEST(SceneSensitivities, OfTwoSpheresThatCollide) {
    const Scene scene = parse_scene(R"({"name": "balls", "duration": 2,
        "bodies": [{"name": "first", "body": {"shape": {"type": "sphere", "radius": 0.25}, "mass": 3},
                    "initial": {"position": [-1.5, 0, 0], "velocity": [2, 0, 0]}},
                   {"name": "second", "body": {"shape": {"type": "sphere", "radius": 0.25}, "mass": 1}}],
        "contacts": [{"all": true, "restitution": 0.5, "friction": 0}]})",
                                    "balls.json");
    const SceneChange changes[] = {
        small_change_of(scene, [](Scene& s) -> double& { return s.contacts[0].restitution; }),
        small_change_of(scene, [](Scene& s) -> double& { return s.bodies[0].initial.velocity_W[0]; })};
    const Sensitivities found = scene_sensitivities(scene, changes, {2});
    ASSERT_EQ(found.status, Status::ok) << found.message;
    // the quantities of the second body follow those of the first
    const auto of_second = [&](std::size_t quantity, std::size_t parameter) {
        return entry(found, 1, quantity, parameter);
    };
    const double share = 3.0 / 4, v = 2, e = 0.5, T = 0.5, t = 2;
    EXPECT_NEAR(of_second(speed_x, 0), share * v, 1e-13);
    EXPECT_NEAR(of_second(place_x, 0), share * v * (t - T), 1e-13);
    // x = (1 + e) share (v t - 1)
    EXPECT_NEAR(of_second(place_x, 1), (1 + e) * share * t, 1e-13);
}

// The impact at t = 1/2 is later or earlier with another height: at that time the velocity has no derivative.
TEST(SceneSensitivities, FailWhereThereIsNoDerivative) {
    const Scene scene = parse_scene(R"({"name": "ball", "duration": 1,
        "body": {"shape": {"type": "sphere", "radius": 0.25}, "mass": 1}, "initial": {"position": [0, 0, 1.25]},
        "loads": [{"type": "gravity", "acceleration": [0, 0, -8]}],
        "planes": [{"normal": [0, 0, 1], "restitution": 0.75}]})",
                                    "ball.json");
    const SceneChange changes[] = {small_change_of(scene, [](Scene& s) -> double& { return s.initial.position_W[2]; })};
    const Sensitivities found = scene_sensitivities(scene, changes, {0.5, 1});
    EXPECT_EQ(found.status, Status::failed);
    EXPECT_NE(found.message.find("t = 0.5 s has no derivative"), std::string::npos) << found.message;
}

}  // namespace
}  // namespace polhode
