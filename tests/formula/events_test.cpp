// Switching points of formula loads: located as events by the reference and by `taylor`.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "formula/formula_scene.h"

namespace polhode {
namespace {

using test::formula_scene;
using test::solve_with;

// m x'' = -m sign(x) from x = 1 at rest: parabolas of duration sqrt 2.
double zigzag(double t) {
    const double quarter = std::sqrt(2.0);
    const double phase = std::fmod(t, 4 * quarter);
    if (phase < quarter) return 1 - phase * phase / 2;
    if (phase < 3 * quarter) return (phase - 2 * quarter) * (phase - 2 * quarter) / 2 - 1;
    return 1 - (phase - 4 * quarter) * (phase - 4 * quarter) / 2;
}

TEST(FormulaEvents, AreLocatedByTheReferenceAndTaylor) {
    const Scene scene =
        formula_scene(R"json("loads": [{"type": "force", "frame": "world", "formula": "[-mass*sign(p.x), 0, 0]"}])json",
                      R"json("position": [1, 0, 0], "angular_velocity": [0, 0, 1])json", 20);
    const Reference truth = reference(scene, 40, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    EXPECT_LT(truth.bound, 1e-22);
    for (const double tolerance : {1e-10, 1e-15}) {
        const Trajectory taylor = solve_with(scene, "taylor", tolerance, 40);
        ASSERT_EQ(taylor.status, Status::ok) << taylor.message;
        for (std::size_t i = 0; i < truth.samples.size(); ++i) {
            EXPECT_NEAR(truth.samples[i].position_W[0].high, zigzag(truth.samples[i].t), 2e-14);
            EXPECT_NEAR(taylor.samples[i].position_W[0], zigzag(truth.samples[i].t), 3e-13);
        }
    }
}

// Methods that locate switches in their steps, or on the dense output.
TEST(FormulaEvents, AreLocatedByMethodsWithAToleranceToo) {
    const Scene jumps =
        formula_scene(R"json("loads": [{"type": "force", "frame": "world", "formula": "[-mass*sign(p.x), 0, 0]"}])json",
                      R"json("position": [1, 0, 0], "angular_velocity": [0, 0, 1])json", 20);
    // I w' = clamp(-10 w, -1, 1) with I = 0.5: see FollowASaturatedRegulator
    const Scene saturated = formula_scene(
        R"json("loads": [{"type": "torque", "frame": "body", "formula": "[0, 0, clamp(-10*w.z, -1, 1)]"}])json",
        R"json("angular_velocity": [0, 0, 2])json", 2);
    const Scene slides = formula_scene(
        R"json("loads": [{"type": "force", "frame": "world", "formula": "[-2*mass*sign(v.x) + 0.1, 0, 0]"}])json",
        R"json("velocity": [1, 0, 0])json", 2);
    for (const auto& [name, allowed] : {std::pair{"extrapolation", 1e-8},
                                        {"dop853", 1e-8},
                                        {"radau", 1e-8},
                                        {"cvode_adams", 2e-6},
                                        {"cvode_bdf", 2e-5}}) {
        const Trajectory run = solve_with(jumps, name, 1e-10, 40);
        ASSERT_EQ(run.status, Status::ok) << name << ": " << run.message;
        for (const Sample& sample : run.samples)
            EXPECT_NEAR(sample.position_W[0], zigzag(sample.t), allowed) << name << " at " << sample.t;
        const Trajectory stopped = solve_with(saturated, name, 1e-10, 8);
        ASSERT_EQ(stopped.status, Status::ok) << name << ": " << stopped.message;
        for (const Sample& sample : stopped.samples)
            EXPECT_NEAR(sample.angular_velocity_B[2],
                        sample.t < 0.95 ? 2 - 2 * sample.t : 0.1 * std::exp(-20 * (sample.t - 0.95)), allowed)
                << name << " at " << sample.t;
        const Trajectory chatters = solve_with(slides, name, 1e-10, 2);
        EXPECT_EQ(chatters.status, Status::failed) << name;
        EXPECT_NE(chatters.message.find("chattering"), std::string::npos) << name << ": " << chatters.message;
    }
}

// Integrals of a thrust profile in time: impulse and distance in closed form.
TEST(FormulaEvents, FollowTablesOfTime) {
    const Scene scene = formula_scene(
        R"json("tables": {"thrust": {"x": [0, 0.5, 2, 2.1], "y": [0, 90, 80, 0]}},
           "loads": [{"type": "force", "frame": "world", "formula": "[table(thrust, t), 0, 0]"}])json",
        "", 3);
    // impulse: 90/4 + 85*1.5 + 4 N s; x: exact integrals of the linear pieces
    const double impulse = 22.5 + 127.5 + 4;
    const double first = 180.0 * 0.5 * 0.5 * 0.5 / 6, second = 22.5 * 1.5 + 90 * 1.5 * 1.5 / 2 - 10 * 1.5 * 1.5 / 6;
    const double third = 150 * 0.1 + 80 * 0.01 / 2 - 80 * 0.01 / 6;
    const Reference truth = reference(scene, 1, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    const Trajectory taylor = solve_with(scene, "taylor", 1e-12, 1);
    ASSERT_EQ(taylor.status, Status::ok) << taylor.message;
    const double at_end = (first + second + third + impulse * (3 - 2.1)) / 2;
    EXPECT_NEAR(truth.samples.back().velocity_W[0].high, impulse / 2, 1e-13);
    EXPECT_NEAR(truth.samples.back().position_W[0].high, at_end, 1e-13);
    EXPECT_NEAR(taylor.samples.back().position_W[0], at_end, 1e-12);
}

// A saturated torque about one axis: the first part at constant deceleration, then a damped oscillation.
TEST(FormulaEvents, FollowASaturatedRegulator) {
    // I w' = clamp(-10 w, -1, 1) with I = 0.5 about z: w = 2 - 2 t until w = 0.1, then exponential with rate 20
    const Scene scene = formula_scene(
        R"json("loads": [{"type": "torque", "frame": "body", "formula": "[0, 0, clamp(-10*w.z, -1, 1)]"}])json",
        R"json("angular_velocity": [0, 0, 2])json", 2);
    const Reference truth = reference(scene, 8, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    const Trajectory taylor = solve_with(scene, "taylor", 1e-14, 8);
    ASSERT_EQ(taylor.status, Status::ok) << taylor.message;
    for (std::size_t i = 0; i < truth.samples.size(); ++i) {
        const double t = truth.samples[i].t, expected = t < 0.95 ? 2 - 2 * t : 0.1 * std::exp(-20 * (t - 0.95));
        EXPECT_NEAR(truth.samples[i].angular_velocity_B[2].high, expected, 1e-15);
        EXPECT_NEAR(taylor.samples[i].angular_velocity_B[2], expected, 1e-14);
    }
}

TEST(FormulaEvents, ReportChattering) {
    // Coulomb friction stops the body after 0.5 s; then the sign changes at every instant
    const Scene scene = formula_scene(
        R"json("loads": [{"type": "force", "frame": "world", "formula": "[-2*mass*sign(v.x) + 0.1, 0, 0]"}])json",
        R"json("velocity": [1, 0, 0])json", 2);
    const Reference truth = reference(scene, 2, 20);
    EXPECT_FALSE(truth.available);
    EXPECT_NE(truth.message.find("chattering: the motion slides along the switching surface of \"sign(v.x)\""),
              std::string::npos)
        << truth.message;
    const Trajectory taylor = solve_with(scene, "taylor", 1e-10, 2);
    EXPECT_EQ(taylor.status, Status::failed);
    EXPECT_NE(taylor.message.find("chattering"), std::string::npos) << taylor.message;
}

TEST(FormulaEvents, KeepAnEquilibriumOnASwitchingSurface) {
    const Scene scene = formula_scene(
        R"json("loads": [{"type": "torque", "frame": "body", "formula": "[0, 0, -sign(w.z)]"},
                     {"type": "force", "frame": "world", "formula": "-p"}])json",
        R"json("position": [1, 0, 0])json", 2);
    const Reference truth = reference(scene, 2, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    // mass 2 kg, stiffness 1 N/m
    EXPECT_NEAR(truth.samples.back().position_W[0].high, std::cos(2 / std::sqrt(2.0)), 1e-15);
    EXPECT_EQ(truth.samples.back().angular_velocity_B[2].high, 0);
}

}  // namespace
}  // namespace polhode
