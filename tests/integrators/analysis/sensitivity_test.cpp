// Derivatives of motions with a closed form. tests/python/test_sensitivity.py compares others with the truth.
#include "integrators/analysis/sensitivity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scene/scene_file.h"

namespace polhode {
namespace {

constexpr double small_change = 0x1p-40;

// The scene with `number(scene)` changed to both sides.
template <class Number>
SceneChange change_of(const Scene& scene, const Number& number) {
    SceneChange change{scene, scene, 2 * small_change};
    number(change.ahead) += small_change, number(change.behind) -= small_change;
    return change;
}

// d quantity / d parameter at a moment, of a scene of one body.
double derivative(const Sensitivities& found, std::size_t moment, std::size_t quantity, std::size_t parameter) {
    return found.derivatives[(moment * Sensitivities::quantities + quantity) * found.parameters + parameter];
}

constexpr std::size_t rotation_z = 2, rate_z = 5, position_x = 6, velocity_x = 9;

// A body that rotates about its axis z under a torque: angle = w t + tau t^2 / (2 I).
TEST(Sensitivities, OfARotationAboutAnAxis) {
    Scene scene;
    scene.name = "rotor", scene.duration = 3;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 1, 1.5));
    scene.initial.angular_velocity = {0, 0, 2};
    scene.loads.push_back(Torque{{0, 0, 0.75}, Frame::world, {}});
    const SceneChange changes[] = {
        change_of(scene, [](Scene& s) -> double& { return s.initial.angular_velocity[2]; }),
        change_of(scene, [](Scene& s) -> double& { return s.body.inertia_B[2][2]; }),
        change_of(scene, [](Scene& s) -> double& { return std::get<Torque>(s.loads[0]).vector[2]; })};
    const std::vector<double> times{0, 1, 3};
    const Sensitivities found = sensitivities(scene, changes, times);
    ASSERT_EQ(found.status, Status::ok) << found.message;
    for (std::size_t k = 0; k < times.size(); ++k) {
        const double t = times[k], I = 1.5, tau = 0.75;
        EXPECT_NEAR(derivative(found, k, rotation_z, 0), t, 1e-12);
        EXPECT_NEAR(derivative(found, k, rotation_z, 1), -tau * t * t / (2 * I * I), 1e-12);
        EXPECT_NEAR(derivative(found, k, rotation_z, 2), t * t / (2 * I), 1e-12);
        EXPECT_NEAR(derivative(found, k, rate_z, 1), -tau * t / (I * I), 1e-12);
        EXPECT_EQ(derivative(found, k, position_x, 1), 0);
    }
}

// A body with drag that an impulse hits at t1: v = v0 e^(-c t / m) + J e^(-c (t - t1) / m) / m.
TEST(Sensitivities, OfAnImpulseAndDrag) {
    Scene scene;
    scene.name = "puck", scene.duration = 2;
    scene.body.mass = 2;
    scene.initial.velocity_W = {3, 0, 0};
    scene.loads.push_back(Drag{{}, 0.5, {}});
    scene.loads.push_back(Impulse{{4, 0, 0}, Frame::world, {}, Frame::body, 0.5});
    const SceneChange changes[] = {
        change_of(scene, [](Scene& s) -> double& { return s.body.mass; }),
        change_of(scene, [](Scene& s) -> double& { return std::get<Impulse>(s.loads[1]).vector[0]; }),
        change_of(scene, [](Scene& s) -> double& { return std::get<Drag>(s.loads[0]).translational; })};
    const Sensitivities found = sensitivities(scene, changes, {0.25, 0.5, 2});
    ASSERT_EQ(found.status, Status::ok) << found.message;
    const auto expect = [&](std::size_t k, double t, bool hit) {
        const double m = 2, c = 0.5, J = hit ? 4 : 0, s = t - 0.5;
        const double first = 3 * std::exp(-c * t / m), second = J * std::exp(-c * s / m) / m;
        EXPECT_NEAR(derivative(found, k, velocity_x, 0), first * c * t / (m * m) + second * (c * s / (m * m) - 1 / m),
                    1e-12);
        EXPECT_NEAR(derivative(found, k, velocity_x, 1), hit ? std::exp(-c * s / m) / m : 0, 1e-12);
        EXPECT_NEAR(derivative(found, k, velocity_x, 2), -first * t / m - second * s / m, 1e-12);
    };
    expect(0, 0.25, false), expect(1, 0.5, true), expect(2, 2, true);
}

