// Cost of the closed forms, compared with one step of odeint_rk4 on the free body in the same run: set-up with one
// evaluation, and each further evaluation.
#include <benchmark/benchmark.h>

#include "integrators/method.h"

namespace {

using namespace polhode;

Scene free_body(const Vector3<double>& moments) {
    Scene scene;
    scene.name = "free body", scene.duration = 20;
    scene.body.inertia_B = diagonal(moments);
    scene.initial.angular_velocity = {1, 1.25, 0.75};
    return scene;
}

Scene heavy_top() {
    Scene scene = free_body({0.75, 0.75, 0.5});
    scene.body.center_of_mass = {0, 0, 0.5};
    scene.pivot = Vector3<double>(0, 0, 0);
    scene.initial.orientation = {0.96, 0.28, 0, 0};
    scene.initial.angular_velocity = {0, 0, 20};
    scene.loads = {Gravity{{0, 0, -9.80665}, {}}};
    return scene;
}

// Each call does `counted` evaluations; the counter is the time per evaluation.
void run(benchmark::State& state, const Scene& scene, const char* method, Settings settings, long counted) {
    const Problem problem = pose(scene);
    for (auto _ : state) {
        const Trajectory trajectory = solve(problem, *find_method(method), settings);
        if (trajectory.status != Status::ok) state.SkipWithError("not solved");
        benchmark::DoNotOptimize(trajectory.samples.data());
    }
    state.counters["each"] = benchmark::Counter(
        static_cast<double>(counted), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void rk4_step(benchmark::State& state) {
    constexpr long steps = 20000;
    const Scene scene = free_body({1, 2, 3});
    Settings settings;
    settings.samples = 1, settings.record = false, settings.step = scene.duration / steps;
    run(state, scene, "odeint_rk4", settings, steps);
}

// Set-up and one state, repeated inside one call.
void one_state(benchmark::State& state, const Scene& scene) {
    Settings settings;
    settings.samples = 1, settings.record = false, settings.repetitions = 1000;
    run(state, scene, "exact", settings, settings.repetitions);
}

// Recorded states; the first includes the set-up.
void further_states(benchmark::State& state, const Scene& scene) {
    Settings settings;
    settings.samples = 10000;
    run(state, scene, "exact", settings, settings.samples + 1);
}

const Scene asymmetric = free_body({1, 2, 3}), symmetric = free_body({1, 1, 2}), sphere = free_body({2, 2, 2});

BENCHMARK(rk4_step);
BENCHMARK_CAPTURE(one_state, asymmetric, asymmetric);
BENCHMARK_CAPTURE(further_states, asymmetric, asymmetric);
BENCHMARK_CAPTURE(one_state, symmetric, symmetric);
BENCHMARK_CAPTURE(further_states, symmetric, symmetric);
BENCHMARK_CAPTURE(one_state, sphere, sphere);
BENCHMARK_CAPTURE(further_states, sphere, sphere);
BENCHMARK_CAPTURE(one_state, heavy_top, heavy_top());
BENCHMARK_CAPTURE(further_states, heavy_top, heavy_top());

}  // namespace
