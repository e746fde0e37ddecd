// Step size control of extrapolation, shared by runs of one motion and of many.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "integrators/own/binary_parts.h"

namespace polhode {

/// log2 x to within 0.01 and 2^x to within 1 %, for normal numbers x >= 0. Same bits with every C library.
inline double rough_log2(double x) {
    const double m = mantissa_of(x);
    return exponent_of(x) + ((2 - m / 3) * m - 5.0 / 3);
}
inline double rough_exp2(double x) {
    const int whole = static_cast<int>(x + 64) - 64;  // |x| < 64
    const double r = x - whole;
    return power_of_two(whole) * (1 + r * (2 + r) / 3);
}

/// Initial row of the extrapolation table, with at most `most` columns.
inline int initial_row(double tolerance, int most) {
    return std::clamp(static_cast<int>(std::lround(2.5 - std::log10(tolerance) / 2)), 3, most);
}

/// The step rule, the same for one motion and for lanes: safety factor, limits of log2 (H_new / H) without it, and log2
/// of the usual aim.
inline constexpr double step_safety = 0.94, least_log2_factor = -3, largest_log2_factor = 1.5, usual_log2_aim = -2.32;

/// H_new / H for an error of order 2K - 1: step_safety (aim / error)^(1/(2K - 1)), limited.
inline double step_factor(double log2_of_aim, double squared_error, int K) {
    const double exponent = (log2_of_aim - rough_log2(squared_error) / 2) / (2 * K - 1);
    return step_safety * rough_exp2(std::clamp(exponent, least_log2_factor, largest_log2_factor));
}

/// Rounds H down to few binary digits and a multiple of all n_j, so that every H/n_j and the sum of the steps are
/// exact. A rounded H/n_j would be a time error, the same in every step and amplified by the extrapolation.
inline double step_on_grid(double H, int odd_multiple) {
    if (H < 1e-200) return H;
    const double grid = odd_multiple * power_of_two(exponent_of(H) - 30);
    return static_cast<double>(static_cast<long>(H / grid)) * grid;
}

/// Selects the least of the last four suggested steps. A period of the motion takes only a few steps, and the error
/// at a given H varies a hundredfold along it. Measured: without this, a third of the steps were rejected, and the
/// worst accepted ones dominated the error.
class SuggestedSteps {
  public:
    void reset() { last_.fill(std::numeric_limits<double>::infinity()); }
    /// Returns the least of the last four suggestions, including this one.
    double least(double suggested) {
        last_ = {suggested, last_[0], last_[1], last_[2]};
        return std::min(std::min(suggested, last_[1]), std::min(last_[2], last_[3]));
    }

  private:
    std::array<double, 4> last_{};
};

}  // namespace polhode
