#include "motion/dual.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "motion/moderate_scene.h"
#include "motion/systems.h"

namespace polhode {
namespace {

using namespace polhode::testing;

/// Compares the Jacobian with central differences at h = 1e-4. The right-hand sides are polynomials of degree at most
/// 4 in each component: R(q) is quadratic, p and v are linear, and no rotated tensor occurs. The error is h^2 times a
/// third derivative, relative 1e-8, plus the round-off 1e-16 / h.
template <class SystemType>
void check(const Problem& problem, const Sample& s) {
    constexpr int n = SystemType::dimension;
    std::array<double, n> y{};
    if constexpr (n == 3) {
        y = {s.angular_velocity_B[0], s.q.w, s.q.x};
    } else {
        put(y.data(), 0, s.angular_velocity_B);
        put(y.data(), 3, s.q);
        if constexpr (n == 13) put(y.data(), 7, s.position_W), put(y.data(), 10, s.velocity_W);
    }
    const SystemType system = SystemType(problem);
    std::array<double, n * n> J{};
    jacobian(system, 0, y.data(), J.data());
    double size = 1;
    for (double entry : J) size = std::max(size, std::abs(entry));
    const double h = 1e-4;
    for (int j = 0; j < n; ++j) {
        std::array<double, n> above = y, below = y, f_above{}, f_below{};
        above[j] += h, below[j] -= h;
        system.derivative(0, above.data(), f_above.data());
        system.derivative(0, below.data(), f_below.data());
        for (int i = 0; i < n; ++i)
            RC_ASSERT(std::abs((f_above[i] - f_below[i]) / (2 * h) - J[i * n + j]) < 1e-6 * size);
    }
}

RC_GTEST_PROP(Jacobian, IsWhatCentralDifferencesSay, ()) {
    const Scene scene = moderate_scene();
    const Problem reduced = pose(scene), full = pose(scene, Formulation::full);
    const Sample s = moderate_state(full);
    check<FreeRotation>(reduced, s);
    check<LoadedRotation>(reduced, s);
    check<LoadedMotion>(reduced, s);
    check<FullMotion>(full, s);
}

TEST(Jacobian, OfAPendulumIsTheFormula) {
    AxisEquations<double> pendulum;
    pendulum.inverse_moment = 0.5, pendulum.damping = 0.3, pendulum.cc = 1.1, pendulum.cs = -2, pendulum.ss = 0.7;
    const double w = 1.3, c = 0.8, s = 0.6, y[3] = {w, c, s};
    double J[9];
    jacobian(pendulum, 0, y, J);
    const double expected[9] = {
        -0.5 * 0.3, 0.5 * (2 * 1.1 * c - 2 * s), 0.5 * (-2 * c + 2 * 0.7 * s), -s / 2, 0, -w / 2, c / 2, w / 2, 0};
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(J[i], expected[i], 1e-15) << i;
}

}  // namespace
}  // namespace polhode
