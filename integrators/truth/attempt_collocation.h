// The attempt by collocation. Each working precision is instantiated in its own file.
#pragma once

#include <algorithm>
#include <cmath>

#include "integrators/truth/attempt_taylor.h"
#include "integrators/truth/collocation.h"

namespace polhode::truth {

template <unsigned working>
Attempt attempt_by_collocation(const Problem& problem, const std::vector<double>& sample_times, double local_digits) {
    using P = Real<working>;
    constexpr long max_steps = 100'000;
    const int stages = std::clamp(static_cast<int>(std::ceil(0.6 * local_digits)), 16, 40);
    const CollocationSettings coarse{stages, local_digits, max_steps};
    const CollocationSettings fine{stages + 4, local_digits + 2, max_steps};
    const Scene& scene = problem.scene;
    const Vector3<double>& moments = problem.body.principal.moments;
    auto second =
        in_thread([&] { return collocation<P, MomentumForm>(scene, sample_times, problem.scales, moments, coarse); });
    const Run<P> first = collocation<P, EulerForm>(scene, sample_times, problem.scales, moments, fine);
    const Run<P> other = second.get();
    return compare_runs(
        problem, sample_times, first, other,
        fmt::format("Radau IIA collocation in {} digits: {} by {} stages in {} steps, {} by {} stages in "
                    "{} steps",
                    working, EulerForm<P>::name, fine.stages, first.steps, MomentumForm<P>::name, coarse.stages,
                    other.steps),
        static_cast<int>(working));
}

}  // namespace polhode::truth
