// Time per step of odeint_rk4, of a hand-written RK4 loop on plain arrays for the same scene, and of the
// structure-preserving methods. Compare only times of the same run.
#include <benchmark/benchmark.h>

#include <array>
#include <string>

#include "integrators/method.h"

namespace {

using namespace polhode;

constexpr long steps_per_call = 20000;

/// The free asymmetric body: omega = (1, 1, 1) rad/s, I = (1, 2, 3) kg m^2.
Scene free_body() {
    Scene scene;
    scene.name = "free body", scene.duration = 20;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 3));
    scene.initial.angular_velocity = {1, 1, 1};
    return scene;
}

/// Lagrange's top: a symmetric body with a fixed point, under gravity.
Scene heavy_top() {
    Scene scene;
    scene.name = "heavy top", scene.duration = 20;
    scene.body.inertia_B = diagonal(Vector3<double>(0.75, 0.75, 0.5));
    scene.body.center_of_mass = {0, 0, 0.5};
    scene.pivot = Vector3<double>(0, 0, 0);
    scene.initial.orientation = {0.9689124217106447, 0.24740395925452294, 0, 0};
    scene.initial.angular_velocity = {0, 0, 20};
    scene.loads = {Gravity{{0, 0, -9.80665}, {}}};
    return scene;
}

void library(benchmark::State& state, const Scene& scene, const char* name) {
    const Problem problem = pose(scene);
    const Method& method = *find_method(name);
    Settings settings;
    settings.step = scene.duration / steps_per_call;
    settings.samples = 1, settings.record = false;
    for (auto _ : state) {
        const Trajectory trajectory = solve(problem, method, settings);
        if (trajectory.steps != steps_per_call) state.SkipWithError("another number of steps");
        benchmark::DoNotOptimize(trajectory.samples.data());
    }
    state.counters["step"] =
        benchmark::Counter(static_cast<double>(steps_per_call),
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

using State = std::array<double, 7>;

/// One classical RK4 step on a plain array, in place.
template <class RightHandSide>
void rk4(const RightHandSide& f, double* y, double h) {
    double k1[7], k2[7], k3[7], k4[7], z[7];
    f(y, k1);
    for (int i = 0; i < 7; ++i) z[i] = y[i] + h / 2 * k1[i];
    f(z, k2);
    for (int i = 0; i < 7; ++i) z[i] = y[i] + h / 2 * k2[i];
    f(z, k3);
    for (int i = 0; i < 7; ++i) z[i] = y[i] + h * k3[i];
    f(z, k4);
    for (int i = 0; i < 7; ++i) y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
}

template <class RightHandSide>
void by_hand(benchmark::State& state, const Scene& scene, const RightHandSide& f) {
    const Vector3<double>& w = scene.initial.angular_velocity;
    const Quaternion<double>& q = scene.initial.orientation;
    double h = scene.duration / steps_per_call;
    benchmark::DoNotOptimize(h);
    for (auto _ : state) {
        double y[7] = {w[0], w[1], w[2], q.w, q.x, q.y, q.z};
        for (long i = 0; i < steps_per_call; ++i) rk4(f, y, h);
        benchmark::DoNotOptimize(y);
    }
    state.counters["step"] =
        benchmark::Counter(static_cast<double>(steps_per_call),
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void attitude(const double* y, double* dy) {
    const double a = 0.5 * y[0], b = 0.5 * y[1], c = 0.5 * y[2];
    dy[3] = -y[4] * a - y[5] * b - y[6] * c;
    dy[4] = y[3] * a + y[5] * c - y[6] * b;
    dy[5] = y[3] * b + y[6] * a - y[4] * c;
    dy[6] = y[3] * c + y[4] * b - y[5] * a;
}

/// I dw/dt = I w x w
struct FreeByHand {
    double g1, g2, g3;
    void operator()(const double* y, double* dy) const {
        dy[0] = g1 * y[1] * y[2], dy[1] = g2 * y[2] * y[0], dy[2] = g3 * y[0] * y[1];
        attitude(y, dy);
    }
};

/// A symmetric top with its centre of mass on the axis: the torque m g l e3 x R^T e_z has two components.
struct TopByHand {
    double g1, g2, twice_pull;  ///< 2 m g l / I1
    void operator()(const double* y, double* dy) const {
        const double up_x = y[4] * y[6] - y[3] * y[5], up_y = y[5] * y[6] + y[3] * y[4];
        dy[0] = g1 * y[1] * y[2] + twice_pull * up_y;
        dy[1] = g2 * y[2] * y[0] - twice_pull * up_x;
        dy[2] = 0;
        attitude(y, dy);
    }
};

void free_body_odeint_rk4(benchmark::State& state) { library(state, free_body(), "odeint_rk4"); }
void free_body_by_hand(benchmark::State& state) {
    double I[3] = {1, 2, 3};
    benchmark::DoNotOptimize(I);
    by_hand(state, free_body(), FreeByHand{(I[1] - I[2]) / I[0], (I[2] - I[0]) / I[1], (I[0] - I[1]) / I[2]});
}
void heavy_top_odeint_rk4(benchmark::State& state) { library(state, heavy_top(), "odeint_rk4"); }
void heavy_top_by_hand(benchmark::State& state) {
    double I[3] = {0.75 + 0.25, 0.75 + 0.25, 0.5}, weight = 9.80665, arm = 0.5;
    benchmark::DoNotOptimize(I);
    by_hand(state, heavy_top(), TopByHand{(I[1] - I[2]) / I[0], (I[2] - I[0]) / I[1], 2 * weight * arm / I[0]});
}

BENCHMARK(free_body_by_hand);
BENCHMARK(free_body_odeint_rk4);
BENCHMARK(heavy_top_by_hand);
BENCHMARK(heavy_top_odeint_rk4);

[[maybe_unused]] const bool registered = [] {
    for (const char* name : {"implicit_midpoint", "moser_veselov2", "moser_veselov4", "moser_veselov6",
                             "moser_veselov8", "moser_veselov10", "splitting2", "splitting4", "splitting6",
                             "splitting8", "splitting_exact2", "splitting_exact4", "splitting_exact6",
                             "splitting_exact8", "munthe_kaas4", "commutator_free4", "simo_wong", "buss"}) {
        const std::string title = name;
        benchmark::RegisterBenchmark(("free_body_" + title).c_str(),
                                     [name](benchmark::State& state) { library(state, free_body(), name); });
        // the modified moments of order 10 exist only for free bodies
        if (title == "moser_veselov10") continue;
        benchmark::RegisterBenchmark(("heavy_top_" + title).c_str(),
                                     [name](benchmark::State& state) { library(state, heavy_top(), name); });
    }
    return true;
}();

}  // namespace
