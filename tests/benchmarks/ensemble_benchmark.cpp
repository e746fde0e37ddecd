// Ensemble throughput in bodies per second, over T = 10 s at an error of 1e-9 rad each: free bodies in closed form,
// Lagrange tops and general heavy bodies by extrapolation, with one and two threads.
#include <benchmark/benchmark.h>

#include "integrators/own/ensemble_scenes.h"

namespace {

using namespace polhode;

void run(benchmark::State& state, const Scene& scene, const std::vector<EnsembleBody>& bodies, double tolerance) {
    EnsembleSettings settings;
    settings.threads = static_cast<int>(state.range(0));
    settings.tolerance = tolerance;
    std::vector<EnsembleRow> rows(bodies.size());
    for (auto _ : state) {
        solve_ensemble(scene, bodies, settings, rows);
        for (const EnsembleRow& row : rows)
            if (row.status != Status::ok) state.SkipWithError("not solved");
        benchmark::DoNotOptimize(rows.data());
    }
    state.counters["bodies"] =
        benchmark::Counter(static_cast<double>(bodies.size()), benchmark::Counter::kIsIterationInvariantRate);
}

void free_ensemble(benchmark::State& state) {
    run(state, testing::free_scene(10), testing::free_bodies(100'000, 1), 1e-10);
}
void lagrange_tops(benchmark::State& state) {
    run(state, testing::top_scene(10), testing::tops(10'000, true, 2), 1e-10);
}
void heavy_bodies(benchmark::State& state) {
    run(state, testing::top_scene(10), testing::tops(10'000, false, 3), 1e-10);
}

BENCHMARK(free_ensemble)->Arg(1)->Arg(2)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(lagrange_tops)->Arg(1)->Arg(2)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(heavy_bodies)->Arg(1)->Arg(2)->UseRealTime()->MeasureProcessCPUTime();

}  // namespace
