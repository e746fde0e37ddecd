// How an error grows over a long run.
#pragma once

#include <limits>
#include <optional>
#include <vector>

namespace polhode {

struct Growth {
    double exponent;     ///< p of error ~ t^p: slope of log(envelope) over log(t), least squares
    double uncertainty;  ///< half the difference between the exponents of the first and the second half, in log(t)
    double from, to;     ///< the range of t it was fitted to, s
};

/// M(t) = max over t' <= t of |error(t')| at times spaced evenly in log(t), 20 a decade; zeros are left out.
struct Envelope {
    std::vector<double> t, error;
};
Envelope error_envelope(const std::vector<double>& t, const std::vector<double>& error, double from = 0);

/// Fits the growth of the envelope over the last two decades before M reaches `saturation` (an attitude is lost at
/// about 1 rad). Round-off that cancels at random gives 1/2 for energy and 3/2 for attitude (Brouwer 1937, Astron. J.
/// 46, 149); round-off with a bias, or a truncation error that adds up, 1 and 2; an error that stays bounded 0. Empty
/// where fewer than one decade of positive errors is left. `t` ascending, as long as `error`.
std::optional<Growth> error_growth(const std::vector<double>& t, const std::vector<double>& error,
                                   double saturation = std::numeric_limits<double>::infinity());

}  // namespace polhode
