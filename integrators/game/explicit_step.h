// Explicit steps on an array, for updates whose state is none of the systems of motion/systems.h.
#pragma once

#include <array>
#include <cstddef>

namespace polhode {

/// y + h f(t, y)
struct ExplicitEuler {
    static constexpr int evaluations = 1;

    template <std::size_t N, class F>
    static void step(const F& f, double t, std::array<double, N>& y, double h) {
        const std::array<double, N> k = f(t, y);
        for (std::size_t i = 0; i < N; ++i) y[i] += h * k[i];
    }
};

/// Kutta's classical method of order 4 (1901).
struct ClassicalRungeKutta {
    static constexpr int evaluations = 4;

    template <std::size_t N, class F>
    static void step(const F& f, double t, std::array<double, N>& y, double h) {
        const auto moved = [&](double c, const std::array<double, N>& k) {
            std::array<double, N> z = y;
            for (std::size_t i = 0; i < N; ++i) z[i] += c * k[i];
            return z;
        };
        const std::array<double, N> k1 = f(t, y);
        const std::array<double, N> k2 = f(t + h / 2, moved(h / 2, k1));
        const std::array<double, N> k3 = f(t + h / 2, moved(h / 2, k2));
        const std::array<double, N> k4 = f(t + h, moved(h, k3));
        for (std::size_t i = 0; i < N; ++i) y[i] += h / 6 * ((k1[i] + k4[i]) + 2 * (k2[i] + k3[i]));
    }
};

}  // namespace polhode
