// Taylor series in binary64 against closed forms and the truth: every load, dense output, tolerances down to absurd
// ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

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

double attitude_error(const Scene& scene, double tolerance, long samples = 50) {
    Settings settings;
    settings.tolerance = tolerance, settings.samples = samples;
    const Trajectory run = solve(scene, taylor(), settings);
    EXPECT_EQ(run.status, Status::ok) << run.message;
    const Reference truth = reference(scene, samples);
    EXPECT_TRUE(truth.available) << truth.message;
    return errors(error_series(scene, run, truth), run, truth).attitude_max.value_or(HUGE_VAL);
}

TEST(Taylor, KeepsItsToleranceUnderEveryLoad) {
    const FreshCache cache;
    for (unsigned seed = 0; seed < 6; ++seed) {
        const Scene scene = loaded_scene(seed, seed % 2 == 0);
        EXPECT_LT(attitude_error(scene, 1e-9), 1e-7) << seed;
        EXPECT_LT(attitude_error(scene, 1e-14), 3e-12) << seed;
    }
}

TEST(Taylor, IsAsAccurateAsItsArithmetic) {
    const FreshCache cache;
    const Scene body = free_body(100);
    EXPECT_LT(attitude_error(body, 1e-16, 100), 4e-14);
}

// Samples are looked up: neither their number nor whether they are kept changes a step.
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
