// Steps in joint coordinates that compute rates before coordinates.
#pragma once

#include <vector>

#include "integrators/multibody/armature.h"
#include "integrators/multibody/joint_state.h"

namespace polhode::multibody {

/// Semi-implicit step: rates first, then coordinates by the new rates, then projection onto the loop constraints.
class SemiImplicitSteps : public JointState {
  public:
    using JointState::JointState;

  protected:
    /// x'' at the current state.
    std::vector<double> accelerations() {
        tree().derivative(y_.data(), dy_.data());
        return {dy_.begin() + static_cast<std::ptrdiff_t>(coordinates()), dy_.end()};
    }
    void advance(double h, const std::vector<double>& a) {
        advance_rates(h, a);
        move(h);
    }
    void advance_rates(double h, const std::vector<double>& a) {
        for (std::size_t k = 0; k < rates(); ++k) y_[coordinates() + k] += h * a[k];
    }
    /// Advances the coordinates by the rates.
    void move(double h) {
        advance_coordinates(h, y_);
        if (model_->projects()) model_->project(y_.data());
        ++steps_;
    }
};

/// (M + h D) a = f(x, x'),  x' += h a,  x += h x', where D holds the joints' dampers. With M a_0 = f,
/// a = a_0 - (M + h D)^-1 h D a_0.
class ImplicitDamping : public SemiImplicitSteps {
  public:
    explicit ImplicitDamping(const Problem& problem) : SemiImplicitSteps(problem) {
        for (const Link<double>& link : tree().links().links)
            for (int k = 0; k < link.rates(); ++k) {
                damping_.push_back(link.kind == LinkJoint::free ? 0 : link.damping);
                own_armature_.push_back(link.armature);
            }
        for (const double c : damping_) has_damping_ = has_damping_ || c != 0;
    }
    void step(double, double h) {
        std::vector<double> a = accelerations();
        damp(h, a);
        advance(h, a);
    }

  protected:
    /// a = a_0 - (M + h D)^-1 h D a_0
    void damp(double h, std::vector<double>& a) {
        if (!has_damping_) return;
        TreeWork<double>& at = tree().work<double>();
        tree().move(y_.data(), at);
        armature_.resize(damping_.size()), torque_.resize(damping_.size());
        for (std::size_t k = 0; k < damping_.size(); ++k)
            armature_[k] = h * damping_[k], torque_[k] = armature_[k] * a[k], armature_[k] += own_armature_[k];
        solver_.copy_links(tree(), at);
        solver_.factorize(tree(), armature_);
        solver_.solve(tree(), torque_, change_);
        for (std::size_t k = 0; k < a.size(); ++k) a[k] -= change_[k];
    }

  private:
    std::vector<double> damping_, own_armature_, armature_, torque_, change_;
    bool has_damping_ = false;
    ArmatureSolver solver_;
};

}  // namespace polhode::multibody
