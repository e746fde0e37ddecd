// The paths along which slips start from zero. In polar coordinates, u = slip d(angle),
//   d slip/dt = A,   slip d angle/dt = B,
// with the accelerations A and B of the contact point along and across d. At the start B = 0, and slip grows as t or,
// where the friction cone is reached while rolling, as t^2. The equation for the angle is then singular, and order by
// order its series follows from B_k = (slip angle')_k, in which the highest coefficients of the angles appear linearly.
// For a slip that grows as t^2 the series is asymptotic; the size of its last terms sets the step as for a convergent
// one.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "integrators/contact/contact_state.h"
#include "integrators/contact/small_system.h"
#include "integrators/series/limb_real.h"
#include "integrators/series/real.h"

namespace polhode::contact {

/// A motion from zero whose path is searched.
template <class P>
struct SlipStart {
    SlipPath<P>* path = nullptr;
    int across = 0, along = 0;  ///< indices of the integrals of B and A
    std::size_t zeros = 0;      ///< order of the zero of the slip at the start: 1 or 2
};

/// Sizes for the search.
struct SlipStartSettings {
    int order = 0;
    double acceleration = 0;        ///< size of accelerations
    double error = 0;               ///< relative error
    double zero = 0;                ///< relative size of an acceleration that is zero
    bool must_be_straight = false;  ///< whether a path that is not a straight line is a fault
};

/// Why the paths were not found.
enum class SlipStartFault { none, does_not_grow, is_curved };

/// Finds the series of the angles of the paths. `expand(order)`: the series of the motion with the present paths.
/// `step_of(series)`: the step at which it converges.
template <class P, class Expand, class StepOf>
SlipStartFault find_slip_paths(std::vector<SlipStart<P>>& starts, const SlipStartSettings& settings,
                               const Expand& expand, const StepOf& step_of) {
    const std::size_t m = starts.size();
    const auto across = [](const auto& series, const SlipStart<P>& start, int k) {
        return P(P(k + 1) * static_cast<P>(series.coefficient(start.across, k + 1)));
    };
    // slip_j = A_{j-1} / j; the slip at the start of the series is zero
    const auto slip = [](const auto& series, const SlipStart<P>& start, int j) {
        return static_cast<P>(series.coefficient(start.along, j));
    };
    for (SlipStart<P>& start : starts) start.path->angle.clear();
    const auto straight = expand(settings.order);
    const double free = step_of(straight);
    std::vector<P> first(m);
    bool is_straight = true;
    for (std::size_t i = 0; i < m; ++i) {
        first[i] = slip(straight, starts[i], 1);
        if (Elementary<P>::magnitude(first[i]) <= P(settings.zero * settings.acceleration)) first[i] = P(0);
        starts[i].zeros = first[i] > P(0) ? 1 : 2;
        if (starts[i].zeros == 2 && !(slip(straight, starts[i], 2) > P(0))) return SlipStartFault::does_not_grow;
        for (int k = 1; k < settings.order; ++k)
            if (static_cast<double>(Elementary<P>::magnitude(across(straight, starts[i], k))) * std::pow(free, k) >
                settings.error * settings.acceleration)
                is_straight = false;
    }
    if (is_straight) return SlipStartFault::none;
    if (settings.must_be_straight) return SlipStartFault::is_curved;
    // how the accelerations across change with the angles
    std::vector<P> slopes(m * m);
    for (std::size_t j = 0; j < m; ++j) {
        starts[j].path->angle = {P(1)};
        const auto turned = expand(2);
        starts[j].path->angle.clear();
        for (std::size_t i = 0; i < m; ++i)
            slopes[i * m + j] = across(turned, starts[i], 1) - across(straight, starts[i], 1);
    }
    // (slip angle')_k = sum over j of slip_j (k + 1 - j) angle_{k + 1 - j}
    for (int k = 1; k < settings.order - 1; ++k) {
        const auto series = expand(k + 1);
        std::vector<P> matrix = slopes, next;
        for (std::size_t i = 0; i < m; ++i) {
            P sum(0);
            for (int j = 2; j <= k; ++j)
                sum = sum + slip(series, starts[i], j) * P(k + 1 - j) *
                                starts[i].path->angle[static_cast<std::size_t>(k - j)];
            next.push_back(sum - across(series, starts[i], k));
            matrix[i * m + i] = matrix[i * m + i] - P(k) * first[i];
        }
        if (!solve_pivoted(matrix, next)) return SlipStartFault::does_not_grow;
        for (std::size_t i = 0; i < m; ++i) starts[i].path->angle.push_back(next[i]);
    }
    return SlipStartFault::none;
}

/// The step at which the angle's last terms are below 10^-digits.
template <class P>
double path_step(const SlipPath<P>& path, double digits) {
    double longest = std::numeric_limits<double>::infinity();
    for (std::size_t k = path.angle.size() > 4 ? path.angle.size() - 4 : 0; k < path.angle.size(); ++k)
        longest = std::min(longest, std::exp2((-digits * std::log2(10.0) - log2_magnitude(path.angle[k])) /
                                              static_cast<double>(k + 1)));
    return longest;
}

}  // namespace polhode::contact
