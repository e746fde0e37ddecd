// The attempt for several bodies. Each working precision is instantiated in its own file.
#pragma once

#include <cmath>
#include <span>
#include <utility>

#include "integrators/truth/attempt_taylor.h"
#include "integrators/truth/maximal_form.h"
#include "integrators/truth/tree_form.h"
#include "motion/mechanism.h"

namespace polhode::truth {

/// Output of a mechanism's formulation at a sample: the motions, and further quantities where available.
template <class P>
struct MechanismMoment {
    Motions<P> motions;
    std::vector<Reaction<P>> reactions;
    std::vector<std::array<double, 2>> coordinates;  ///< one entry per joint, rad or m; empty if not available
};

/// A formulation whose motion() returns all of these.
template <class P, class Form>
class WithReactions : public Form {
  public:
    using Form::Form;

    MechanismMoment<P> motion(const P* y) const {
        MechanismMoment<P> moment{Form::motion(y), Form::reactions(y), {}};
        if constexpr (requires { Form::joint_coordinates(y); })
            for (const std::array<P, 2>& x : Form::joint_coordinates(y))
                moment.coordinates.push_back({static_cast<double>(x[0]), static_cast<double>(x[1])});
        return moment;
    }
};

/// Separates a run into its motions and the other quantities.
template <class P>
std::pair<Run<P, Motions<P>>, MechanismOutputs<P>> split_run(Run<P, MechanismMoment<P>> run) {
    std::pair<Run<P, Motions<P>>, MechanismOutputs<P>> parts;
    parts.first.fault = std::move(run.fault), parts.first.steps = run.steps;
    for (MechanismMoment<P>& moment : run.motions) {
        parts.first.motions.push_back(std::move(moment.motions));
        parts.second.reactions.push_back(std::move(moment.reactions));
        if (!moment.coordinates.empty()) parts.second.coordinates.push_back(std::move(moment.coordinates));
    }
    return parts;
}

template <unsigned working>
Attempt attempt_by_mechanism_series(const Problem& problem, const std::vector<double>& sample_times,
                                    double local_digits) {
    using P = Real<working>;
    const TaylorRuns runs(local_digits, most_taylor_steps);
    const Scene& scene = problem.scene;
    const std::vector<Leg> legs = itinerary(scene);
    WithReactions<P, TreeForm<P>> tree(scene);
    std::vector<P> start(static_cast<std::size_t>(tree.dimension()));
    tree.initial(start.data());
    const Motions<P> motions = tree.TreeForm<P>::motion(start.data());
    const std::vector<std::array<P, 2>> coordinates = tree.joint_coordinates(start.data());
    auto second = in_thread([&] {
        WithReactions<P, MaximalForm<P>> bodies(scene, motions, std::span<const std::array<P, 2>>(coordinates));
        std::vector<Block> blocks = bodies.blocks(problem.scales);
        return split_run(taylor<P>(std::move(bodies), legs, sample_times, std::move(blocks), runs.coarse));
    });
    std::vector<Block> blocks = tree.blocks(mechanism_of(problem).scales());
    const auto first = split_run(taylor<P>(std::move(tree), legs, sample_times, std::move(blocks), runs.fine));
    const auto other = second.get();
    return compare_runs(
        problem, sample_times, first.first, other.first,
        fmt::format("Taylor series in {} digits: {} at order {} in {} steps, {} at order {} in {} steps", working,
                    TreeForm<P>::name, runs.fine.order, first.first.steps, MaximalForm<P>::name, runs.coarse.order,
                    other.first.steps),
        static_cast<int>(working), first.second, other.second);
}

}  // namespace polhode::truth
