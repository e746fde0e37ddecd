// Taylor coefficients of a mode, by the scalar.
#pragma once

#include <concepts>
#include <type_traits>
#include <vector>

#include "integrators/series/series.h"
#include "integrators/tape/tape_series.h"

namespace polhode::contact {

/// Taylor coefficients in binary64 by a compiled tape (tape/tape_series.h), with the interface of Series that the
/// drivers use. Preparing it takes about as long as ten expansions by Series<double>, each expansion a tenth, so it
/// pays for modes whose equations return or whose steps are many.
class BinarySeries {
  public:
    BinarySeries(const Recording<double>& recording, int order)
        : tape_(recording, {.careful = true, .order = order}), sums_(padded(tape_.dimension())) {}

    int order() const { return tape_.order(); }
    /// Expands the solution that starts at y.
    void expand(const double* y) { tape_.expand(y); }
    /// The k-th coefficient of state variable i.
    double coefficient(int i, int k) const { return tape_.coefficient(i, k); }
    /// y(t + h).
    void evaluate(double h, double* y) const {
        tape_.sum(0, h, sums_.data());
        for (int i = 0; i < tape_.dimension(); ++i) y[i] = sums_[static_cast<std::size_t>(i)];
    }

  private:
    TapeSeries tape_;
    mutable std::vector<double, LineAllocator<double>> sums_;  // work memory

    static std::size_t padded(int n) { return static_cast<std::size_t>(TapeLayout::whole(n)); }
};

/// The series of a mode's equations: compiled in binary64, interpreted in multiprecision.
template <class T>
using ModeSeries = std::conditional_t<std::same_as<T, double>, BinarySeries, Series<T>>;

}  // namespace polhode::contact
