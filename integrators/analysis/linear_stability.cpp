#include "integrators/analysis/linear_stability.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace polhode {
namespace {

constexpr double excess = 1e-12;  ///< margin above 1 that exceeds rounding errors

/// The largest r with growth <= 1 on [0, r].
template <class Growth>
double find_stable_length(const Growth& growth) {
    constexpr double first = 1e-3, fine = 100, last = 1e8;
    if (growth(first) > 1 + excess) return 0;
    double low = first, high = 0;
    bool has_decayed = false;  // growth fell below 1 by more than rounding
    for (double r = first; r <= last;) {
        r += r < fine ? 1e-3 : 0.01 * r;
        const double g = growth(r);
        if (g > 1 + excess) {
            high = r;
            break;
        }
        has_decayed = has_decayed || g < 1 - excess;
        low = r;
    }
    if (high == 0) return std::numeric_limits<double>::infinity();
    while (high - low > 1e-9 * high) {
        const double middle = (low + high) / 2;
        (growth(middle) > 1 + excess ? high : low) = middle;
    }
    // an excess proportional to r^n, n > 1, is present from the start but hidden by rounding at first
    if (!has_decayed && growth(0.8 * low) > 1 + 0.01 * excess) return 0;
    return low;
}

}  // namespace

std::optional<double> linear_amplification(const Method& method, std::complex<double> z) {
    if (method.amplification) return method.amplification(z);
    if (!method.pendulum_amplification) return std::nullopt;
    if (z.imag() == 0) return method.pendulum_amplification(-z.real(), 0);
    return method.pendulum_amplification(-2 * z.real(), std::norm(z));
}

std::optional<double> stable_length(const Method& method, double angle) {
    if (!method.amplification && !method.pendulum_amplification) return std::nullopt;
    // the axes exactly, without rounding of the direction
    const double pi = std::numbers::pi;
    const std::complex<double> direction = angle == pi       ? std::complex<double>(-1, 0)
                                           : angle == pi / 2 ? std::complex<double>(0, 1)
                                                             : std::polar(1.0, angle);
    return find_stable_length([&](double r) { return *linear_amplification(method, r * direction); });
}

std::optional<double> real_interval(const Method& method) { return stable_length(method, std::numbers::pi); }

std::optional<double> imaginary_interval(const Method& method) { return stable_length(method, std::numbers::pi / 2); }

}  // namespace polhode
