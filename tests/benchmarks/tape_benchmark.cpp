// Cost of a compiled right-hand side: recording, preparation, compilation, series of order 16 by machine code and by
// the interpreter, and eight states at once compared with the system's own code.
#include <benchmark/benchmark.h>

#include <memory>
#include <string>

#include "integrators/own/record_system.h"
#include "integrators/tape/tape_series.h"
#include "motion/systems.h"
#include "scene/scene_file.h"

namespace {

using namespace polhode;

/// Calls `body` with the scene's system in its first segment and the state at the start.
template <class Body>
void with_start(const std::string& scene, Body&& body) {
    const Problem problem = pose(find_scene(scene));
    with_system(problem, [&]<class SystemType>() {
        SystemType system(problem);
        Numbers<run_time> y(system.size());
        system.initial(y.data());
        system.enter(problem.segments.front(), y.data());
        body(system, y);
    });
}

void record(benchmark::State& state, const std::string& scene) {
    with_start(scene, [&](const auto& system, const auto&) {
        for (auto _ : state) benchmark::DoNotOptimize(record_system<double>(system).rates.data());
    });
}
void compile(benchmark::State& state, const std::string& scene) {
    with_start(scene, [&](const auto& system, const auto&) {
        const auto recording = record_system<double>(system);
        const TapeOptions options{.order = 16};
        for (auto _ : state) benchmark::DoNotOptimize(PreparedTape(recording, options).code.get());
        const PreparedTape tape(recording, options);
        state.counters["operations"] = static_cast<double>(recording.tape.nodes.size());
        state.counters["bytes"] = tape.code ? static_cast<double>(tape.code->size()) : 0;
    });
}
void expand(benchmark::State& state, const std::string& scene, bool compiled) {
    with_start(scene, [&](const auto& system, const auto& y) {
        TapeSeries series(record_system<double>(system), {.compiled = compiled, .order = 16});
        for (auto _ : state) {
            series.expand(y.data());
            benchmark::ClobberMemory();
        }
    });
}
void eight_rates(benchmark::State& state, const std::string& scene) {
    with_start(scene, [&](const auto& system, const auto& y) {
        TapeRates rates(record_system<double>(system));
        std::vector<double, LineAllocator<double>> lanes(TapeRates::lanes * y.size()), now(lanes.size()), f = now;
        for (std::size_t i = 0; i < lanes.size(); ++i) lanes[i] = y[i / TapeRates::lanes];
        for (auto _ : state) {
            rates({lanes.data(), now.data(), lanes.data(), f.data()});
            benchmark::ClobberMemory();
        }
    });
}
void one_rate(benchmark::State& state, const std::string& scene) {
    with_start(scene, [&](const auto& system, const auto& y) {
        Numbers<run_time> f = y;
        for (auto _ : state) {
            system.derivative(0, y.data(), f.data());
            benchmark::ClobberMemory();
        }
    });
}

const int registered = [] {
    for (const std::string scene : {"free_asymmetric", "world_force", "every_load", "mechanisms/double_pendulum",
                                    "mechanisms/arm6", "mechanisms/chain_10"}) {
        benchmark::RegisterBenchmark(("tape_record/" + scene).c_str(), record, scene);
        benchmark::RegisterBenchmark(("tape_compile/" + scene).c_str(), compile, scene);
        benchmark::RegisterBenchmark(("tape_expand/" + scene + "/code").c_str(), expand, scene, true);
        benchmark::RegisterBenchmark(("tape_expand/" + scene + "/interpreter").c_str(), expand, scene, false);
        benchmark::RegisterBenchmark(("tape_rates/" + scene + "/eight").c_str(), eight_rates, scene);
        benchmark::RegisterBenchmark(("tape_rates/" + scene + "/one").c_str(), one_rate, scene);
    }
    return 0;
}();

}  // namespace
