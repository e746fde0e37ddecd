// Random bodies and starts for the closed forms, and an independent solution of their equations by Taylor series.
#pragma once

#include <rapidcheck.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "integrators/closed_form/free_body.h"
#include "integrators/series/series.h"
#include "motion/moderate_scene.h"
#include "motion/systems.h"

namespace polhode::testing {

inline constexpr double ulp = 0x1p-52;

struct FreeMotion {
    Vector3<double> moments, w;
    Quaternion<double> q;
    double t;
};

/// 10^-k with k uniform in [0, most].
inline double small(int most) { return std::pow(10, -moderate(0, most)); }

/// One third have nearly equal moments, one third start next to the separatrix, and some have a component near zero.
inline FreeMotion any_free_motion() {
    FreeMotion m;
    for (int i = 0; i < 3; ++i) m.moments[i] = moderate(0.5, 2.5), m.w[i] = moderate(-2, 2);
    const int odd = *rc::gen::inRange(0, 3);
    if (*rc::gen::inRange(0, 3) == 0) m.moments[odd] = m.moments[(odd + 1) % 3] * (1 + small(14));
    std::array<int, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int a, int b) { return m.moments[a] < m.moments[b]; });
    const auto [a, b, c] = order;
    const double Ia = m.moments[a], Ib = m.moments[b], Ic = m.moments[c];
    if (Ia == Ib || Ib == Ic) m.moments[b] = Ia + (Ic - Ia) / 3 + 0.1;
    if (*rc::gen::inRange(0, 3) == 0) {
        // Ic (Ic - Ib) wc^2 = Ia (Ib - Ia) wa^2 up to a small relative difference
        const double ratio = std::sqrt(std::abs(Ia * (m.moments[b] - Ia) / (Ic * (Ic - m.moments[b]))));
        m.w[c] = ratio * m.w[a] * (1 + moderate(-1, 1) * small(10));
    }
    if (*rc::gen::inRange(0, 5) == 0) m.w[odd] *= small(14);
    if (m.w[0] == 0 || m.w[1] == 0) m.w[0] = 0.3, m.w[1] = -0.4;
    m.q = moderate_orientation();
    m.t = moderate(-1, 1) * std::min(std::pow(10, moderate(-1, 1)), 20 / std::sqrt(dot(m.w, m.w)));
    return m;
}

/// The free body's equations in a recordable form.
struct FreeEquations {
    Vector3<double> moments;

    template <class S>
    void derivative(const S* y, S* dy) const {
        PrincipalInertia<double> inertia;
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            inertia.gyroscopic[i] = (moments[j] - moments[k]) / moments[i];
        }
        FreeRotation::Equations{inertia}.derivative(0, y, dy);
    }
};

/// State (w, q) after the time t by Taylor series of order 24, with steps that keep the remainder below round-off
/// (Jorba & Zou 2005): exact up to round-off. Returns the number of steps in `steps`.
template <class Equations>
std::array<double, 7> by_taylor(const Equations& equations, const FreeMotion& m, int& steps) {
    constexpr int order = 24;
    Series<double> series(record<double>(equations, 7), order);
    std::array<double, 7> y{m.w[0], m.w[1], m.w[2], m.q.w, m.q.x, m.q.y, m.q.z};
    double left = std::abs(m.t);
    for (steps = 0; left > 0; ++steps) {
        series.expand(y.data());
        double last = 0, rate = 0;
        for (int i = 0; i < 3; ++i) rate = std::max(rate, std::abs(y[static_cast<std::size_t>(i)]));
        for (int i = 0; i < 7; ++i)
            for (const int k : {order - 1, order}) {
                const double term = std::abs(series.coefficient(i, k)) / (i < 3 ? std::max(rate, 1e-3) : 1);
                last = std::max(last, std::pow(term / 1e-17, 1.0 / k));
            }
        const double h = std::min(left, 0.9 / last);
        left = h == left ? 0 : left - h;
        series.evaluate(m.t < 0 ? -h : h, y.data());
    }
    return y;
}

inline double size(const Vector3<double>& v) { return std::sqrt(dot(v, v)); }
inline double distance(const Quaternion<double>& a, const Quaternion<double>& b) {
    return std::sqrt(squared_norm(Quaternion<double>{a.w - b.w, a.x - b.x, a.y - b.y, a.z - b.z}));
}

/// The largest change at the end of `at` when the start changes by `roundoff` relative to its size, over 6 directions.
template <class At>
double amplified(const At& at, const FreeMotion& m, double roundoff) {
    const double step = 1e-7, rate = size(m.w);
    const Rotation<double> end = at(m);
    double worst = 1;
    for (int i = 0; i < 6; ++i) {
        FreeMotion changed = m;
        Vector3<double> turn;
        if (i < 3)
            changed.w[i] += step * rate;
        else
            turn[i - 3] = step / 2, changed.q = normalized(m.q * Quaternion<double>{1, turn[0], turn[1], turn[2]});
        const Rotation<double> other = at(changed);
        worst = std::max(worst, 2 * distance(other.q, end.q) / step);
        worst = std::max(worst, size(other.w - end.w) / rate / step);
    }
    return worst * roundoff;
}

}  // namespace polhode::testing
