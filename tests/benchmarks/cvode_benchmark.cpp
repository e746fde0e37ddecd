// Speed-up of CVODE by the fixed-size vector: the same Adams run with it and with SUNDIALS' serial vector, alternating
// in one loop with the same library. `ratio` is the shortest serial time divided by the shortest fixed time.
#include <benchmark/benchmark.h>

#include <chrono>
#include <limits>

#include "integrators/sundials/build.h"
#include "integrators/sundials/cvode_session.h"
#include "integrators/sundials/serial_vector_of.h"
#include "motion/systems.h"

namespace {

using namespace polhode;
using System7 = FreeRotation;

Problem free_body() {
    Scene scene;
    scene.name = "free body", scene.duration = 100;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 3));
    scene.initial.angular_velocity = {1, 1, 1};
    return pose(scene);
}

/// Seconds of one run to the end time; 0 if it failed.
template <class Session>
double run(Session& session, const Problem& problem) {
    const auto start = std::chrono::steady_clock::now();
    session.restart();
    session.enter(problem.segments.front());
    while (session.time() < problem.scene.duration)
        if (session.step() < 0) return 0;
    benchmark::DoNotOptimize(session.y());
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void vectors(benchmark::State& state, double tolerance) {
    const Problem problem = free_body();
    CvodeSession<System7, FixedVector<7>> fixed(problem, Multistep::adams, Iteration::functional, tolerance);
    CvodeSession<System7, SerialVectorOf<7>> serial(problem, Multistep::adams, Iteration::functional, tolerance);
    double shortest_fixed = std::numeric_limits<double>::infinity(), shortest_serial = shortest_fixed;
    for (auto _ : state) {
        const double on_fixed = run(fixed, problem), on_serial = run(serial, problem);
        if (on_fixed == 0 || on_serial == 0) {
            state.SkipWithError("a run failed");
            break;
        }
        shortest_fixed = std::min(shortest_fixed, on_fixed);
        shortest_serial = std::min(shortest_serial, on_serial);
        state.SetIterationTime(on_fixed);
    }
    state.counters["fixed_us"] = shortest_fixed * 1e6;
    state.counters["serial_us"] = shortest_serial * 1e6;
    state.counters["ratio"] = shortest_serial / shortest_fixed;
    state.counters["steps"] = static_cast<double>(fixed.steps());
    state.SetLabel("SUNDIALS " + sundials_build());
}

BENCHMARK_CAPTURE(vectors, cvode_adams_1e_6, 1e-6)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1);
BENCHMARK_CAPTURE(vectors, cvode_adams_1e_9, 1e-9)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1);

}  // namespace
