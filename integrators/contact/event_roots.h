// First time at which an event function, given by its Taylor coefficients, falls to zero.
//
// Near the start of a mode some event functions vanish up to rounding: the gap after an impact (simple zero), after the
// start of a flight from contact (double) and after a lift-off (triple zero). The order of this zero is known from the
// event, so the coefficients below it are ignored and the root of the quotient is searched. Interval bounds of the
// quotient and its derivative in binary64 isolate the root; Newton's iteration, safeguarded by bisection, locates it in
// full precision.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "body/elementary.h"

namespace polhode::contact {

/// Improves the coefficients of an event function that was interpolated at points of a step of length h. The low ones
/// are replaced by `exact`. Of the others, terms that do not exceed 1e-13 `size` are rounding errors and become zero.
template <class P>
void refine_coefficients(std::vector<P>& coefficients, const std::vector<P>& exact, const P& h, double size) {
    P power(1);
    for (std::size_t k = 0; k < coefficients.size(); ++k) {
        if (k < exact.size())
            coefficients[k] = exact[k];
        else if (!(Elementary<P>::magnitude(P(coefficients[k] * power)) > P(1e-13 * size)))
            coefficients[k] = P(0);
        power = power * h;
    }
}

/// Finds the first root of a polynomial on an interval (0, h].
template <class P>
class FirstRoot {
  public:
    /// `coefficients` of powers of s from the power 0 on; the first `zeros` of them are ignored. A function whose terms
    /// on the interval do not exceed `noise` has no root.
    FirstRoot(const std::vector<P>& coefficients, std::size_t zeros, const P& h, double noise) : h_(h) {
        P power(1), largest(0);
        for (std::size_t k = 0; k < zeros; ++k) power = power * h;
        for (std::size_t k = zeros; k < coefficients.size(); ++k) {
            exact_.push_back(coefficients[k] * power);
            largest = std::max(largest, Elementary<P>::magnitude(exact_.back()));
            power = power * h;
        }
        if (!(largest > P(noise))) {
            exact_.clear();
            return;
        }
        for (P& c : exact_) {
            c = c / largest;
            const double rounded = static_cast<double>(c);
            scaled_.push_back(rounded);
        }
        while (!scaled_.empty() && scaled_.back() == 0) scaled_.pop_back();
    }

    /// The first s in (0, h] at which the function falls to zero.
    std::optional<P> find() const {
        if (exact_.empty()) return {};
        long intervals = 0;
        return search(0, 1, 0, intervals);
    }

  private:
    static constexpr int most_halvings = 44, most_iterations = 300;
    // if a function is zero up to rounding, more intervals show nothing, and its signs at their ends decide
    static constexpr long most_intervals = 20'000;

    P h_;
    std::vector<P> exact_;        // of powers of x = s / h
    std::vector<double> scaled_;  // the same, rounded

    double value(double x) const {
        double sum = 0;
        for (std::size_t k = scaled_.size(); k-- > 0;) sum = sum * x + scaled_[k];
        return sum;
    }
    double slope(double x) const {
        double sum = 0;
        for (std::size_t k = scaled_.size(); k-- > 1;) sum = sum * x + static_cast<double>(k) * scaled_[k];
        return sum;
    }
    // bounds of |f'| and |f''| on [0, x]
    double slope_bound(double x) const {
        double sum = 0;
        for (std::size_t k = scaled_.size(); k-- > 1;) sum = sum * x + static_cast<double>(k) * std::abs(scaled_[k]);
        return sum;
    }
    double curvature_bound(double x) const {
        double sum = 0;
        for (std::size_t k = scaled_.size(); k-- > 2;)
            sum = sum * x + static_cast<double>(k * (k - 1)) * std::abs(scaled_[k]);
        return sum;
    }
    P exact_value(const P& x) const {
        P sum(0);
        for (std::size_t k = exact_.size(); k-- > 0;) sum = sum * x + exact_[k];
        return sum;
    }
    P exact_slope(const P& x) const {
        P sum(0);
        for (std::size_t k = exact_.size(); k-- > 1;) sum = sum * x + P(static_cast<int>(k)) * exact_[k];
        return sum;
    }

    std::optional<P> search(double low, double high, int depth, long& intervals) const {
        if (++intervals > most_intervals) depth = most_halvings;
        constexpr double rounding = 1e-13;
        const double middle = (low + high) / 2, half = (high - low) / 2;
        const double at = value(middle);
        if (std::abs(at) > slope_bound(high) * half + rounding)
            return at > 0 ? std::nullopt : std::optional(P(low) * h_);
        const double slope_at = slope(middle);
        if (std::abs(slope_at) > curvature_bound(high) * half + rounding || depth == most_halvings) {
            if (slope_at > 0 && depth < most_halvings) return {};
            const P a(low), b(high);
            if (exact_value(b) > P(0)) return {};
            if (!(exact_value(a) > P(0))) return a * h_;
            return locate(a, b) * h_;
        }
        if (std::optional<P> found = search(low, middle, depth + 1, intervals)) return found;
        return search(middle, high, depth + 1, intervals);
    }
    // the root between a, where the function is positive, and b, where it is not
    P locate(P a, P b) const {
        P x = (a + b) / P(2);
        for (int i = 0; i < most_iterations; ++i) {
            const P f = exact_value(x);
            (f > P(0) ? a : b) = x;
            P next = x - f / exact_slope(x);
            if (!(next >= a && next <= b)) next = (a + b) / P(2);
            const P change = Elementary<P>::magnitude(P(next - x));
            x = next;
            if (!(change > P(4) * Elementary<P>::epsilon() * b)) break;
        }
        return x;
    }
};

}  // namespace polhode::contact
