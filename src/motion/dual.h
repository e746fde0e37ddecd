// Forward differentiation: a value with its derivatives in N directions. The Jacobian of the one right-hand side is
// got by running it on these, so no load needs a second derivation.
#pragma once

#include <array>
#include <concepts>
#include <vector>

#include "body/elementary.h"

namespace polhode {

/// S: the scalar of value and derivatives; P: that of the parameters, which have none.
template <int N, class S = double, class P = S>
struct Dual {
    S value{};
    std::array<S, N> slope{};

    Dual() = default;
    explicit Dual(const P& v) : value(v) {}
    template <std::integral Whole>
    explicit Dual(Whole v) : value(P(v)) {}

    friend Dual operator+(const Dual& a, const Dual& b) {
        Dual c;
        c.value = a.value + b.value;
        for (int i = 0; i < N; ++i) c.slope[i] = a.slope[i] + b.slope[i];
        return c;
    }
    friend Dual operator-(const Dual& a, const Dual& b) {
        Dual c;
        c.value = a.value - b.value;
        for (int i = 0; i < N; ++i) c.slope[i] = a.slope[i] - b.slope[i];
        return c;
    }
    friend Dual operator-(const Dual& a) {
        Dual c;
        c.value = -a.value;
        for (int i = 0; i < N; ++i) c.slope[i] = -a.slope[i];
        return c;
    }
    friend Dual operator*(const Dual& a, const Dual& b) {
        Dual c;
        c.value = a.value * b.value;
        for (int i = 0; i < N; ++i) c.slope[i] = a.value * b.slope[i] + a.slope[i] * b.value;
        return c;
    }
    friend Dual operator/(const Dual& a, const Dual& b) {
        Dual c;
        c.value = a.value / b.value;
        for (int i = 0; i < N; ++i) c.slope[i] = (a.slope[i] - c.value * b.slope[i]) / b.value;
        return c;
    }
    friend Dual operator*(const P& a, const Dual& b) {
        Dual c;
        c.value = a * b.value;
        for (int i = 0; i < N; ++i) c.slope[i] = a * b.slope[i];
        return c;
    }
    friend Dual operator*(const Dual& a, const P& b) { return b * a; }
    friend Dual operator+(const Dual& a, const P& b) {
        Dual c = a;
        c.value = c.value + b;
        return c;
    }
    friend Dual operator+(const P& a, const Dual& b) { return b + a; }
    friend Dual operator-(const Dual& a, const P& b) { return a + (-b); }
    friend Dual operator-(const P& a, const Dual& b) { return -b + a; }
    friend Dual operator/(const Dual& a, const P& b) {
        Dual c;
        c.value = a.value / b;
        for (int i = 0; i < N; ++i) c.slope[i] = a.slope[i] / b;
        return c;
    }
    friend Dual operator/(const P& a, const Dual& b) {
        Dual c;
        c.value = a / b.value;
        const S change = -(c.value / b.value);
        for (int i = 0; i < N; ++i) c.slope[i] = change * b.slope[i];
        return c;
    }
    Dual& operator+=(const Dual& b) { return *this = *this + b; }
    Dual& operator-=(const Dual& b) { return *this = *this - b; }
    /// What square_root() calls.
    friend Dual sqrt(const Dual& a) {
        Dual c;
        c.value = square_root(a.value);
        const S twice = c.value + c.value;
        for (int i = 0; i < N; ++i) c.slope[i] = a.slope[i] / twice;
        return c;
    }
};

/// @cond specialisations
/// What sine_cosine() calls.
template <int N, class S, class P>
struct Elementary<Dual<N, S, P>> {
    static void sine_cosine(const Dual<N, S, P>& x, Dual<N, S, P>& sine, Dual<N, S, P>& cosine) {
        const Dual<N, S, P> angle = x;  // x may be one of the results
        polhode::sine_cosine(angle.value, sine.value, cosine.value);
        for (int i = 0; i < N; ++i) {
            sine.slope[i] = cosine.value * angle.slope[i];
            cosine.slope[i] = -(sine.value * angle.slope[i]);
        }
    }
};
/// @endcond

/// As many columns of a Jacobian of a size that only the program knows are found in one evaluation.
inline constexpr int own_directions = 8;

/// J[i * N + j] = d f_i / d y_j of a system of dimension N, row by row. User torques are not differentiated.
template <class SystemType>
requires(SystemType::dimension > 0) void jacobian(const SystemType& system, double t, const double* y, double* J) {
    constexpr int N = SystemType::dimension;
    std::array<Dual<N>, N> state, rate;
    for (int i = 0; i < N; ++i) state[i] = Dual<N>(y[i]), state[i].slope[i] = 1;
    system.derivative(t, state.data(), rate.data());
    for (int i = 0; i < N; ++i)
        for (int j = 0; j < N; ++j) J[i * N + j] = rate[i].slope[j];
}

/// The same of n = system.size() components, as many columns at a time as one evaluation finds.
template <int columns, class SystemType>
void jacobian_by_columns(const SystemType& system, double t, const double* y, double* J) {
    const int n = system.size();
    std::vector<Dual<columns>> state(n), rate(n);
    for (int first = 0; first < n; first += columns) {
        for (int i = 0; i < n; ++i) {
            state[i] = Dual<columns>(y[i]);
            if (i >= first && i < first + columns) state[i].slope[i - first] = 1;
        }
        system.derivative(t, state.data(), rate.data());
        for (int i = 0; i < n; ++i)
            for (int j = first; j < n && j < first + columns; ++j) J[i * n + j] = rate[i].slope[j - first];
    }
}

}  // namespace polhode