// More parameters than one pass has: each has the derivative that it has alone.
TEST(Sensitivities, AreThoseOfSinglePasses) {
    Scene scene;
    scene.name = "body", scene.duration = 1;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 3));
    scene.initial.angular_velocity = {1, 0.5, 0.25};
    std::vector<SceneChange> changes;
    for (std::size_t i = 0; i < 9; ++i)
        changes.push_back(change_of(scene, [i](Scene& s) -> double& {
            return i < 3   ? s.initial.angular_velocity[i]
                   : i < 6 ? s.initial.velocity_W[i - 3]
                           : s.body.inertia_B[i - 6][i - 6];
        }));
    const Sensitivities all = sensitivities(scene, changes, {1});
    const Sensitivities last = sensitivities(scene, std::span(changes).last(1), {1});
    ASSERT_EQ(all.status, Status::ok) << all.message;
    for (std::size_t q = 0; q < Sensitivities::quantities; ++q)
        EXPECT_NEAR(derivative(all, 0, q, 8), derivative(last, 0, q, 0), 1e-11);
    EXPECT_NEAR(derivative(all, 0, position_x, 3), 1, 1e-12);
}

double& parameter(Scene& scene, std::size_t i) { return scene.parameters[i].value; }

// An oscillator, x = x0 cos(w t) with w^2 = k/m.
TEST(Sensitivities, OfAFormulaByItsParameters) {
    const Scene scene = parse_scene(R"({"name": "oscillator", "duration": 2, "body": {"mass": 2, "inertia": [1, 1, 1]},
        "initial": {"position": [0.7, 0, 0]}, "parameters": {"k": 5},
        "loads": [{"type": "force", "frame": "world", "formula": "-k*p"}]})",
                                    "oscillator.json");
    const SceneChange changes[] = {change_of(scene, [](Scene& s) -> double& { return parameter(s, 0); }),
                                   change_of(scene, [](Scene& s) -> double& { return s.body.mass; })};
    const double t = 2, k = 5, m = 2, w = std::sqrt(k / m);
    const Sensitivities found = sensitivities(scene, changes, {t});
    ASSERT_EQ(found.status, Status::ok) << found.message;
    EXPECT_NEAR(derivative(found, 0, position_x, 0), -0.7 * t * std::sin(w * t) / (2 * std::sqrt(k * m)), 1e-11);
    EXPECT_NEAR(derivative(found, 0, position_x, 1), 0.7 * t * std::sin(w * t) * w / (2 * m), 1e-11);
}

// dv/dt = -c v^n: v^(1 - n) = v0^(1 - n) + (n - 1) c t.
TEST(Sensitivities, OfAFormulaByAnExponent) {
    const Scene scene = parse_scene(R"({"name": "drag", "duration": 1.5, "body": {"mass": 1, "inertia": [1, 1, 1]},
        "initial": {"velocity": [3, 0, 0]}, "parameters": {"c": 0.4, "n": 1.7},
        "loads": [{"type": "force", "frame": "world", "formula": "[-c*v.x^n, 0, 0]"}]})",
                                    "drag.json");
    const SceneChange changes[] = {change_of(scene, [](Scene& s) -> double& { return parameter(s, 0); }),
                                   change_of(scene, [](Scene& s) -> double& { return parameter(s, 1); })};
    const double t = 1.5, c = 0.4, n = 1.7, A = std::pow(3, 1 - n) + (n - 1) * c * t, v = std::pow(A, 1 / (1 - n));
    const Sensitivities found = sensitivities(scene, changes, {t});
    ASSERT_EQ(found.status, Status::ok) << found.message;
    EXPECT_NEAR(found.samples[0].velocity_W[0], v, 1e-11);
    EXPECT_NEAR(derivative(found, 0, velocity_x, 0), -t * v / A, 1e-11);
    const double slope_of_A = c * t - std::log(3) * std::pow(3, 1 - n);
    EXPECT_NEAR(derivative(found, 0, velocity_x, 1),
                v * (std::log(A) / ((1 - n) * (1 - n)) + slope_of_A / (A * (1 - n))), 1e-11);
}

// A damped rotor on a hinge whose motor is a formula: angle rate = w0 e^(-c t/I).
TEST(Sensitivities, OfAMotorGivenByAFormula) {
    const Scene scene = parse_scene(R"({"name": "rotor", "duration": 1,
        "bodies": [{"name": "rotor", "body": {"mass": 1, "inertia": [1, 1, 0.5]}}],
        "joints": [{"name": "hinge", "type": "revolute", "parent": "world", "child": "rotor", "axis": [0, 0, 1],
                    "initial": {"rate": 4}}],
        "parameters": {"c": 0.8},
        "loads": [{"type": "motor", "joint": "hinge", "formula": "-c*hinge.rate"}]})",
                                    "rotor.json");
    const SceneChange changes[] = {change_of(scene, [](Scene& s) -> double& { return parameter(s, 0); })};
    const Sensitivities found = sensitivities(scene, changes, {1});
    ASSERT_EQ(found.status, Status::ok) << found.message;
    EXPECT_NEAR(derivative(found, 0, rate_z, 0), -4 / 0.5 * std::exp(-0.8 / 0.5), 1e-11);
}

