// Formula loads of one body against built-in loads and closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formula/formula_scene.h"
#include "motion/formula_model.h"

namespace polhode {
namespace {

using test::formula_scene;
using test::solve_with;

const char* const tumbling =
    R"json("angular_velocity": [0.5, 1.5, -0.7], "position": [0.2, 0, 1], "velocity": [1, -0.5, 0.25],
       "orientation": [0.8, 0.36, -0.48, 0])json";

struct LoadPair {
    const char *name, *built_in, *formula;
};
// The same load, built in and as a formula.
const LoadPair load_pairs[] = {
    {"torque", R"json([{"type": "torque", "frame": "body", "vector": [0.1, 0.2, -0.3]}])json",
     R"json([{"type": "torque", "frame": "body", "formula": ["0.1", 0.2, "-k"]}])json"},
    {"world torque", R"json([{"type": "torque", "frame": "world", "vector": [0.1, 0.2, -0.3]}])json",
     R"json([{"type": "torque", "frame": "world", "formula": "[0.1, 0.2, -k]"}])json"},
    {"force at a body point",
     R"json([{"type": "force", "frame": "world", "vector": [0, 0.5, -2], "point": [0.5, 0.25, 0]}])json",
     R"json([{"type": "force", "frame": "world", "formula": "[0, 0.5, -2]", "point": [0.5, 0.25, 0]}])json"},
    {"body force at a world point",
     R"json([{"type": "force", "frame": "body", "vector": [0, 0.5, -2], "point": [0.5, 0.25, 0], "point_frame": "world"}])json",
     R"json([{"type": "force", "frame": "body", "formula": "[0, 0.5, -2]", "point": [0.5, 0.25, 0], "point_frame": "world"}])json"},
    {"drag", R"json([{"type": "drag", "rotational": [0.1, 0.2, 0.3], "translational": 0.4}])json",
     R"json([{"type": "torque", "frame": "body", "formula": "[-0.1*w.x, -0.2*w.y, -k*w.z]"},
         {"type": "force", "frame": "world", "formula": "-0.4*v"}])json"},
    {"world drag", R"json([{"type": "drag", "rotational": [0.3, 0.3, 0.3], "translational": 0.4}])json",
     R"json([{"type": "torque", "frame": "world", "formula": "-k*w_W"},
         {"type": "force", "frame": "body", "formula": "-0.4*to_body(v)"}])json"},
    {"gravity", R"json([{"type": "gravity", "acceleration": [0, 0, -9.75]}])json",
     R"json([{"type": "potential", "formula": "9.75*mass*p.z"}])json"},
    // k (1 - cos angle), and the trace of the rotation matrix is 1 + 2 cos angle
    {"spring", R"json([{"type": "spring", "stiffness": 0.3, "rest_orientation": [1, 0, 0, 0]}])json",
     R"json([{"type": "potential",
          "formula": "k/2*(3 - to_world([1, 0, 0]).x - to_world([0, 1, 0]).y - to_world([0, 0, 1]).z)"}])json"},
    {"windows",
     R"json([{"type": "torque", "frame": "body", "vector": [0.1, 0.2, -0.3], "from": 0.5, "until": 1.5}])json",
     R"json([{"type": "torque", "frame": "body", "formula": "[0.1, 0.2, -k]", "from": 0.5, "until": 1.5}])json"},
};

// The energy counts a built-in force that is constant in the world as a potential.
bool counts_energy(const LoadPair& pair) { return std::string(pair.name) != "force at a body point"; }

std::string with_parameter(const char* loads) {
    return std::string(R"json("parameters": {"k": 0.3}, "loads": )json") + loads;
}

