// The attempt by Taylor series, to be instantiated for each working precision in a file of its own.
#pragma once

#include <cmath>
#include <future>
#include <system_error>

#include "integrators/truth/attempt.h"
#include "integrators/truth/compare.h"
#include "integrators/truth/impacts.h"
#include "integrators/truth/taylor.h"

namespace polhode::truth {

/// Runs f in a thread of its own, with as much time as is left and interrupted with this one; the caches that mpfr
/// keeps for it go with it. Where the system gives no thread, in the caller's, when the result is asked for.
template <class F>
auto in_thread(F f) {
    const auto work = [f, seconds = Allowance::left(), interruption = Interruption::current()] {
        const Interruption inherited(interruption);
        const Allowance allowance(seconds);
        auto result = f();
        mpfr_free_cache();
        return result;
    };
    try {
        return std::async(std::launch::async, work);
    } catch (const std::system_error&) {
        return std::async(std::launch::deferred, work);
    }
}

/// Of one run.
inline constexpr long most_taylor_steps = 400'000;

template <unsigned working>
Attempt attempt_by_taylor(const Problem& problem, const std::vector<double>& sample_times, double local_digits) {
    using P = Real<working>;
    const TaylorRuns runs(local_digits, most_taylor_steps);
    const Scene& scene = problem.scene;
    const Vector3<double>& moments = problem.body.principal.moments;
    auto second = in_thread([&] {
        return taylor<P, MomentumFormWithPlanes<P>>(scene, sample_times, problem.scales, moments, runs.coarse);
    });
    const Run<P> first = taylor<P, EulerFormWithPlanes<P>>(scene, sample_times, problem.scales, moments, runs.fine);
    const Run<P> other = second.get();
    return compared(problem, sample_times, first, other,
                    fmt::format("Taylor series in {} digits: {} at order {} in {} steps, {} at order {} in {} steps",
                                working, EulerForm<P>::name, runs.fine.order, first.steps, MomentumForm<P>::name,
                                runs.coarse.order, other.steps),
                    static_cast<int>(working));
}

}  // namespace polhode::truth
