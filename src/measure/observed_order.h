// The order that a convergence run shows.
#pragma once

#include <limits>
#include <optional>
#include <vector>

namespace polhode {

struct ObservedOrder {
    double order;     ///< slope of log(error) over log(step), least squares
    int points;       ///< how many points of the asymptotic range it was fitted to
    double from, to;  ///< the range of steps, s
};

/// Fits the order over the asymptotic range: the longest run of at least three neighbouring points whose local slopes
/// agree within 3 % (or 0.03), so that saturated and round-off points are left out; a run that converges (slope above
/// 0.5) goes before one that does not. Where no slopes agree, the steadiest three points. Empty for fewer than three
/// usable points (positive, finite); the steps need not be sorted. Points with an error above `saturation` (for an
/// attitude about 1 rad: it cannot exceed pi), and those of longer steps, are left out; where no error is below a tenth
/// of it, nothing has converged, and there is no order.
std::optional<ObservedOrder> observed_order(const std::vector<double>& step, const std::vector<double>& error,
                                            double saturation = std::numeric_limits<double>::infinity());

}  // namespace polhode
