// Forward automatic differentiation: a value with its derivatives in N directions. Evaluating the right-hand side on
// dual numbers gives its Jacobian, so that loads need no hand-written derivatives.
#pragma once

#include <array>
#include <concepts>
#include <vector>

#include "body/elementary.h"

namespace polhode {

/// S: the scalar of value and derivatives. P: the scalar of parameters, which have no derivative.
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
    /// Called by square_root().
    friend Dual sqrt(const Dual& a) {
        Dual c;
        c.value = square_root(a.value);
        const S twice = c.value + c.value;
        for (int i = 0; i < N; ++i) c.slope[i] = a.slope[i] / twice;
        return c;
    }
};

/// @cond specialisations
/// Called by sine_cosine().
template <int N, class S, class P>
struct Elementary<Dual<N, S, P>> {
    static void sine_cosine(const Dual<N, S, P>& x, Dual<N, S, P>& sine, Dual<N, S, P>& cosine) {
        const Dual<N, S, P> angle = x;  // copied, since x may alias a result
        polhode::sine_cosine(angle.value, sine.value, cosine.value);
        for (int i = 0; i < N; ++i) {
            sine.slope[i] = cosine.value * angle.slope[i];
            cosine.slope[i] = -(sine.value * angle.slope[i]);
        }
    }
};
/// @endcond

/// Number of Jacobian columns per evaluation for systems whose size is known only at run time.
inline constexpr int jacobian_directions = 8;

/// Row-major Jacobian J[i * N + j] = d f_i / d y_j of a system of dimension N. User torques are not differentiated.
template <class SystemType>
requires(SystemType::dimension > 0) void jacobian(const SystemType& system, double t, const double* y, double* J) {
    constexpr int N = SystemType::dimension;
    std::array<Dual<N>, N> state, rate;
    for (int i = 0; i < N; ++i) state[i] = Dual<N>(y[i]), state[i].slope[i] = 1;
    system.derivative(t, state.data(), rate.data());
    for (int i = 0; i < N; ++i)
        for (int j = 0; j < N; ++j) J[i * N + j] = rate[i].slope[j];
}

/// Row-major Jacobian of a system with n = system.size() components; each evaluation computes `columns` columns.
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