// A body in uniform motion until x = X, then with the acceleration a: with T = X/v0, x = v0 t + a (t - T)^2 / 2.
TEST(Sensitivities, JumpAtASwitchOfAFormula) {
    const Scene scene = parse_scene(R"({"name": "line", "duration": 2, "body": {"mass": 1, "inertia": [1, 1, 1]},
        "initial": {"velocity": [1.5, 0, 0]}, "parameters": {"a": 0.7, "X": 1.1},
        "loads": [{"type": "force", "frame": "world", "formula": "[if(p.x < X, 0, a), 0, 0]"}]})",
                                    "line.json");
    const SceneChange changes[] = {change_of(scene, [](Scene& s) -> double& { return parameter(s, 0); }),
                                   change_of(scene, [](Scene& s) -> double& { return parameter(s, 1); }),
                                   change_of(scene, [](Scene& s) -> double& { return s.initial.velocity_W[0]; })};
    const double t = 2, a = 0.7, X = 1.1, v0 = 1.5, T = X / v0;
    const Sensitivities found = sensitivities(scene, changes, {0.5, t});
    ASSERT_EQ(found.status, Status::ok) << found.message;
    EXPECT_EQ(derivative(found, 0, position_x, 1), 0);
    EXPECT_NEAR(derivative(found, 0, position_x, 2), 0.5, 1e-12);
    EXPECT_NEAR(derivative(found, 1, position_x, 0), (t - T) * (t - T) / 2, 1e-12);
    EXPECT_NEAR(derivative(found, 1, position_x, 1), -a * (t - T) / v0, 1e-12);
    EXPECT_NEAR(derivative(found, 1, velocity_x, 1), -a / v0, 1e-12);
    EXPECT_NEAR(derivative(found, 1, position_x, 2), t + a * (t - T) * T / v0, 1e-12);
}

// x'' = -sign(x) from x = A at rest. After n crossings, with r = sqrt(2 A) and s = t - (2 n - 1) r:
// x = (-1)^n (r s - s^2 / 2).
TEST(Sensitivities, PassManySwitches) {
    const Scene scene = parse_scene(R"({"name": "oscillator", "duration": 10, "body": {"mass": 1, "inertia": [1, 1, 1]},
        "initial": {"position": [0.4, 0, 0]},
        "loads": [{"type": "force", "frame": "world", "formula": "[-sign(p.x), 0, 0]"}]})",
                                    "oscillator.json");
    const SceneChange changes[] = {change_of(scene, [](Scene& s) -> double& { return s.initial.position_W[0]; })};
    const std::vector<double> times{1.25, 4, 10};
    const Sensitivities found = sensitivities(scene, changes, times);
    ASSERT_EQ(found.status, Status::ok) << found.message;
    for (std::size_t k = 0; k < times.size(); ++k) {
        const double r = std::sqrt(0.8), n = std::floor((times[k] / r + 1) / 2), s = times[k] - (2 * n - 1) * r;
        const double sign = std::fmod(n, 2) == 1 ? -1 : 1;
        EXPECT_NEAR(found.samples[k].position_W[0], sign * (r * s - s * s / 2), 1e-11);
        // dr/dA = 1/r, ds/dA = -(2 n - 1)/r
        EXPECT_NEAR(derivative(found, k, position_x, 0), sign * (s / r - (2 * n - 1) * (r - s) / r), 1e-10);
    }
}

// A force that is held between sampling times: two steps of x_{k+1} = x_k + h v_k - g h^2 x_k / 2.
TEST(Sensitivities, OfHeldValues) {
    const Scene scene = parse_scene(R"({"name": "sampled", "duration": 1, "body": {"mass": 1, "inertia": [1, 1, 1]},
        "initial": {"position": [1, 0, 0], "velocity": [0.3, 0, 0]}, "parameters": {"g": 0.8},
        "loads": [{"type": "force", "frame": "world", "formula": "[-g*p.x, 0, 0]", "hold": 0.5}]})",
                                    "sampled.json");
    const SceneChange changes[] = {change_of(scene, [](Scene& s) -> double& { return parameter(s, 0); }),
                                   change_of(scene, [](Scene& s) -> double& { return s.initial.position_W[0]; })};
    const Sensitivities found = sensitivities(scene, changes, {1});
    ASSERT_EQ(found.status, Status::ok) << found.message;
    const double h = 0.5, g = 0.8, x0 = 1, v0 = 0.3, x1 = x0 + h * v0 - g * h * h * x0 / 2;
    const double x1_g = -h * h * x0 / 2, v1_g = -h * x0;
    EXPECT_NEAR(derivative(found, 0, position_x, 0), x1_g + h * v1_g - h * h * (x1 + g * x1_g) / 2, 1e-13);
    EXPECT_NEAR(derivative(found, 0, velocity_x, 0), v1_g - h * (x1 + g * x1_g), 1e-13);
    const double x1_x = 1 - g * h * h / 2, v1_x = -g * h;
    EXPECT_NEAR(derivative(found, 0, position_x, 1), x1_x + h * v1_x - g * h * h * x1_x / 2, 1e-13);
}

