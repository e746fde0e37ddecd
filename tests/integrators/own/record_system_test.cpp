// Compiled right-hand sides against the truth, which shares no code with them: random bodies under any loads of the
// scene format. POLHODE_RANDOM_SCENES sets a larger number of scenes than the test suite uses.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "integrators/method.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/loaded_scene.h"
#include "integrators/truth/reference.h"
#include "measure/errors.h"

namespace polhode {
namespace {

// each load is present with probability 1/2, so that every combination of terms occurs
Scene some_loads(unsigned seed) {
    Scene scene = loaded_scene(seed, seed % 2 == 0);
    Dice dice(seed + 1);
    std::erase_if(scene.loads, [&](const Load&) { return dice.number() < 0; });
    return scene;
}

TEST(RecordedSystems, AgreeWithTheTruth) {
    const FreshCache cache;
    const char* const asked = std::getenv("POLHODE_RANDOM_SCENES");
    const unsigned count = asked ? static_cast<unsigned>(std::stoul(asked)) : 20;
    constexpr long samples = 8;
    for (unsigned seed = 7000; seed < 7000 + count; ++seed) {
        const Scene scene = some_loads(seed);
        const Reference truth = reference(scene, samples);
        ASSERT_TRUE(truth.available) << seed << ": " << truth.message;
        for (const char* const method : {"taylor", "extrapolation"}) {
            Settings settings;
            settings.tolerance = 1e-13, settings.samples = samples;
            const Trajectory run = solve(scene, *find_method(method), settings);
            ASSERT_EQ(run.status, Status::ok) << seed << " " << method << ": " << run.message;
            const Errors off = errors(error_series(scene, run, truth), run, truth);
            for (const char* const block : {"attitude", "omega", "position", "velocity"}) {
                EXPECT_LT(off[block].max.value_or(0), 1e-10) << seed << " " << method << " " << block;
            }
            EXPECT_TRUE(off["attitude"].max) << seed << " " << method;
        }
    }
}

}  // namespace
}  // namespace polhode
