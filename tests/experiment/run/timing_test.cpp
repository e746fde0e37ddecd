#include "experiment/run/timing.h"

#include <gtest/gtest.h>

#include "integrators/method.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

// a closed form takes less than a microsecond, and its first run, with all that is cold, a hundred times that
TEST(Timing, IsOfManyRunsWhereTheFirstGuessWasACold) {
    const Problem problem = pose(find_scene("free_asymmetric"));
    Settings settings;
    settings.samples = 50;
    std::vector<TimedRun> runs{{&problem, find_method("exact"), settings, 5e-3}};
    time_interleaved(runs, 3, false);
    EXPECT_GT(runs[0].settings.repetitions, 1);
    EXPECT_EQ(runs[0].seconds.size(), 3u);
    EXPECT_LT(runs[0].median(), 1e-3);
}

// a run that takes long is not run more often than it is timed
TEST(Timing, IsOfOneRunThatTakesLong) {
    const Problem problem = pose(find_scene("free_asymmetric"));
    Settings settings;
    settings.samples = 50, settings.step = 1e-4;
    std::vector<TimedRun> runs{{&problem, find_method("odeint_rk4"), settings, 0.05}};
    time_interleaved(runs, 2, false);
    EXPECT_EQ(runs[0].settings.repetitions, 1);
    EXPECT_GE(runs[0].minimum(), 1e-4);
}

}  // namespace
}  // namespace polhode
