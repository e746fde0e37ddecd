// Base of steppers in joint coordinates (Stepper in run/march.h): the state (x, x') of a tree, its events and samples.
#pragma once

#include <memory>
#include <vector>

#include "integrators/run/march.h"
#include "motion/mechanism.h"

namespace polhode::multibody {

class JointState {
  public:
    /// Starts at t = 0. The problem must be a scene of several bodies.
    explicit JointState(const Problem& problem);
    void restart();
    void enter(const Segment& segment);
    std::vector<Sample> sample(double t) const;
    bool finite() const { return all_finite(std::span<const double>(y_)); }
    long rhs_evaluations() const { return steps_; }

  protected:
    const Tree<double>& tree() const { return model_->tree(); }
    std::size_t coordinates() const { return static_cast<std::size_t>(tree().links().coordinates); }
    std::size_t rates() const { return static_cast<std::size_t>(tree().links().rates); }
    /// Advances x by h times the rates in y. Attitudes are advanced by one exponential and normalised.
    void advance_coordinates(double h, std::vector<double>& y) const;

    std::shared_ptr<const MechanismModel> initial_model_, model_;
    std::vector<double> y_;   ///< x, x'
    std::vector<double> dy_;  ///< storage for x', x''
    long steps_ = 0;
};

}  // namespace polhode::multibody
