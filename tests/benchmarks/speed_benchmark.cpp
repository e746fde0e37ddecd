// Ratio of run times between polhode's integrators and the libraries' at equal error. Each benchmark runs the two
// alternately, each at the coarsest tolerance that keeps the attitude error below the level, and reports the median
// ratio. The experiment `speed` makes the published table, with more methods.
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>

#include "integrators/method.h"
#include "integrators/truth/reference.h"
#include "measure/errors.h"
#include "measure/statistics.h"
#include "scene/builtin.h"
#include "scene/scene_file.h"

namespace {

using namespace polhode;

constexpr long samples = 50;

Settings setting_for(const Problem& problem, const Reference& truth, const Method& method, double level) {
    Settings settings;
    settings.samples = samples;
    if (method.control == Control::none) return settings;
    // in half decades
    for (int i = -6; i >= -30; --i) {
        settings.tolerance = std::pow(10.0, i / 2.0);
        const Trajectory run = solve(problem, method, settings);
        if (run.status != Status::ok) continue;
        const Errors found = errors(error_series(problem.scene, run, truth), run, truth);
        if (found["attitude"].max.value_or(HUGE_VAL) <= level) return settings;
    }
    settings.tolerance.reset();
    return settings;
}

double seconds_of(const Problem& problem, const Method& method, const Settings& settings) {
    return solve(problem, method, settings).seconds;
}

void against(benchmark::State& state, const char* scene, const char* own, const char* peer, double level) {
    const Problem problem = pose(find_scene(scene));
    const Reference truth = reference(problem.scene, samples);
    const Method &a = *find_method(own), &b = *find_method(peer);
    Settings ours = setting_for(problem, truth, a, level), theirs = setting_for(problem, truth, b, level);
    if (!theirs.tolerance || (a.control != Control::none && !ours.tolerance)) {
        state.SkipWithError("one of the two does not reach this error");
        return;
    }
    ours.record = theirs.record = false;
    ours.repetitions = theirs.repetitions = 10;
    std::vector<double> ratios;
    for (auto _ : state) {
        const double mine = seconds_of(problem, a, ours), other = seconds_of(problem, b, theirs);
        state.SetIterationTime(mine);
        ratios.push_back(other / mine);
    }
    state.counters["ratio"] = median(ratios);
}

[[maybe_unused]] const bool registered = [] {
    const auto add = [](const char* scene, const char* own, const char* peer) {
        for (const double level : {1e-6, 1e-9, 1e-12}) {
            const std::string name = std::string("speed/") + scene + "/" + own + "/" + peer + "/" +
                                     (level == 1e-6   ? "1e-6"
                                      : level == 1e-9 ? "1e-9"
                                                      : "1e-12");
            benchmark::RegisterBenchmark(name.c_str(),
                                         [=](benchmark::State& state) { against(state, scene, own, peer, level); })
                ->UseManualTime()
                ->Iterations(99)
                ->Unit(benchmark::kMicrosecond);
        }
    };
    for (const char* free : {"free_asymmetric", "dzhanibekov"})
        for (const char* own : {"exact", "taylor", "extrapolation", "dop853"}) add(free, own, "odeint_fehlberg78");
    for (const char* own : {"taylor", "extrapolation", "dop853"}) add("lagrange_top", own, "odeint_fehlberg78");
    add("stiff_drag", "radau", "cvode_bdf");
    return true;
}();

}  // namespace
