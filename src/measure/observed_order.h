// The observed order of a convergence run.
#pragma once

#include <limits>
#include <optional>
#include <vector>

namespace polhode {

/// A fitted order of convergence.
struct ObservedOrder {
    double order;     ///< least-squares slope of log(error) over log(step)
    int points;       ///< number of fitted points of the asymptotic range
    double from, to;  ///< the fitted range of steps, s
};

/// Fits the order over the asymptotic range: the longest run of at least three neighbouring points whose local slopes
/// agree within 3 % (or 0.03). This excludes saturated and round-off points. A run that converges (slope above 0.5)
/// takes precedence over one that does not. If no slopes agree, the three points with the smallest spread are fitted.
/// Returns nothing for fewer than three usable points (positive, finite). The steps need not be sorted. Points with
/// an error above `saturation` (about 1 rad for an attitude, which cannot exceed pi) and those of longer steps are
/// excluded. If no error is below a tenth of `saturation`, nothing has converged and there is no order.
std::optional<ObservedOrder> observed_order(const std::vector<double>& step, const std::vector<double>& error,
                                            double saturation = std::numeric_limits<double>::infinity());

}  // namespace polhode
