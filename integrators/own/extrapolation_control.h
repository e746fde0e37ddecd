// What the errors of an extrapolated step say of the next one: shared by runs of one motion and of many.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "integrators/own/binary_parts.h"

namespace polhode {

/// log2 x within 0.01 and 2^x within 1 %, of normal numbers x >= 0: the same bits with every library.
inline double rough_log2(double x) {
    const double m = mantissa_of(x);
    return exponent_of(x) + ((2 - m / 3) * m - 5.0 / 3);
}
inline double rough_exp2(double x) {
    const int whole = static_cast<int>(x + 64) - 64;  // |x| < 64
    const double r = x - whole;
    return power_of_two(whole) * (1 + r * (2 + r) / 3);
}

/// The row of the extrapolation table to begin with, of `most` columns at the most.
inline int first_row(double tolerance, int most) {
    return std::clamp(static_cast<int>(std::lround(2.5 - std::log10(tolerance) / 2)), 3, most);
}

/// H_new / H for an error of order 2K - 1: 0.94 (aim / error)^(1/(2K - 1)).
inline double step_factor(double log2_of_aim, double squared_error, int K) {
    const double exponent = (log2_of_aim - rough_log2(squared_error) / 2) / (2 * K - 1);
    return 0.94 * rough_exp2(std::clamp(exponent, -3.0, 1.5));
}

/// H cut to few binary digits and a multiple of all n_j: every H/n_j, and the sum of the steps, is then exact. A
/// rounded H/n_j would be an error of the time itself, the same in every step and amplified.
inline double step_on_grid(double H, int odd_multiple) {
    if (H < 1e-200) return H;
    const double grid = odd_multiple * power_of_two(exponent_of(H) - 30);
    return static_cast<double>(static_cast<long>(H / grid)) * grid;
}

/// The motion's own period is a few steps, and the error of a given H differs a hundredfold along it. So H follows the
/// least of the last four steps' suggestions: measured, a third of the steps were else rejected, and the worst accepted
/// ones made the error.
class SuggestedSteps {
  public:
    void forget() { last_.fill(std::numeric_limits<double>::infinity()); }
    /// The least of the last four, this one included.
    double least(double suggested) {
        last_ = {suggested, last_[0], last_[1], last_[2]};
        return std::min(std::min(suggested, last_[1]), std::min(last_[2], last_[3]));
    }

  private:
    std::array<double, 4> last_{};
};

}  // namespace polhode
