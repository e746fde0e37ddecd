// A step over or from a point at which a right-hand side has no Taylor series although the motion has one.
//
// The length |u| of a vector u(t) that passes zero, as in the force -c |v| v of a body that starts from rest or
// reverses on a line, is a square root with a double zero. Its series at that point does not exist in the arithmetic of
// series, and the series from an earlier point continues it with the wrong sign: find_root_zero() finds the time at
// which the argument of a square root vanishes. On each side the motion is analytic, so that collocation at points on
// one side converges: SingularStep solves the Radau IIA equations by Picard's iteration, without derivatives.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "body/elementary.h"
#include "body/golden_section.h"
#include "integrators/series/radau_nodes.h"

namespace polhode {

template <class P>
class SingularStep {
  public:
    explicit SingularStep(int stages) : table_(stages) {}

    /// Solves y' = f(y) from y over the longest of the times h, h/4, h/16, .. for which the last coefficients of the
    /// polynomial are at most 10^-digits of `scales` and `accepts(end)` holds. Returns this time, or nothing.
    template <class Derivative, class Accepts>
    std::optional<P> solve(const Derivative& derivative, const std::vector<P>& y, P h,
                           const std::vector<double>& scales, double digits, const Accepts& accepts) {
        constexpr int most_reductions = 60;
        n_ = y.size();
        for (int k = 0; k < most_reductions; ++k) {
            if (k > 0) h = h / P(4);
            if (!iterate(derivative, y, h, scales, digits)) continue;
            std::vector<P> end(n_);
            evaluate(P(1), end.data());
            if (accepts(end)) return h;
        }
        return std::nullopt;
    }
    /// The polynomial at the part `theta` of the step.
    void evaluate(const P& theta, P* y) const {
        const std::vector<P> basis = table_.basis(theta);
        for (std::size_t i = 0; i < n_; ++i) {
            y[i] = P(0);
            for (std::size_t j = 0; j < basis.size(); ++j) y[i] = y[i] + basis[j] * values_[j * n_ + i];
        }
    }

  private:
    RadauNodes<P> table_;
    std::size_t n_ = 0;
    std::vector<P> values_;  // at 0 and at the nodes

    static double size_of(const P& x, double scale) { return std::abs(static_cast<double>(x)) / scale; }

    template <class Derivative>
    bool iterate(const Derivative& derivative, const std::vector<P>& y, const P& h, const std::vector<double>& scales,
                 double digits) {
        const std::size_t s = static_cast<std::size_t>(table_.stages);
        const double allowed = std::pow(10.0, -digits);
        values_.clear();
        for (std::size_t j = 0; j <= s; ++j) values_.insert(values_.end(), y.begin(), y.end());
        std::vector<P> rates(s * n_, P(0));
        double last = std::numeric_limits<double>::infinity();
        for (int iteration = 0; iteration < 100; ++iteration) {
            for (std::size_t j = 0; j < s; ++j) derivative(&values_[(j + 1) * n_], &rates[j * n_]);
            // all nodes start from y, where a rate may be undefined: the others move the nodes away from it
            if (iteration == 0)
                for (P& rate : rates)
                    if (!std::isfinite(static_cast<double>(rate))) rate = P(0);
            double change = 0;
            for (std::size_t i = 0; i < s; ++i)
                for (std::size_t k = 0; k < n_; ++k) {
                    P sum(0);
                    for (std::size_t j = 0; j < s; ++j) sum = sum + table_.a[i * s + j] * rates[j * n_ + k];
                    P& value = values_[(i + 1) * n_ + k];
                    const P next = y[k] + h * sum;
                    const double moved = size_of(P(next - value), scales[k]);
                    change = moved <= change ? change : moved;
                    value = next;
                }
            if (!std::isfinite(change)) return false;
            if (change <= allowed) return has_small_tail(scales, allowed);
            if (iteration > 2 && change > last / 4) return false;
            last = change;
        }
        return false;
    }
    bool has_small_tail(const std::vector<double>& scales, double allowed) const {
        for (const std::vector<P>* row : {&table_.last, &table_.last_but_one})
            for (std::size_t k = 0; k < n_; ++k) {
                P sum(0);
                for (std::size_t j = 0; j < row->size(); ++j) sum = sum + (*row)[j] * values_[j * n_ + k];
                if (!(size_of(sum, scales[k]) <= 10 * allowed)) return false;
            }
        return true;
    }
};

/// Refines the double zero of a function near `time` in (0, h]: its square root is linear there up to its sign, so each
/// value gives two candidates.
template <class P, class Function>
P refine_root_zero(const Function& f, P time, const P& h) {
    const P distance = h / P(1024);
    const P before = square_root(f(P(time - distance))), after = square_root(f(P(time + distance)));
    const P slope = (before + after) / (P(2) * distance);
    if (!(slope > P(0))) return time;
    P least = f(time);
    for (int i = 0; i < 40 && least > P(0); ++i) {
        const P change = square_root(least) / slope, left = f(P(time - change)), right = f(P(time + change));
        if (!(std::min(left, right) < least)) break;
        time = left < right ? P(time - change) : P(time + change), least = std::min(left, right);
    }
    return time > h ? h : time;
}

/// Finds the first time in (0, h] at which one of the arguments of square roots has a double zero. `at(time)` returns
/// the arguments, which are not negative; `smallness`: a value relative to the largest that counts as zero.
template <class P, class At>
std::optional<P> find_root_zero(const At& at, const P& h, double smallness) {
    constexpr int parts = 32, golden_steps = 140;
    std::vector<std::vector<P>> values;
    for (int i = 0; i <= parts; ++i) values.push_back(at(P(h * P(i) / P(parts))));
    std::optional<P> first;
    for (std::size_t j = 0; j < values[0].size(); ++j) {
        P largest(0);
        for (const auto& one : values) largest = std::max(largest, one[j]);
        for (int i = 1; i <= parts; ++i) {
            const auto value = [&](int k) -> const P& { return values[static_cast<std::size_t>(k)][j]; };
            if (value(i) > value(i - 1) || (i < parts && value(i) > value(i + 1))) continue;
            const auto function = [&](const P& time) { return at(time)[j]; };
            const auto least = golden_section(function, P(h * P(i - 1) / P(parts)),
                                              P(h * P(std::min(i + 1, parts)) / P(parts)), golden_steps);
            if (!(least.value <= P(smallness) * largest)) break;
            const P zero = refine_root_zero(function, least.x, h);
            if (!first || zero < *first) first = zero;
            break;
        }
    }
    return first;
}

}  // namespace polhode
