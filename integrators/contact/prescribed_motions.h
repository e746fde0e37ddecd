// Prescribed motions of joints over any scalar: the accelerations of their coordinates as functions of time.
#pragma once

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
        all_ = formula::find_needed(motions_->expression, all);
    }

    std::size_t size() const { return motions_->motions.size(); }
    /// Index in scene.joints.
    std::size_t joint(std::size_t k) const { return motions_->motions[k].joint; }

    /// The second derivatives of all coordinates at time t (s).
    template <class S>
    std::vector<S> accelerations(const S& t) const {
        formula::Evaluation<S, P> values(motions_->expression, uniform_, accelerations_, nullptr);
        values.compute(&t);
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
};

}  // namespace polhode::contact
