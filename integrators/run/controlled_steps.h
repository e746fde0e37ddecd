// The steps of a stepper that chooses its own step sizes, for drivers that end steps at events.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "integrators/run/march_controlled.h"
#include "motion/system_steps.h"

namespace polhode {

/// `Stepper`: a ControlledStepper with state(), and state_inside() and dense_degree if it has dense output.
template <class Stepper>
class ControlledSteps : public SystemSteps {
  public:
    ControlledSteps(const Problem& problem, Stepper stepper) : stepper_(std::move(stepper)) {
        stepper_.restart();
        stepper_.enter(problem.segments.front());
        h_ = stepper_.first_step(0);
    }
    double step(double longest) override {
        constexpr int most_attempts = 1000;
        if constexpr (!has_dense_output) before_ = stepper_, h_before_ = h_;
        for (int i = 0; i < most_attempts && h_ > std::numeric_limits<double>::min(); ++i) {
            const bool is_cut = h_ >= longest * (1 - 1e-14);
            const double tried = is_cut ? longest : h_;
            double t = 0, next = tried;
            outcome_ = stepper_.attempt(t, next);
            if (outcome_ == Attempt::accepted) {
                // the length of a step that was cut does not apply to the next one, unless it is shorter
                if (!is_cut || next < tried || next > h_) h_ = next;
                return tried;
            }
            h_ = next;
        }
        return 0;
    }
    std::string fault() override {
        return outcome_ == Attempt::not_finite ? "the motion is not finite at any step size"
                                               : "the tolerance is not met at any step size";
    }
    const double* state() override { return stepper_.state(); }
    int dense_degree() override {
        if constexpr (has_dense_output) return Stepper::dense_degree;
        return 0;
    }
    void inside([[maybe_unused]] double s, [[maybe_unused]] double* y) override {
        if constexpr (has_dense_output) stepper_.state_inside(s, y);
    }
    void undo() override {
        if (before_) stepper_ = *before_, h_ = h_before_;
    }

  private:
    static constexpr bool has_dense_output = requires(Stepper s, double* y) { s.state_inside(0.0, y); };

    Stepper stepper_;
    std::optional<Stepper> before_;  // at the start of the last step; not used with dense output
    double h_ = 0, h_before_ = 0;
    Attempt outcome_ = Attempt::accepted;
};

}  // namespace polhode
