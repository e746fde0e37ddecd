// The polynomial of one step through a mode, and the length of a Taylor step.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "body/algebra.h"
#include "integrators/contact/contact_state.h"
#include "integrators/contact/mode_steps.h"
#include "integrators/series/limb_real.h"
#include "integrators/series/real.h"
#include "integrators/series/series.h"

namespace polhode::contact {

/// The polynomial of a step over the independent variable s. Time is the component `clock`.
template <class P>
struct ModeStep {
    StepExpansion<P> expansion;
    int clock = 0;
    bool stretched = false;  ///< whether s is not the time
    P length{0};             ///< in s

    int order() const { return expansion.order(); }
    P coefficient(int i, int k) const { return expansion.coefficient(i, k); }
    /// The time at the end of the step.
    P clock_at_end() const {
        P value(0);
        for (int k = last_of_clock(); k >= 0; --k) value = value * length + coefficient(clock, k);
        return value;
    }
    /// s at which the clock is t, for a clock that increases.
    P when(const P& t, const P& start) const {
        if (!stretched) return t - start;
        std::vector<P> c;
        for (int k = 0; k <= last_of_clock(); ++k) c.push_back(coefficient(clock, k));
        P low(0), high = length, s = length / P(2);
        for (int i = 0; i < 300; ++i) {
            P value(0), slope(0);
            for (std::size_t k = c.size(); k-- > 0;) {
                slope = slope * s + value;
                value = value * s + c[k];
            }
            (value < t ? low : high) = s;
            P next = s - (value - t) / slope;
            if (!(next >= low && next <= high)) next = (low + high) / P(2);
            const P change = Elementary<P>::magnitude(P(next - s));
            s = next;
            if (!(change > P(4) * Elementary<P>::epsilon() * high)) break;
        }
        return s;
    }
    /// The value of an observed function, whose integral over s is the component `index`.
    P observed(int index, const P& s) const {
        P sum(0);
        for (int k = order(); k >= 1; --k) sum = sum * s + P(k) * coefficient(index, k);
        return sum;
    }
    /// The values of three observed functions from the index `first` on.
    Vector3<P> observed_vector(int first, const P& s) const {
        return {observed(first, s), observed(first + 1, s), observed(first + 2, s)};
    }

  private:
    int last_of_clock() const { return expansion.last_term(clock, length); }
};

/// The last values of a function of time that is expensive to evaluate.
template <class P, class Value>
class KnownTimes {
  public:
    /// The value at t: a known one or compute().
    template <class Compute>
    const Value& at(const P& t, const Compute& compute) {
        for (const auto& [time, value] : known_)
            if (time == t) return value;
        if (known_.size() < most) return known_.emplace_back(t, compute()).second;
        next_ = (next_ + 1) % most;
        known_[next_] = {t, compute()};
        return known_[next_].second;
    }

  private:
    static constexpr std::size_t most = 4;
    std::vector<std::pair<P, Value>> known_;
    std::size_t next_ = most - 1;
};

/// The length of a Taylor step for which |c_k| h^k <= 10^-digits scale for the last four coefficients of each block,
/// because one may vanish by symmetry.
template <class Expanded>
double taylor_step(const Expanded& series, int order, const std::vector<Block>& blocks, double digits) {
    double log2_step = std::numeric_limits<double>::infinity();
    for (const Block& block : blocks)
        for (int k = order - 3; k <= order; ++k) {
            double size = -std::numeric_limits<double>::infinity();
            for (int i = block.first; i < block.first + block.size; ++i)
                size = std::max(size, log2_magnitude(series.coefficient(i, k)));
            const double allowed = std::log2(block.scale) - digits * std::log2(10.0);
            log2_step = std::min(log2_step, (allowed - size) / k);
        }
    return std::exp2(std::min(log2_step, 1000.0));
}

/// The order of the Taylor series of the next step in multiprecision. Events may end steps much earlier than the series
/// allows, for example where impacts accumulate. A lower order is then accurate to rounding with fewer operations. Each
/// step selects the order for the next one.
template <class P>
class StepOrder {
  public:
    /// Compiled series in binary64 have a fixed order.
    static constexpr bool adapts = !std::same_as<P, double>;

    explicit StepOrder(int most) : most_(most), next_(most) {}
    int next() const { return next_; }
    /// A step has ended after `length` of the `allowed` length, at which a series of this order has errors of
    /// 10^-digits.
    void note(int order, double digits, double allowed, double length) {
        // a mode may end where it starts
        if (!adapts || !(length > 0)) return;
        // number of last coefficients that taylor_step() examines, and a margin for a longer step (a power of ten);
        // low orders do not show whether higher coefficients vanish
        constexpr double examined = 5, margin = 0.5, least = 12;
        const double shorter = std::log10(allowed / length) - margin;
        const double arithmetic = -std::log10(static_cast<double>(Elementary<P>::epsilon()));
        // c_k = R^-k, so allowed / R = 10^(-digits / order)
        const double wanted = std::max(least, std::ceil(arithmetic / (digits / order + shorter) + examined));
        next_ = shorter > 0 && wanted < most_ ? static_cast<int>(wanted) : most_;
    }

  private:
    int most_, next_;
};

}  // namespace polhode::contact
