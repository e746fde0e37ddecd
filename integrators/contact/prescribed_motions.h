// Prescribed motions of joints over any scalar: the accelerations of their coordinates as functions of time.
//
// Recorded equations read transcendental functions of the time from variables of the system, whose rates follow by the
// chain rule (formula/evaluate.h). Numbers compute them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "formula/evaluate.h"
#include "scene/joint_motions.h"

namespace polhode::contact {

/// `P`: the scalar of the constants.
template <class P>
class PrescribedMotions {
  public:
    explicit PrescribedMotions(const Scene& scene)
        : motions_(std::make_shared<JointMotions>(compile_joint_motions(scene, scene.name))) {
        std::vector<P> constants;
        for (const FormulaParameter& parameter : scene.parameters) constants.push_back(P(parameter.value));
        uniform_ = formula::compute_uniform_values<P>(motions_->expression, constants);
        std::vector<int> accelerations, all;
        for (const JointMotions::Motion& one : motions_->motions) {
            accelerations.push_back(one.acceleration);
            all.insert(all.end(), {one.coordinate, one.rate, one.acceleration});
        }
        accelerations_ = formula::find_needed(motions_->expression, accelerations);
        for (std::size_t i = 0; i < accelerations_.size(); ++i)
            if (accelerations_[i] && !motions_->expression.is_uniform(static_cast<int>(i)) &&
                formula::is_transcendental(motions_->expression.nodes()[i].operation))
                functions_.push_back(i);
        all_ = formula::find_needed(motions_->expression, all);
    }

    std::size_t size() const { return motions_->motions.size(); }
    /// Index in scene.joints.
    std::size_t joint(std::size_t k) const { return motions_->motions[k].joint; }

    /// The number of variables.
    std::size_t variables() const { return functions_.size(); }
    /// Sets the variables to their values at time t (s).
    void update(const P& t, P* variables) const {
        if (functions_.empty()) return;
        const formula::Evaluation<P, P> values = evaluate(t, variables);
        for (std::size_t k = 0; k < functions_.size(); ++k)
            variables[k] = values.value(static_cast<int>(functions_[k]));
    }
    /// The rates of the variables, for recorded equations; zero for numbers.
    template <class S>
    void variable_rates(const S& t, const S* variables, S* rates) const {
        std::fill_n(rates, functions_.size(), S(P(0)));
        if constexpr (formula::TracedScalar<S>) {
            if (functions_.empty()) return;
            const S one(P(1));
            const std::vector<S> all = evaluate(t, variables).compute_rates(&one);
            for (std::size_t k = 0; k < functions_.size(); ++k) rates[k] = all[functions_[k]];
        }
    }
    /// The second derivatives of all coordinates at time t (s).
    template <class S>
    std::vector<S> accelerations(const S& t, const S* variables) const {
        const formula::Evaluation<S, P> values = evaluate(t, variables);
        std::vector<S> result;
        for (const JointMotions::Motion& one : motions_->motions) result.push_back(values.value(one.acceleration));
        return result;
    }
    /// A coordinate and its rate.
    struct State {
        P coordinate, rate;
    };
    /// The coordinates and rates at time t (s).
    std::vector<State> states(const P& t) const {
        formula::Evaluation<P, P> values(motions_->expression, uniform_, all_, nullptr);
        values.compute(&t);
        std::vector<State> result;
        for (const JointMotions::Motion& one : motions_->motions)
            result.push_back({values.value(one.coordinate), values.value(one.rate)});
        return result;
    }

  private:
    std::shared_ptr<const JointMotions> motions_;  // not copied with each form
    std::vector<P> uniform_;
    std::vector<char> accelerations_, all_;
    std::vector<std::size_t> functions_;  // nodes of the variables

    template <class S>
    formula::Evaluation<S, P> evaluate(const S& t, [[maybe_unused]] const S* variables) const {
        formula::Evaluation<S, P> values(motions_->expression, uniform_, accelerations_, nullptr);
        if constexpr (formula::TracedScalar<S>) {
            std::vector<const S*> by_node(accelerations_.size(), nullptr);
            for (std::size_t k = 0; k < functions_.size(); ++k) by_node[functions_[k]] = variables + k;
            values.compute(&t, by_node.data());
        } else {
            values.compute(&t);
        }
        return values;
    }
};

}  // namespace polhode::contact