TEST(FormulaLoads, HaveTheReferenceOfTheBuiltInLoads) {
    for (const LoadPair& pair : load_pairs) {
        const Reference built_in =
            reference(formula_scene(std::string("\"loads\": ") + pair.built_in, tumbling), 4, 30);
        const Reference formula = reference(formula_scene(with_parameter(pair.formula), tumbling), 4, 30);
        ASSERT_TRUE(built_in.available) << pair.name << ": " << built_in.message;
        ASSERT_TRUE(formula.available) << pair.name << ": " << formula.message;
        EXPECT_LT(test::difference(built_in, formula, counts_energy(pair)), 1e-28) << pair.name;
        EXPECT_LT(formula.bound, 1e-30) << pair.name;
    }
}

TEST(FormulaLoads, HaveTheReferenceOfTheBuiltInLoadsAboutAPivot) {
    const std::string pivot = R"json("pivot": [0, 0, -0.5], )json";
    const char* start = R"json("angular_velocity": [0.5, 1.5, 4], "orientation": [0.8, 0.36, -0.48, 0])json";
    for (const LoadPair& pair : load_pairs) {
        const Reference built_in = reference(formula_scene(pivot + "\"loads\": " + pair.built_in, start), 3, 28);
        const Reference formula = reference(formula_scene(pivot + with_parameter(pair.formula), start), 3, 28);
        ASSERT_TRUE(built_in.available && formula.available) << pair.name << formula.message;
        EXPECT_LT(test::difference(built_in, formula, counts_energy(pair)), 1e-26) << pair.name;
    }
}

// The largest attitude and position error of a trajectory, absolute.
double error_of(const Trajectory& trajectory, const Reference& truth) {
    double worst = 0;
    for (std::size_t i = 0; i < truth.samples.size(); ++i) {
        const Sample &found = trajectory.samples[i], exact = truth.samples[i].rounded();
        const Quaternion<double> between = conjugate(exact.q) * found.q;
        const Vector3<double> p = found.position_W - exact.position_W;
        worst = std::max({worst, 2 * std::sqrt(dot(vector_part(between), vector_part(between))), std::sqrt(dot(p, p))});
    }
    return worst;
}

const char* const smooth_loads = R"json("parameters": {"k": 0.3, "mu": 2}, "let": {"r": "norm(p)"
}, "loads": [
    {"type": "force", "frame": "world", "formula": "-mu*mass*p/r^3 - 0.1*norm(v)*v + [0, 0, exp(-t)]"},
    {"type": "torque", "frame": "body", "formula": "-k*tanh(w.z)*w + 0.1*cross(unit(to_body(p)), inertia(w)) + [sin(2*t), 0, log(2 + t)]"},
    {"type": "potential", "formula": "k*acos(0.5*to_world([0, 0, 1]).z) + cbrt(2 + to_world([1, 0, 0]).x)"}])json";

TEST(FormulaLoads, AreSolvedByEveryMethodOrRefused) {
    const Scene scene = formula_scene(smooth_loads, tumbling, 1);
    const Problem problem = pose(scene);
    const Reference truth = reference(scene, 10, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    int solved = 0;
    for (const Method* method : methods()) {
        if (method->family == Family::engine) continue;
        Settings settings;
        settings.samples = 10;
        if (takes_tolerance(*method))
            settings.tolerance = 1e-9;
        else if (takes_step(*method))
            settings.step = 1e-3;
        const Trajectory trajectory = solve(problem, *method, settings);
        if (trajectory.status == Status::unsupported) {
            EXPECT_NE(trajectory.message, "") << method->name;
            continue;
        }
        EXPECT_EQ(trajectory.status, Status::ok) << method->name << ": " << trajectory.message;
        if (trajectory.status == Status::ok) {
            EXPECT_LT(error_of(trajectory, truth), 2e-3) << method->name;
        }
        ++solved;
    }
    EXPECT_GT(solved, 20);
    EXPECT_LT(error_of(solve_with(scene, "taylor", 1e-15, 10), truth), 1e-13);
    EXPECT_LT(error_of(solve_with(scene, "extrapolation", 1e-13, 10), truth), 1e-11);
    EXPECT_LT(error_of(solve_with(scene, "dop853", 1e-13, 10), truth), 1e-11);
    EXPECT_LT(error_of(solve_with(scene, "radau", 1e-12, 10), truth), 1e-10);
}

// dv/dt = g - (g / v_T^2) v^2 from v0: v = v_T tanh(g t / v_T + atanh(v0 / v_T))
TEST(FormulaLoads, ReachTerminalSpeed) {
    const double g = 9.75, c = 0.5, mass = 2, v0 = 1, terminal = std::sqrt(mass * g / c);
    const Scene scene = formula_scene(
        R"json("loads": [{"type": "gravity", "acceleration": [0, 0, -9.75]},
                     {"type": "force", "frame": "world", "formula": "-0.5*norm(v)*v"}])json",
        R"json("velocity": [0, 0, -1])json", 3);
    const Reference truth = reference(scene, 12, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    const Trajectory taylor = solve_with(scene, "taylor", 1e-15, 12);
    for (std::size_t i = 0; i < truth.samples.size(); ++i) {
        const double t = truth.samples[i].t, start = std::atanh(v0 / terminal), end = g * t / terminal + start;
        EXPECT_NEAR(truth.samples[i].velocity_W[2].high, -terminal * std::tanh(end), 1e-14);
        const double fallen = terminal * terminal / g * std::log(std::cosh(end) / std::cosh(start));
        EXPECT_NEAR(truth.samples[i].position_W[2].high, -fallen, 1e-13);
        EXPECT_NEAR(taylor.samples[i].position_W[2], -fallen, 1e-13);
    }
}

