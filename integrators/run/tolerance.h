// Functions shared by solvers that control their own step: unreachable tolerances and the first step.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "motion/trajectory.h"

namespace polhode {

/// False for a relative tolerance below the spacing of binary64, which no solver can reach.
inline bool is_reachable(double tolerance) { return tolerance >= std::numeric_limits<double>::epsilon(); }
/// The result for an unreachable tolerance: Status::tolerance_not_met.
inline Trajectory unreachable_tolerance(double tolerance) {
    Trajectory trajectory;
    trajectory.status = Status::tolerance_not_met;
    trajectory.message = fmt::format("the tolerance {:g} is below the spacing of binary64, {:.3g}", tolerance,
                                     std::numeric_limits<double>::epsilon());
    return trajectory;
}

/// First step after Hairer, Norsett & Wanner (1993), II.4: an Euler step, and then the second derivative, change y by
/// 0.01 of the tolerated error to the power that the order gives. Calls rate(t, y, dy) twice, at t = 0 and a little
/// later, relative to the start. The result is NaN, infinite or 0 if the right-hand side is not finite.
template <class Values, class Rate>
double first_step(const Rate& rate, const Values& y, const Values& tolerated, int order) {
    const std::size_t N = y.size();
    // root mean square in units of the tolerated error
    const auto norm = [&](const Values& v) {
        double sum = 0;
        for (std::size_t i = 0; i < N; ++i) {
            const double ratio = v[i] / tolerated[i];
            sum += ratio * ratio;
        }
        return std::sqrt(sum / static_cast<double>(N));
    };
    Values f0 = y, f1 = y, z = y;
    rate(0.0, y, f0);
    const double d0 = norm(y), d1 = norm(f0);
    const double guess = d0 < 1e-5 || d1 < 1e-5 ? 1e-6 : 0.01 * d0 / d1;
    for (std::size_t i = 0; i < N; ++i) z[i] = y[i] + guess * f0[i];
    rate(guess, z, f1);
    for (std::size_t i = 0; i < N; ++i) f1[i] = f1[i] - f0[i];
    const double steepest = std::max(d1, norm(f1) / guess);
    const double h = steepest <= 1e-15 ? std::max(1e-6, guess * 1e-3) : std::pow(0.01 / steepest, 1.0 / (order + 1));
    return std::min(100 * guess, h);
}

/// The local error that a moderate-order method of polhode aims at for a relative tolerance R. Local errors accumulate
/// over hundreds of rotations; a tenth of R costs at most a quarter more steps.
inline double local_tolerance(double tolerance) {
    return std::max(0.1 * tolerance, std::numeric_limits<double>::epsilon());
}

}  // namespace polhode
