// The first time in a Taylor step at which a component of the state passes the threshold of a switch.
//
// The polynomial is scaled to s = t / h in [0, 1], rounded to binary64, and searched from the left. A bound on its
// slope excludes intervals without a root. Newton's method in the scalar of the reference refines the root.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "integrators/series/series.h"

namespace polhode::truth {

/// A formulation whose equations switch. switching_points() lists components with `component`, `threshold` and `sign`;
/// cross_switch(which, y) changes the equations at y and returns why the motion cannot be continued.
template <class Form, class P>
concept SupportsSwitches = requires(Form form, P* y) {
    form.switching_points();
    form.cross_switch(0, y);
};

/// Finds the first change of a polynomial from positive to negative in [0, 1].
class FirstDescent {
  public:
    /// Coefficients of s^0, s^1, ..
    explicit FirstDescent(std::vector<double> coefficients) : a_(std::move(coefficients)) {}

    /// An interval with the change, or nothing.
    std::optional<std::pair<double, double>> find() const { return search(0, 1, 0); }
    double value(double s) const {
        double sum = 0;
        for (std::size_t k = a_.size(); k-- > 0;) sum = sum * s + a_[k];
        return sum;
    }

  private:
    static constexpr int most_halvings = 34;
    std::vector<double> a_;

    double slope_bound(double s) const {
        double sum = 0;
        for (std::size_t k = a_.size(); k-- > 1;) sum = sum * s + static_cast<double>(k) * std::abs(a_[k]);
        return sum;
    }
    std::optional<std::pair<double, double>> search(double from, double to, int halvings) const {
        if (value(from) > slope_bound(to) * (to - from)) return std::nullopt;
        if (halvings == most_halvings) return value(to) < 0 ? std::optional(std::pair(from, to)) : std::nullopt;
        const double middle = (from + to) / 2;
        if (const auto left = search(from, middle, halvings + 1)) return left;
        return search(middle, to, halvings + 1);
    }
};

/// Finds when the component of a switch passes its threshold in a step of length h. `sign`: its side before. Returns
/// the time after the start of the step.
template <class P, class T>
std::optional<P> find_crossing(const Series<T>& series, int component, const P& threshold, int sign, const P& h) {
    const int order = series.order();
    std::vector<P> c;  // coefficients: the argument minus its threshold, times the sign, positive before the crossing
    P power(1), size(0);
    for (int k = 0; k <= order; ++k, power *= h) {
        c.push_back(P(sign) * P(series.coefficient(component, k)));
        if (k == 0) c[0] -= P(sign) * threshold;
        size += abs(P(c.back() * power));
    }
    if (size == 0) return std::nullopt;
    std::vector<double> scaled;
    power = P(1);
    for (const P& one : c) scaled.push_back(P(one * power / size).template convert_to<double>()), power *= h;
    // just after an event the value is round-off of either sign: divide by s, and find where the quotient changes
    const bool starts_at_threshold = std::abs(scaled[0]) < 1e-14;
    if (starts_at_threshold) scaled.erase(scaled.begin());
    const auto interval = FirstDescent(scaled).find();
    if (!interval) return std::nullopt;
    const auto value = [&](const P& t) {
        P sum(0);
        for (std::size_t k = c.size(); k-- > 0;) sum = sum * t + c[k];
        return sum;
    };
    const auto slope = [&](const P& t) {
        P sum(0);
        for (std::size_t k = c.size(); k-- > 1;) sum = sum * t + P(static_cast<double>(k)) * c[k];
        return sum;
    };
    P t = P(interval->second) * h;
    if (starts_at_threshold && interval->second < 1e-9) t = P(0);
    for (int i = 0; i < 12; ++i) {
        const P d = slope(t);
        if (d == 0) break;
        t -= value(t) / d;
    }
    return t < 0 ? P(0) : t > h ? h : t;
}

/// The first crossing in a step, and the index of its switch.
template <class P>
struct Crossing {
    std::size_t which;
    P after;  ///< from the start of the step
};
template <class P, class T, class Points>
std::optional<Crossing<P>> find_first_crossing(const Series<T>& series, const Points& points, const P& h) {
    std::optional<Crossing<P>> first;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points[i].sign == 0) continue;
        const auto after = find_crossing(series, points[i].component, points[i].threshold, points[i].sign, h);
        if (after && (!first || *after < first->after)) first = {i, *after};
    }
    return first;
}

/// Whether a component that should stay at the threshold of its switch leaves it in a step of length h.
template <class P, class T, class Points>
bool leaves_threshold(const Series<T>& series, const Points& points, const P& h) {
    for (const auto& point : points) {
        if (point.sign != 0) continue;
        P power = h;
        for (int k = 1; k <= series.order(); ++k, power *= h)
            if (abs(P(P(series.coefficient(point.component, k)) * power)) > P(1e-30)) return true;
    }
    return false;
}

}  // namespace polhode::truth
