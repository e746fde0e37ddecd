// Single steps of a method through a system, for drivers that end steps at events.
#pragma once

#include <memory>
#include <string>

#include "motion/problem.h"

namespace polhode {

/// Steps of one method from the initial state of a problem through its first segment. The independent variable starts
/// at 0. Made by Method::steps.
class SystemSteps {
  public:
    virtual ~SystemSteps() = default;
    /// Takes one step of at most `longest`. Returns its length; 0 if the method cannot continue.
    virtual double step(double longest) = 0;
    /// Why step() returned 0.
    virtual std::string fault() = 0;
    /// The state after the last step.
    virtual const double* state() = 0;
    /// Degree of the polynomial that inside() evaluates; 0 if the method has no dense output.
    virtual int dense_degree() { return 0; }
    /// Writes the state at s after the start of the last step.
    virtual void inside([[maybe_unused]] double s, [[maybe_unused]] double* y) {}
    /// Returns to the start of the last step. Called only for methods without dense output.
    virtual void undo() {}
};

/// Makes the steps of a method through the first segment of a problem with a user-defined system, to a tolerance as in
/// Settings (integrators/method.h). The problem must outlive the result.
using MakeSystemSteps = std::unique_ptr<SystemSteps> (*)(const Problem& problem, double tolerance);

}  // namespace polhode
