// Growth of an error over a long run.
#pragma once

#include <limits>
#include <optional>
#include <vector>

namespace polhode {

/// A fitted power law of an error.
struct Growth {
    double exponent;     ///< p of error ~ t^p: least-squares slope of log(envelope) over log(t)
    double uncertainty;  ///< half the difference between the exponents of the first and the second half in log(t)
    double from, to;     ///< the fitted range of t, s
};

/// M(t) = max over t' <= t of |error(t')| at times spaced evenly in log(t), 20 per decade. Zeros are omitted.
struct Envelope {
    std::vector<double> t, error;
};
/// The envelope of |error| at times t >= `from` (s).
Envelope error_envelope(const std::vector<double>& t, const std::vector<double>& error, double from = 0);

/// Fits the growth of the envelope over the last two decades before M reaches `saturation` (about 1 rad for an
/// attitude). Random round-off gives 1/2 for energy and 3/2 for attitude (Brouwer 1937, Astron. J. 46, 149). Biased
/// round-off or a truncation error that accumulates gives 1 and 2; a bounded error gives 0. Returns nothing if less
/// than one decade of positive errors is left. `t` is ascending and as long as `error`.
std::optional<Growth> error_growth(const std::vector<double>& t, const std::vector<double>& error,
                                   double saturation = std::numeric_limits<double>::infinity());

}  // namespace polhode
