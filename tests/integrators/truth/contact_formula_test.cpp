// Formula loads of a body in contact with planes, compared with closed forms and with loads of the scene format.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/method.h"
#include "integrators/truth/reference.h"
#include "scene/scene_file.h"
#include "text/message.h"

namespace polhode {
namespace {

// A solid ball of 2 kg and radius 1/2 m, or a block of 2 kg with half height 1/2 m, under gravity of 9 m/s^2.
Scene formula_scene(const std::string& shape, const std::string& initial, const std::string& loads,
                    const std::string& plane, double duration) {
    return parse_scene(R"({"name": "formula", "duration": )" + std::to_string(duration) +
                           R"(, "body": {"mass": 2, "shape": )" + shape + R"(}, "initial": )" + initial +
                           R"(, "loads": [)" + loads + R"(], "planes": [{"normal": [0, 0, 1], )" + plane + "}]}",
                       "test");
}
const char* const formula_ball = R"({"type": "sphere", "radius": 0.5})";
const char* const formula_block = R"({"type": "box", "half_extents": [1, 1, 0.5]})";
const std::string weight = R"({"type": "gravity", "acceleration": [0, 0, -9]})";

DecimalReference reference_of(const Scene& scene) {
    DecimalReference truth = decimal_reference(scene, 2, 25);
    EXPECT_TRUE(truth.available) << truth.message;
    EXPECT_LE(truth.bound, 1e-24);
    return truth;
}
void expect_decimal(const std::string& decimal, long double expected) {
    EXPECT_LE(std::abs(std::stold(decimal) - expected), 1e-17L * std::max(1.0L, std::abs(expected)))
        << decimal << " instead of " << static_cast<double>(expected);
}
void expect_methods_agree(const Scene& scene, const DecimalReference& truth) {
    Settings settings;
    settings.tolerance = 1e-11, settings.samples = 2;
    for (const char* name : {"taylor", "extrapolation", "dop853", "radau", "cvode_adams", "cvode_bdf"}) {
        const Trajectory run = solve(scene, *find_method(name), settings);
        ASSERT_EQ(run.status, Status::ok) << name << ": " << run.message;
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_NEAR(run.samples.back().position_W[i], std::stod(truth.columns.back()[7 + i]), 1e-8) << name;
            EXPECT_NEAR(run.samples.back().velocity_W[i], std::stod(truth.columns.back()[10 + i]), 1e-8) << name;
        }
    }
}

/// A force that grows as a t moves a block from t_1 = mu m g / a on: x = a (t - t_1)^3 / (6 m).
TEST(ContactFormula, GrowingForceMovesABlock) {
    const Scene scene =
        formula_scene(formula_block, R"({"position": [0, 0, 0.5]})",
                      weight + R"(, {"type": "force", "frame": "world", "formula": "[4*t, 0, 0]", "point": [0, 0, 0]})",
                      R"("restitution": 0, "friction": 0.25)", 2);
    const DecimalReference truth = reference_of(scene);
    ASSERT_EQ(truth.contact_events.size(), 1U);
    EXPECT_EQ(truth.contact_events[0].event, "slides");
    const long double start = 4.5L / 4, after = 2 - start;
    expect_decimal(truth.contact_events[0].t, start);
    expect_decimal(truth.columns[2][7], 4 * after * after * after / 12);
    expect_decimal(truth.columns[2][10], after * after);
    expect_methods_agree(scene, truth);
}

/// A rolling ball under F = F_0 sin(k t) at its centre has v = 5/7 F_0 / (m k) (1 - cos k t); the series has an
/// auxiliary variable for the sine.
TEST(ContactFormula, OscillatingForceRollsABall) {
    const Scene scene = formula_scene(
        formula_ball, R"({"position": [0, 0, 0.5]})",
        weight + R"(, {"type": "force", "frame": "world", "formula": "[3*sin(2*t), 0, 0]", "point": [0, 0, 0]})",
        R"("restitution": 0, "friction": 0.5)", 2);
    const DecimalReference truth = reference_of(scene);
    EXPECT_TRUE(truth.contact_events.empty());
    const long double factor = 5.0L / 7 * 3 / 2 / 2;
    expect_decimal(truth.columns[2][10], factor * (1 - std::cos(4.0L)));
    expect_decimal(truth.columns[2][7], factor * (2 - std::sin(4.0L) / 2));
    expect_methods_agree(scene, truth);
}

/// F_0 sin(k t) with 0.8 F_0 = mu m g moves a block from k t_1 = arcsin 0.8 on, until it stops; this repeats, mirrored,
/// after each half period.
TEST(ContactFormula, BlockStopsAndSlidesInEachHalfPeriod) {
    const Scene scene = formula_scene(
        formula_block, R"({"position": [0, 0, 0.5]})",
        weight + R"(, {"type": "force", "frame": "world", "formula": "[7.5*sin(3*t), 0, 0]", "point": [0, 0, 0]})",
        R"("restitution": 0, "friction": 0.3333333333333333)", 4);
    const DecimalReference truth = reference_of(scene);
    ASSERT_EQ(truth.contact_events.size(), 7U);
    const long double half_period = 3.14159265358979323846L / 3;
    for (std::size_t i = 0; i < 7; ++i) {
        const std::vector<DecimalContactEvent>& events = truth.contact_events;
        EXPECT_EQ(events[i].event, i % 2 == 0 ? "slides" : "stops");
        if (i >= 2) expect_decimal(events[i].t, std::stold(events[i - 2].t) + half_period);
    }
    EXPECT_NEAR(std::stod(truth.contact_events[0].t), std::asin(0.8) / 3, 1e-15);
    expect_methods_agree(scene, truth);
}

/// Gravity and drag as formulas give the motion of the loads with these names, through impacts and sliding.
TEST(ContactFormula, FormulasOfGravityAndDragAreTheLoads) {
    const std::string start = R"({"position": [0, 0, 1.5], "velocity": [2, 1, 0], "angular_velocity": [1, 2, 3]})";
    const std::string shape = R"({"type": "ellipsoid", "semi_axes": [0.5, 0.4, 0.3]})";
    const std::string plane = R"("restitution": 0.5, "friction": 0.25)";
    const Scene formulas = formula_scene(shape, start,
                                         R"({"type": "potential", "formula": "mass*9*p.z"},
                                            {"type": "force", "frame": "world", "formula": "-0.5*v"},
                                            {"type": "torque", "frame": "body", "formula": "-0.25*w"})",
                                         plane, 1);
    const Scene loads = formula_scene(
        shape, start, weight + R"(, {"type": "drag", "rotational": [0.25, 0.25, 0.25], "translational": 0.5})", plane,
        1);
    const DecimalReference truth = reference_of(formulas), expected = reference_of(loads);
    ASSERT_EQ(truth.contact_events.size(), expected.contact_events.size());
    for (std::size_t i = 0; i < truth.contact_events.size(); ++i)
        expect_decimal(truth.contact_events[i].t, std::stold(expected.contact_events[i].t));
    for (std::size_t i = 0; i < 13; ++i) expect_decimal(truth.columns[2][i], std::stold(expected.columns[2][i]));
    const Reference one = reference(formulas, 2), other = reference(loads, 2);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(one.samples[i].energy.high, other.samples[i].energy.high, 1e-13);
    expect_methods_agree(formulas, truth);
}

