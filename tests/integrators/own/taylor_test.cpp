// Taylor series in binary64 against closed forms and the truth: every load, dense output, very small tolerances.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

#include "build_kind.h"
#include "catalogue.h"
#include "integrators/method.h"
#include "integrators/scenes.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/loaded_scene.h"
#include "integrators/truth/reference.h"
#include "measure/errors.h"

namespace polhode {
namespace {

using testing::free_body;

const Method& taylor() { return *find_method("taylor"); }

double error_against_truth(const Scene& scene, double tolerance, long samples = 50) {
    Settings settings;
    settings.tolerance = tolerance, settings.samples = samples;
    const Trajectory run = solve(scene, taylor(), settings);
    EXPECT_EQ(run.status, Status::ok) << run.message;
    const Reference truth = reference(scene, samples);
    EXPECT_TRUE(truth.available) << truth.message;
    return errors(error_series(scene, run, truth), run, truth)["attitude"].max.value_or(HUGE_VAL);
}

TEST(Taylor, KeepsItsToleranceUnderEveryLoad) {
    const FreshCache cache;
    for (unsigned seed = 0; seed < 6; ++seed) {
        const Scene scene = loaded_scene(seed, seed % 2 == 0);
        EXPECT_LT(error_against_truth(scene, 1e-9), 1e-7) << seed;
        EXPECT_LT(error_against_truth(scene, 1e-14), 3e-12) << seed;
    }
}

TEST(Taylor, IsAsAccurateAsItsArithmetic) {
    const FreshCache cache;
    const Scene body = free_body(100);
    EXPECT_LT(error_against_truth(body, 1e-16, 100), 2e-15);
    EXPECT_LT(error_against_truth(body, 1e-15, 100), 2e-15);
}

// The same motion `factor` times faster: times are shorter, speeds larger, torques and forces larger by its square.
Scene at_rate(Scene scene, double factor) {
    scene.duration /= factor;
    scene.initial.angular_velocity = factor * scene.initial.angular_velocity;
    scene.initial.velocity_W = factor * scene.initial.velocity_W;
    const auto window = [factor](auto& load) { load.window.from /= factor, load.window.until /= factor; };
    const double squared = factor * factor;
    for (Load& load : scene.loads) {
        if (auto* gravity = std::get_if<Gravity>(&load))
            gravity->acceleration_W = squared * gravity->acceleration_W, window(*gravity);
        if (auto* torque = std::get_if<Torque>(&load)) torque->vector = squared * torque->vector, window(*torque);
        if (auto* force = std::get_if<Force>(&load)) force->vector = squared * force->vector, window(*force);
        if (auto* impulse = std::get_if<Impulse>(&load))
            impulse->vector = factor * impulse->vector, impulse->at /= factor;
        if (auto* spring = std::get_if<Spring>(&load)) spring->stiffness *= squared, window(*spring);
        if (auto* drag = std::get_if<Drag>(&load))
            drag->rotational = factor * drag->rotational, drag->translational *= factor, window(*drag);
    }
    return scene;
}

Trajectory run_of(const Scene& scene, const char* method, std::optional<double> tolerance = {}) {
    Settings settings;
    settings.tolerance = tolerance, settings.samples = 25;
    const Trajectory run = solve(scene, *find_method(method), settings);
    EXPECT_EQ(run.status, Status::ok) << scene.duration << run.message;
    EXPECT_EQ(run.samples.size(), 26u);
    return run;
}

TEST(Taylor, MeetsTheClosedFormAtAnyRate) {
    for (const double rate : {1e-150, 1e-100, 1e-12, 1.0, 1e12, 1e100, 1e150}) {
        const Scene scene = at_rate(free_body(50), rate);
        const Trajectory exact = run_of(scene, "exact");
        for (const double tolerance : {1e-12, 1e-15}) {
            const Trajectory run = run_of(scene, "taylor", tolerance);
            ASSERT_EQ(run.samples.size(), exact.samples.size());
            for (std::size_t k = 0; k < run.samples.size(); ++k) {
                const Sample &a = run.samples[k], &b = exact.samples[k];
                EXPECT_EQ(a.t, sample_time(scene.duration, static_cast<long>(k), 25));
                const Quaternion<double> turn = conjugate(b.q) * a.q;
                EXPECT_LT(std::hypot(turn.x, turn.y, turn.z), 1e-10) << rate << " at sample " << k;
                for (int i = 0; i < 3; ++i)
                    EXPECT_NEAR(a.angular_velocity_B[i] / rate, b.angular_velocity_B[i] / rate, 1e-10) << rate;
            }
        }
    }
}

TEST(Taylor, IsRightUnderEveryLoadAtAnyRate) {
    const FreshCache cache;
    for (const double rate : {1e-40, 1e40})
        for (const bool pivoted : {false, true})
            EXPECT_LT(error_against_truth(at_rate(loaded_scene(1, pivoted), rate), 1e-12, 4), 1e-10) << rate;
}

// Scaling the time unit by a power of two changes no bit, so the two runs are identical.
TEST(Taylor, IsTheSameAtRatesAPowerOfTwoApart) {
    for (const double tolerance : {1e-10, 1e-15})
        for (const bool pivoted : {false, true}) {
            const Scene scene = loaded_scene(2, pivoted);
            const Trajectory plain = run_of(scene, "taylor", tolerance);
            for (const double rate : {0x1p-3, 0x1p-100, 0x1p+100}) {
                const Trajectory run = run_of(at_rate(scene, rate), "taylor", tolerance);
                ASSERT_EQ(run.samples.size(), plain.samples.size());
                EXPECT_EQ(run.steps, plain.steps);
                for (std::size_t k = 0; k < run.samples.size(); ++k) {
                    const Sample &a = run.samples[k], &b = plain.samples[k];
                    EXPECT_EQ(a.q, b.q) << rate << " at sample " << k;
                    EXPECT_EQ(a.t * rate, b.t);
                    EXPECT_EQ(a.position_W, b.position_W);
                    EXPECT_EQ(1 / rate * a.velocity_W, b.velocity_W);
                    EXPECT_EQ(1 / rate * a.angular_velocity_B, b.angular_velocity_B);
                }
            }
        }
}

// The largest distance (rad) between the attitudes of two runs with the same samples.
double attitude_apart(const Trajectory& a, const Trajectory& b) {
    double worst = a.samples.size() == b.samples.size() ? 0 : HUGE_VAL;
    for (std::size_t k = 0; worst < HUGE_VAL && k < a.samples.size(); ++k) {
        const Quaternion<double> turn = conjugate(b.samples[k].q) * a.samples[k].q;
        worst = std::max(worst, 2 * std::hypot(turn.x, turn.y, turn.z));
    }
    return worst;
}

TEST(Taylor, KeepsTheEnergyOfALongRun) {
    Scene scene = find_scene("free_asymmetric");
    scene.duration = optimised_build ? 10000 : 1000;
    const Trajectory run = run_of(scene, "taylor", 1e-15);
    const auto energy = [&scene](const Sample& sample) {
        const Vector3<double>& w = sample.angular_velocity_B;
        return dot(w, scene.body.inertia_B * w) / 2;
    };
    for (const Sample& sample : run.samples)
        EXPECT_NEAR(energy(sample) / energy(run.samples.front()), 1, 3e-15) << sample.t;
    EXPECT_LT(attitude_apart(run, run_of(scene, "exact")), 3e-11);
}

// Over ten thousand radians and more, the error is at most ten times the effect of rounding the initial data.
TEST(Taylor, SpinsFastWithinTheConditioningFloor) {
    Scene scene = find_scene("extreme/free_spin_1e6");
    scene.duration = optimised_build ? 0.1 : 0.005;
    const double radians = 1e6 * scene.duration;
    // float64_floor of this scene is 1.2e-10 rad at 10^6 rad and grows with the angle
    EXPECT_LT(attitude_apart(run_of(scene, "taylor", 1e-15), run_of(scene, "exact")), 10 * 1.2e-16 * radians);
}

// At equilibrium the coefficients of the rounded state vanish, but those of its low parts still decay.
TEST(Taylor, StaysAtAStiffEquilibriumWithCare) {
    const FreshCache cache;
    Scene scene = find_scene("extreme/drag_torque_1e4");
    scene.duration = 0.5;
    EXPECT_LT(error_against_truth(scene, 1e-15, 5), 3e-15);
}

// Samples use dense output: neither their number nor recording changes the steps.
TEST(Taylor, StepsDoNotDependOnSamples) {
    const Scene scene = free_body(20);
    Settings few, many;
    few.tolerance = many.tolerance = 1e-12;
    few.samples = 1, many.samples = 997;
    const Trajectory a = solve(scene, taylor(), few), b = solve(scene, taylor(), many);
    EXPECT_EQ(a.steps, b.steps);
    EXPECT_EQ(a.samples.back().q, b.samples.back().q);
    many.record = false;
    EXPECT_EQ(solve(scene, taylor(), many).samples.back().q, a.samples.back().q);
}

TEST(Taylor, EndsUnderAnyTolerance) {
    const Scene scene = free_body(20);
    for (const double tolerance : {0.5, 1e-3, 1e-15, 1e-17, 1e-100, 1e-300, 5e-324}) {
        Settings settings;
        settings.tolerance = tolerance;
        const Trajectory run = solve(scene, taylor(), settings);
        EXPECT_EQ(run.status, tolerance < 1e-16 ? Status::tolerance_not_met : Status::ok) << tolerance << run.message;
        EXPECT_LT(run.steps, 10'000);
    }
}

}  // namespace
}  // namespace polhode
