// Explicit steps on an array, for updates whose state is not one of the systems in motion/systems.h.
#pragma once

#include <array>
#include <cstddef>

namespace polhode {

/// y + h f(t, y).
struct ExplicitEuler {
    static constexpr int evaluations = 1;

    template <class S, std::size_t N, class F>
    static void step(const F& f, double t, std::array<S, N>& y, S h) {
        const std::array<S, N> k = f(t, y);
        for (std::size_t i = 0; i < N; ++i) y[i] += h * k[i];
    }
};

/// Kutta's classical method of order 4 (1901).
struct ClassicalRungeKutta {
    static constexpr int evaluations = 4;

    template <class S, std::size_t N, class F>
    static void step(const F& f, double t, std::array<S, N>& y, S h) {
        const auto moved = [&](S c, const std::array<S, N>& k) {
            std::array<S, N> z = y;
            for (std::size_t i = 0; i < N; ++i) z[i] += c * k[i];
            return z;
        };
        const std::array<S, N> k1 = f(t, y);
        const std::array<S, N> k2 = f(t + h / 2, moved(h / 2, k1));
        const std::array<S, N> k3 = f(t + h / 2, moved(h / 2, k2));
        const std::array<S, N> k4 = f(t + h, moved(h, k3));
        for (std::size_t i = 0; i < N; ++i) y[i] += h / 6 * ((k1[i] + k4[i]) + 2 * (k2[i] + k3[i]));
    }
};

}  // namespace polhode
