// Taylor series of the two formulations of a mechanism with formula loads (formula_mechanism_form.h).
#pragma once

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "integrators/truth/formula_attempt.h"
#include "integrators/truth/formula_mechanism_form.h"
#include "motion/user_system.h"

namespace polhode::truth {

template <unsigned working>
Attempt attempt_by_formula_mechanism(const Problem& problem, const std::vector<double>& sample_times,
                                     double local_digits) {
    using P = Real<working>;
    const TaylorRuns runs(local_digits, most_taylor_steps);
    const Scene& scene = problem.scene;
    FormulaTreeForm<P> tree(scene);
    std::vector<P> start(static_cast<std::size_t>(tree.dimension()));
    tree.initial(start.data());
    // the formulas' terms are not active before enter()
    Motions<P> motions = tree.tree().motions(start.data());
    for (Motion<P>& body : motions) body.q = normalized(body.q);
    const std::vector<std::array<P, 2>> coordinates = tree.tree().joint_coordinates(start.data());
    auto second = in_thread([&] {
        FormulaMaximalForm<P> bodies(scene, motions, std::span<const std::array<P, 2>>(coordinates));
        std::vector<Block> blocks = bodies.blocks(problem.scales);
        return split_run(
            FormulaRun<P, FormulaMaximalForm<P>>(scene, sample_times, std::move(bodies), std::move(blocks), runs.coarse)
                .run());
    });
    std::vector<Block> blocks = tree.blocks(problem.model()->scales());
    auto first = split_run(
        FormulaRun<P, FormulaTreeForm<P>>(scene, sample_times, std::move(tree), std::move(blocks), runs.fine).run());
    auto other = second.get();
    return compare_runs(problem, sample_times, first.first, other.first,
                        fmt::format("Taylor series with formula loads in {} digits: {} at order {} in {} steps, {} at "
                                    "order {} in {} steps",
                                    working, FormulaTreeForm<P>::name, runs.fine.order, first.first.steps,
                                    FormulaMaximalForm<P>::name, runs.coarse.order, other.first.steps),
                        static_cast<int>(working), first.second, other.second);
}

}  // namespace polhode::truth