// The puck of OfAnImpulseAndDrag by the time of its impulse, and a rotor by the end of its torque.
TEST(Sensitivities, ByTheTimesOfEvents) {
    Scene puck;
    puck.name = "puck", puck.duration = 2;
    puck.body.mass = 2;
    puck.initial.velocity_W = {3, 0, 0};
    puck.loads.push_back(Drag{{}, 0.5, {}});
    puck.loads.push_back(Impulse{{4, 0, 0}, Frame::world, {}, Frame::body, 0.5});
    const SceneChange of_puck[] = {
        change_of(puck, [](Scene& s) -> double& { return std::get<Impulse>(s.loads[1]).at; })};
    const Sensitivities hit = sensitivities(puck, of_puck, {0.25, 2});
    ASSERT_EQ(hit.status, Status::ok) << hit.message;
    const double decay = std::exp(-0.5 * 1.5 / 2);
    EXPECT_EQ(derivative(hit, 0, position_x, 0), 0);
    EXPECT_NEAR(derivative(hit, 1, velocity_x, 0), 4.0 / 2 * 0.5 / 2 * decay, 1e-12);
    EXPECT_NEAR(derivative(hit, 1, position_x, 0), -4.0 / 2 * decay, 1e-12);

    Scene rotor;
    rotor.name = "rotor", rotor.duration = 1;
    rotor.body.inertia_B = diagonal(Vector3<double>(1, 1, 1.5));
    rotor.loads.push_back(Torque{{0, 0, 1}, Frame::body, {0.25, 0.75}});
    const SceneChange of_rotor[] = {
        change_of(rotor, [](Scene& s) -> double& { return std::get<Torque>(s.loads[0]).window.from; }),
        change_of(rotor, [](Scene& s) -> double& { return std::get<Torque>(s.loads[0]).window.until; })};
    const Sensitivities turned = sensitivities(rotor, of_rotor, {1});
    ASSERT_EQ(turned.status, Status::ok) << turned.message;
    // rate = (until - from) / I,  angle = (until - from) (t - (from + until) / 2) / I
    EXPECT_NEAR(derivative(turned, 0, rate_z, 0), -1 / 1.5, 1e-12);
    EXPECT_NEAR(derivative(turned, 0, rate_z, 1), 1 / 1.5, 1e-12);
    EXPECT_NEAR(derivative(turned, 0, rotation_z, 0), -(1 - 0.25) / 1.5, 1e-12);
    EXPECT_NEAR(derivative(turned, 0, rotation_z, 1), (1 - 0.75) / 1.5, 1e-12);
}

TEST(Sensitivities, RefuseWhatTheyDoNotSupport) {
    Scene scene;
    scene.name = "body", scene.duration = 1;
    scene.loads.push_back(Torque{{0, 0, 1}, Frame::body, {0, 0.75}});
    const SceneChange changes[] = {
        change_of(scene, [](Scene& s) -> double& { return std::get<Torque>(s.loads[0]).window.from; })};
    // an event at the start becomes a later one
    EXPECT_EQ(sensitivities(scene, changes, {1}).message, "the order of events changes with it");
    EXPECT_THROW(sensitivities(scene, {}, {0.5, 0.5}), std::invalid_argument);
    EXPECT_THROW(sensitivities(scene, {}, {2}), std::invalid_argument);
    EXPECT_EQ(sensitivities(scene, {}, {1}, {.max_steps = 1}).status, Status::failed);
    scene.planes.push_back({});
    EXPECT_EQ(sensitivities(scene, {}, {1}).status, Status::unsupported);
    const Scene chattering = parse_scene(R"({"name": "dry", "duration": 1, "body": {"mass": 1, "inertia": [1, 1, 1]},
        "initial": {"velocity": [0.25, 0, 0]},
        "loads": [{"type": "force", "frame": "world", "formula": "[-sign(v.x), 0, 0]"}]})",
                                         "dry.json");
    const Sensitivities ended = sensitivities(chattering, {}, {1});
    EXPECT_EQ(ended.status, Status::failed);
    EXPECT_NE(ended.message.find("chattering"), std::string::npos) << ended.message;
    EXPECT_NE(ended.message.find("t = 0.25 s"), std::string::npos) << ended.message;
}

}  // namespace
}  // namespace polhode
