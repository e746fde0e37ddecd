#include "experiment/run/timing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "integrators/method.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

// A method with prescribed run times: `times` in order, then the last of them repeatedly. Records the requested
// repetitions.
struct FakeTimes {
    std::vector<double> times;  // s
    std::vector<int> repetitions{};

    static Trajectory solve(const void* context, const Problem&, const Settings& settings) {
        FakeTimes& fake = *static_cast<FakeTimes*>(const_cast<void*>(context));
        const std::size_t run = fake.repetitions.size();
        fake.repetitions.push_back(settings.repetitions);
        EXPECT_FALSE(settings.record);
        Trajectory end;
        end.seconds = fake.times[std::min(run, fake.times.size() - 1)];
        return end;
    }
};

// Times this method in `rounds` rounds, with `expected` s as the estimated time of a run.
TimedRun time_fake_run(FakeTimes& fake, double expected, int rounds) {
    const Problem problem = pose(find_scene("free_asymmetric"));
    Method method;
    method.name = "told", method.solve_in = FakeTimes::solve, method.context = &fake;
    std::vector<TimedRun> runs{{&problem, &method, Settings{}, expected}};
    time_interleaved(runs, rounds, false);
    return runs[0];
}

// a closed form takes less than a microsecond, but its first run, with cold caches, takes ten thousand times longer
TEST(Timing, IsOfManyRunsWhereTheFirstGuessWasACold) {
    FakeTimes fake{{2e-3, 3e-7}};
    const TimedRun run = time_fake_run(fake, 5e-3, 3);
    EXPECT_EQ(fake.repetitions, (std::vector<int>{1, 1, 334, 334, 334}))
        << "two pilot runs, because the first one is cold too";
    EXPECT_EQ(run.seconds.size(), 3u);
    EXPECT_EQ(run.median(), 3e-7);
}

// a long run is not repeated within a timing
TEST(Timing, IsOfOneRunThatTakesLong) {
    FakeTimes fake{{0.3, 0.1, 0.2}};
    const TimedRun run = time_fake_run(fake, 0.05, 3);
    EXPECT_EQ(fake.repetitions, (std::vector<int>{1, 1, 1}));
    EXPECT_EQ(run.minimum(), 0.1);
    EXPECT_EQ(run.median(), 0.2);
}

// a real method is repeated until a timing is well above the clock's resolution
TEST(Timing, OfAMethodIsAboveTheGrainOfTheClock) {
    const Problem problem = pose(find_scene("free_asymmetric"));
    Settings settings;
    settings.samples = 50;
    std::vector<TimedRun> runs{{&problem, find_method("exact"), settings, 5e-3}};
    time_interleaved(runs, 3, false);
    EXPECT_EQ(runs[0].seconds.size(), 3u);
    EXPECT_GT(runs[0].minimum(), 0);
    EXPECT_GT(runs[0].spent, 3 * runs[0].minimum());
}

}  // namespace
}  // namespace polhode
