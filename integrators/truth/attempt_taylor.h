// The attempt by Taylor series, to be instantiated for each working precision in a file of its own.
#pragma once

#include <cmath>
#include <future>

#include "integrators/truth/attempt.h"
#include "integrators/truth/compare.h"
#include "integrators/truth/impacts.h"
#include "integrators/truth/taylor.h"

namespace polhode::truth {

/// Runs f in a thread of its own, with as much time as is left; the caches that mpfr keeps for it go with it.
template <class F>
auto in_thread(F f) {
    return std::async(std::launch::async, [f, seconds = Allowance::left()] {
        const Allowance allowance(seconds);
        auto result = f();
        mpfr_free_cache();
        return result;
    });
}

template <unsigned working>
Attempt attempt_by_taylor(const Problem& problem, const std::vector<double>& sample_times, double local_digits) {
    using P = Real<working>;
    constexpr long max_steps = 400'000;
    // the work order^2 / step is least near order = ln(10) / 2 digits (Jorba & Zou 2005); the second run goes by a
    // higher order, a finer tolerance and a step shortened by an odd factor
    const TaylorSettings coarse{static_cast<int>(std::ceil(1.15 * local_digits)) + 2, local_digits, 1, max_steps};
    const TaylorSettings fine{static_cast<int>(std::ceil(1.3 * local_digits)) + 5, local_digits + 2, 0.93, max_steps};
    const Scene& scene = problem.scene;
    const Vector3<double>& moments = problem.body.principal.moments;
    auto second = in_thread(
        [&] { return taylor<P, MomentumFormWithPlanes<P>>(scene, sample_times, problem.scales, moments, coarse); });
    const Run<P> first = taylor<P, EulerFormWithPlanes<P>>(scene, sample_times, problem.scales, moments, fine);
    const Run<P> other = second.get();
    return compared(
        problem, sample_times, first, other,
        fmt::format("Taylor series in {} digits: {} at order {} in {} steps, {} at order {} in {} steps", working,
                    EulerForm<P>::name, fine.order, first.steps, MomentumForm<P>::name, coarse.order, other.steps),
        static_cast<int>(working));
}

}  // namespace polhode::truth