/// A force that is sampled twice a second, in the closed form of its steps: frictionless, v = sum of F(t_k) h / m.
TEST(ContactFormula, SampledForceOnASlidingBlock) {
    const Scene scene = formula_scene(
        formula_block, R"({"position": [0, 0, 0.5]})",
        weight + R"(, {"type": "force", "frame": "world", "formula": "[4*t + 1, 0, 0]", "point": [0, 0, 0],
                       "hold": 0.5})",
        R"("restitution": 0, "friction": 0)", 2);
    const DecimalReference truth = reference_of(scene);
    expect_decimal(truth.columns[2][10], (1 + 3 + 5 + 7) * 0.25L);
    expect_methods_agree(scene, truth);
}

TEST(ContactFormula, RefusesSwitchesAndOtherMethods) {
    const std::string force = R"(, {"type": "force", "frame": "world", "formula": )";
    const std::string plane = R"("restitution": 0, "friction": 0.5)", start = R"({"position": [0, 0, 0.5]})";
    try {
        formula_scene(formula_ball, start, weight + force + R"("[max(t - 1, 0), 0, 0]"})", plane, 2);
        FAIL() << "a switching point is accepted";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("which scenes with planes do not support"), std::string::npos)
            << error.what();
    }
    const Scene smooth = formula_scene(formula_ball, start, weight + force + R"("[t, 0, 0]"})", plane, 2);
    Settings stepped;
    stepped.step = 0.01;
    for (const char* name : {"rk4", "moreau_jean", "sequential_impulses_contact_10"}) {
        const Method* method = find_method(name);
        if (!method) continue;
        const Trajectory run = solve(smooth, *method, stepped);
        EXPECT_EQ(run.status, Status::unsupported) << name;
    }
}

}  // namespace
}  // namespace polhode
