#include "experiment/run/timing.h"

#include <algorithm>
#include <cmath>

#include "integrators/run/watch.h"
#include "measure/statistics.h"

namespace polhode {
namespace {

constexpr double shortest_timing = 1e-4;  // s, a thousand times the clock's resolution and the cost of reading it
// the expected time includes samples and a cold start; a closed form can be a hundred times faster
constexpr double most_beyond_warm = 100;

}  // namespace

double TimedRun::minimum() const { return *std::min_element(seconds.begin(), seconds.end()); }

double TimedRun::median() const { return polhode::median(seconds); }

void time_interleaved(std::vector<TimedRun>& runs, int rounds, const std::atomic<bool>& stop) {
    const auto repetitions = [](double seconds) {
        return static_cast<int>(std::clamp(std::ceil(shortest_timing / std::max(seconds, 1e-9)), 1.0, 1000.0));
    };
    for (TimedRun& run : runs) {
        run.settings.record = false;
        run.settings.repetitions = repetitions(run.expected);
        if (run.expected > most_beyond_warm * shortest_timing || !run.failure.empty() || stop) continue;
        // two pilot runs, because the first one is cold too
        for (int pilots = 0; pilots < 2; ++pilots)
            if (const Trajectory pilot = solve(*run.problem, *run.method, run.settings); pilot.status == Status::ok)
                run.settings.repetitions = repetitions(pilot.seconds);
    }
    for (int round = 0; round < rounds; ++round) {
        for (std::size_t i = 0; i < runs.size() && !stop; ++i) {
            TimedRun& run = runs[i];
            if (!run.failure.empty()) continue;
            const Stopwatch stopwatch;
            const Trajectory end = solve(*run.problem, *run.method, run.settings);
            run.spent += stopwatch.seconds();
            run.limit_reached = end.limit_reached;
            if (end.status != Status::ok)
                run.failure = end.message;
            else
                run.seconds.push_back(end.seconds);
        }
    }
}

}  // namespace polhode
