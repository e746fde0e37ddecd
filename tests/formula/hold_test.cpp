// Sampled formulas (zero-order hold) against the recursions of sampled linear systems.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "formula/formula_scene.h"
#include "text/message.h"

namespace polhode {
namespace {

struct SampledState {
    long double x, v;
};
// The states of m x'' = -k x_n - c v_n at the times n h, where x_n and v_n are those at n h.
std::vector<SampledState> sampled_oscillator(long double m, long double k, long double c, long double h, SampledState s,
                                             int count) {
    std::vector<SampledState> all{s};
    for (int n = 0; n < count; ++n) {
        const long double a = -(k * s.x + c * s.v) / m;
        s = {s.x + h * s.v + h * h / 2 * a, s.v + h * a};
        all.push_back(s);
    }
    return all;
}

const char* const sampled_start = R"json("position": [1, 0, 0], "velocity": [-0.5, 0, 0])json";

TEST(FormulaHold, FollowsTheRecursionOfASampledController) {
    const Scene scene = test::formula_scene(
        R"json("parameters": {"k": 3, "c": 2.5}, "loads": [{"type": "force", "frame": "world", "hold": 0.25, "formula": "-k*p - c*v"}])json",
        sampled_start, 4);
    const std::vector<SampledState> expected = sampled_oscillator(2, 3, 2.5L, 0.25L, {1, -0.5L}, 16);
    const Reference truth = reference(scene, 16, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    for (std::size_t i = 0; i <= 16; ++i) {
        EXPECT_NEAR(truth.samples[i].position_W[0].high, static_cast<double>(expected[i].x), 1e-16);
        EXPECT_NEAR(truth.samples[i].velocity_W[0].high, static_cast<double>(expected[i].v), 1e-16);
    }
    for (const char* method : {"taylor", "extrapolation", "dop853", "radau", "cvode_adams", "cvode_bdf"}) {
        const Trajectory found = test::solve_with(scene, method, 1e-10, 16);
        ASSERT_EQ(found.status, Status::ok) << method << ": " << found.message;
        const double least = std::string(method).starts_with("cvode") ? 1e-7 : 1e-11;
        for (std::size_t i = 0; i <= 16; ++i)
            EXPECT_NEAR(found.samples[i].position_W[0], static_cast<double>(expected[i].x), least) << method;
    }
    // the force is constant in each step, so that the classical Runge-Kutta method is exact
    Settings settings;
    settings.step = 0.125, settings.samples = 16;
    const Trajectory fixed = solve(pose(scene), *find_method("odeint_rk4"), settings);
    ASSERT_EQ(fixed.status, Status::ok) << fixed.message;
    for (std::size_t i = 0; i <= 16; ++i)
        EXPECT_NEAR(fixed.samples[i].position_W[0], static_cast<double>(expected[i].x), 1e-14);
}

// Samples between the sampling times, and at a time that is not representable: 3 * 0.1.
TEST(FormulaHold, HoldsTheValueBetweenSamplingTimes) {
    const Scene scene = test::formula_scene(
        R"json("loads": [{"type": "force", "frame": "world", "formula": "hold([-2*mass*t, 0, 0], 0.1)"}])json", "",
        0.35);
    const Reference truth = reference(scene, 7, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    // v' = -2 t_n: v(0.3) = -2 * 0.1 * (0.1 + 0.2), v(0.35) = v(0.3) - 2 * 0.3 * 0.05
    EXPECT_NEAR(truth.samples[6].velocity_W[0].high, -0.06, 1e-16);
    EXPECT_NEAR(truth.samples[7].velocity_W[0].high, -0.09, 1e-16);
    const Trajectory taylor = test::solve_with(scene, "taylor", 1e-14, 7);
    for (std::size_t i = 0; i <= 7; ++i)
        EXPECT_NEAR(taylor.samples[i].velocity_W[0], truth.samples[i].velocity_W[0].high, 1e-16);
}

// A value that is held is sampled again with a longer period; the load acts only from 0.75 s on.
TEST(FormulaHold, CombinesPeriodsAndWindows) {
    const Scene scene = test::formula_scene(
        R"json("parameters": {"slow": 0.5},
           "loads": [{"type": "force", "frame": "world", "formula": "[mass*hold(hold(t, 0.25), slow), 0, 0]", "from": 0.75}])json",
        "", 2);
    const Reference truth = reference(scene, 8, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    // acceleration 0.5 from 0.75 s to 1 s, then 1 until 1.5 s, then 1.5
    EXPECT_EQ(truth.samples[3].velocity_W[0].high, 0);
    EXPECT_NEAR(truth.samples[4].velocity_W[0].high, 0.125, 1e-16);
    EXPECT_NEAR(truth.samples[6].velocity_W[0].high, 0.625, 1e-16);
    EXPECT_NEAR(truth.samples[8].velocity_W[0].high, 1.375, 1e-16);
}

TEST(FormulaHold, SamplesAMotor) {
    const Scene scene = parse_scene(R"json({"name": "sampled", "duration": 2,
        "bodies": [{"name": "wheel", "body": {"mass": 1, "inertia": [0.3, 0.3, 0.5]}}],
        "joints": [{"name": "axle", "type": "revolute", "parent": "world", "child": "wheel", "axis": [0, 0, 1],
                    "initial": {"angle": 0.25, "rate": 1}}],
        "loads": [{"type": "motor", "joint": "axle", "hold": 0.125, "formula": "-1.5*axle.angle - 0.75*axle.rate"}]})json",
                                    "sampled.json", "");
    const std::vector<SampledState> expected = sampled_oscillator(0.5L, 1.5L, 0.75L, 0.125L, {0.25L, 1}, 16);
    const Reference truth = reference(scene, 16, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    const Trajectory taylor = test::solve_with(scene, "taylor", 1e-14, 16);
    const Trajectory radau = test::solve_with(scene, "radau", 1e-12, 16);
    for (std::size_t i = 0; i <= 16; ++i) {
        EXPECT_NEAR(truth.samples[i].angular_velocity_B[2].high, static_cast<double>(expected[i].v), 1e-15);
        EXPECT_NEAR(taylor.samples[i].angular_velocity_B[2], static_cast<double>(expected[i].v), 1e-14);
        EXPECT_NEAR(radau.samples[i].angular_velocity_B[2], static_cast<double>(expected[i].v), 1e-11);
    }
}

// The sampled limit of a saturated controller: the sampling times and the switches are both events.
TEST(FormulaHold, IsCombinedWithSwitches) {
    // 2 v' = -clamp(hold(4 v), -1, 1) with v = 2 at first: v falls by 1/8 per sample until 4 v < 1
    const Scene scene = test::formula_scene(
        R"json("loads": [{"type": "force", "frame": "world", "formula": "[-clamp(hold(4*v.x, 0.25), -1, 1), 0, 0]"}])json",
        R"json("velocity": [2, 0, 0])json", 6);
    const Reference truth = reference(scene, 24, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    const Trajectory taylor = test::solve_with(scene, "taylor", 1e-13, 24);
    ASSERT_EQ(taylor.status, Status::ok) << taylor.message;
    double v = 2;
    for (std::size_t i = 0; i <= 24; ++i) {
        EXPECT_NEAR(truth.samples[i].velocity_W[0].high, v, 1e-15);
        EXPECT_NEAR(taylor.samples[i].velocity_W[0], v, 1e-14);
        v -= 0.25 / 2 * std::min(1.0, 4 * v);
    }
}

std::string hold_fault(const std::string& members) {
    try {
        test::formula_scene(members);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

TEST(FormulaHold, IsReadWrittenAndRefused) {
    const Scene scene =
        test::formula_scene(R"json("loads": [{"type": "torque", "frame": "body", "formula": "-w", "hold": 0.01}])json");
    EXPECT_EQ(std::get<FormulaLoad>(scene.loads[0]).formula, "hold(-w, 0.01)");
    EXPECT_EQ(write_scene(parse_scene(write_scene(scene), "written.json", "")), write_scene(scene));
    const struct {
        const char *members, *message;
    } cases[] = {
        {R"json("loads": [{"type": "torque", "frame": "body", "formula": "-w", "hold": 0}])json",
         "/loads/0/hold: is 0"},
        {R"json("loads": [{"type": "torque", "frame": "body", "vector": [0, 0, 1], "hold": 1}])json",
         "/loads/0/hold: is given without \"formula\""},
        {R"json("loads": [{"type": "potential", "formula": "hold(p.z, 1)"}])json", "a velocity or a held value"},
        {R"json("loads": [{"type": "torque", "frame": "body", "formula": "hold(w, 1e-9)"}])json",
         "the period of \"hold\" is 1e-09 s; give a period > 0 with at most 20000 samples in the run"},
        {R"json("loads": [{"type": "torque", "frame": "body", "formula": "hold(w, t)"}])json",
         "the period depends on time or state"},
        {R"json("loads": [{"type": "torque", "frame": "body", "formula": "hold(w, 1/3)"}])json",
         "is not a number or a parameter"},
        {R"json("loads": [{"type": "torque", "frame": "body", "formula": "hold(q, 1)"}])json",
         "a quaternion cannot be held"},
    };
    for (const auto& one : cases)
        EXPECT_NE(hold_fault(one.members).find(one.message), std::string::npos) << one.members << "\n"
                                                                                << hold_fault(one.members);
}

}  // namespace
}  // namespace polhode