// Ten revolutions with eccentricity 1/2 against Kepler's equation.
TEST(FormulaLoads, FollowAKeplerOrbit) {
    const double e = 0.5, period = 2 * std::numbers::pi;
    Scene scene = formula_scene(
        R"json("parameters": {"mu": 1}, "loads": [{"type": "force", "frame": "world", "formula": "-mu*mass*p/norm(p)^3"}])json",
        R"json("position": [0.5, 0, 0], "angular_velocity": [0.1, 0.2, 0.3])json");
    scene.initial.velocity_W = {0, std::sqrt(3.0), 0};
    scene.duration = 10 * period;
    const Reference truth = reference(scene, 40, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    // the binary64 nearest to sqrt 3 is 1e-16 off, so the period is, too: a = 1 / (2/r - v^2)
    const long double v = std::sqrt(3.0), a = 1 / (4 - v * v), n = 1 / std::sqrt(a * a * a), ecc = 1 - 0.5L / a;
    for (std::size_t i = 0; i < truth.samples.size(); ++i) {
        const long double M = n * truth.samples[i].t;
        long double E = M;
        for (int k = 0; k < 60; ++k) E -= (E - ecc * std::sin(E) - M) / (1 - ecc * std::cos(E));
        const long double x = a * (std::cos(E) - ecc), y = a * std::sqrt(1 - ecc * ecc) * std::sin(E);
        EXPECT_NEAR(truth.samples[i].position_W[0].high, static_cast<double>(x), 1e-13);
        EXPECT_NEAR(truth.samples[i].position_W[1].high, static_cast<double>(y), 1e-13);
    }
    EXPECT_NEAR(static_cast<double>(ecc), e, 1e-15);
}

// The potential of Henon and Heiles (1964) at E = 1/12, a mass point of 2 kg: energy is conserved.
TEST(FormulaLoads, CountPotentialsAsEnergy) {
    const Scene scene = formula_scene(
        R"json("loads": [{"type": "potential", "formula": "mass*((p.x^2 + p.y^2)/2 + p.x^2*p.y - p.y^3/3)"}])json",
        R"json("position": [0, 0.1, 0], "velocity": [0.39, 0, 0])json", 50);
    const Reference truth = reference(scene, 20, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    for (const ReferenceSample& sample : truth.samples)
        EXPECT_LT(std::abs(test::difference(sample.energy, truth.samples.front().energy)), 1e-22);
    EXPECT_NEAR(truth.samples.front().energy.high, 0.39 * 0.39 + 0.01 - 2 * 0.001 / 3, 1e-15);
}

}  // namespace
}  // namespace polhode
