// Lengths of vectors that pass zero: the series of a square root does not exist there.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "formula/formula_scene.h"

namespace polhode {
namespace {

using test::formula_scene;

constexpr double g = 9.81, mass = 2, drag = 0.25;
const double terminal = std::sqrt(mass * g / drag);

Scene vertical(const char* initial, const char* formula) {
    return formula_scene(std::string(R"json("parameters": {"c": 0.25, "k": 12},
        "loads": [{"type": "gravity", "acceleration": [0, 0, -9.81]}, {"type": "force", "frame": "world", "formula": ")json") +
                             formula + R"json("}])json",
                         initial);
}

// Compares z (m) and the speed along z (m/s) of truth and of `method` with a closed form.
void expect_motion(const Scene& scene, const char* method, const std::function<double(double)>& height,
                   const std::function<double(double)>& speed, int axis = 2) {
    const std::vector<double> times{0.25, 0.75, 1, 1.5, 2};
    const Reference truth = reference(scene, times, 25, 60);
    ASSERT_TRUE(truth.available) << truth.message;
    Settings settings;
    settings.tolerance = 1e-11, settings.times = times;
    const Trajectory run = solve(scene, *find_method(method), settings);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    for (std::size_t i = 0; i < times.size(); ++i) {
        const double t = times[i];
        EXPECT_NEAR(truth.samples[i].position_W[axis].high, height(t), 1e-13) << t;
        EXPECT_NEAR(truth.samples[i].velocity_W[axis].high, speed(t), 1e-13) << t;
        EXPECT_NEAR(run.samples[i].position_W[axis], height(t), 1e-9) << method << " " << t;
        EXPECT_NEAR(run.samples[i].velocity_W[axis], speed(t), 1e-9) << method << " " << t;
    }
}

// Quadratic drag from rest: v = -u tanh(g t/u), z = -u^2/g ln cosh(g t/u), u^2 = m g/c.
TEST(RootZero, BodyFallsFromRest) {
    for (const char* method : {"taylor", "dop853", "extrapolation"})
        expect_motion(
            vertical("", "-c*norm(v)*v"), method,
            [](double t) { return -terminal * terminal / g * std::log(std::cosh(g * t / terminal)); },
            [](double t) { return -terminal * std::tanh(g * t / terminal); });
}

// Thrown upwards: v = u tan(a - g t/u) with a = atan(v0/u) until t = a u/g, then the fall from rest.
TEST(RootZero, BodyTurnsRoundOnALine) {
    const double a = std::atan(6 / terminal), turn = a * terminal / g;
    const double top = -terminal * terminal / g * std::log(std::cos(a));
    expect_motion(
        vertical(R"json("velocity": [0, 0, 6])json", "-c*norm(v)*v"), "taylor",
        [&](double t) {
            return t < turn ? top + terminal * terminal / g * std::log(std::cos(a - g * t / terminal))
                            : top - terminal * terminal / g * std::log(std::cosh(g * (t - turn) / terminal));
        },
        [&](double t) {
            return t < turn ? terminal * std::tan(a - g * t / terminal)
                            : -terminal * std::tanh(g * (t - turn) / terminal);
        });
}

// A force of constant size towards a point that the body passes: parabolas of period 4 sqrt(2 m x0/k).
TEST(RootZero, DirectionIsReversedAtAPoint) {
    const double acceleration = 12 / mass, x0 = 0.5, quarter = std::sqrt(2 * x0 / acceleration);
    const Scene scene = formula_scene(R"json("parameters": {"k": 12},
        "loads": [{"type": "force", "frame": "world", "formula": "-k*unit(p)"}])json",
                                      R"json("position": [0.5, 0, 0])json");
    const auto phase = [=](double t, double& sign) {
        const double s = std::fmod(t + quarter, 4 * quarter);
        sign = s < 2 * quarter ? 1 : -1;
        return (s < 2 * quarter ? s : s - 2 * quarter) - quarter;
    };
    expect_motion(
        scene, "taylor",
        [=](double t) {
            double sign = 1;
            const double s = phase(t, sign);
            return sign * (x0 - acceleration * s * s / 2);
        },
        [=](double t) {
            double sign = 1;
            const double s = phase(t, sign);
            return -sign * acceleration * s;
        },
        0);
}

TEST(RootZero, AutoSelectsTheTaylorSeries) {
    const Scene scene = vertical("", "-c*norm(v)*v");
    EXPECT_STREQ(choose_method(pose(scene), 1e-10).method->name.data(), "taylor");
}

}  // namespace
}  // namespace polhode
