// The attempt by Taylor series. Each working precision is instantiated in its own file.
#pragma once

#include <cmath>
#include <future>
#include <system_error>

#include "integrators/truth/attempt.h"
#include "integrators/truth/compare.h"
#include "integrators/truth/euler_form.h"
#include "integrators/truth/momentum_form.h"
#include "integrators/truth/taylor.h"

namespace polhode::truth {

/// Runs f in a new thread, with the remaining time of this one and its interruption. Frees MPFR's cache of that thread.
/// If no thread can be created, f runs in the calling thread when the result is requested.
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

/// Step limit of one run.
inline constexpr long most_taylor_steps = 400'000;

template <unsigned working>
Attempt attempt_by_taylor(const Problem& problem, const std::vector<double>& sample_times, double local_digits) {
    using P = Real<working>;
    const TaylorRuns runs(local_digits, most_taylor_steps);
    const Scene& scene = problem.scene;
    const Vector3<double>& moments = problem.body.principal.moments;
    auto second = in_thread(
        [&] { return taylor<P, MomentumForm<P>>(scene, sample_times, problem.scales, moments, runs.coarse); });
    const Run<P> first = taylor<P, EulerForm<P>>(scene, sample_times, problem.scales, moments, runs.fine);
    const Run<P> other = second.get();
    return compare_runs(
        problem, sample_times, first, other,
        fmt::format("Taylor series in {} digits: {} at order {} in {} steps, {} at order {} in {} steps", working,
                    EulerForm<P>::name, runs.fine.order, first.steps, MomentumForm<P>::name, runs.coarse.order,
                    other.steps),
        static_cast<int>(working));
}

}  // namespace polhode::truth
