// Single steps of a method through a system, for drivers that end steps at events.
#pragma once

#include <cstddef>
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
    /// Number of evaluations of equations that are not calls of the problem's model.
    virtual long evaluations() { return 0; }
};

/// The coordinates of the equations that a method's steps solve in mechanisms.
enum class StepCoordinates {
    joints,  ///< the system of the problem, in joint coordinates
    bodies   ///< all coordinates of each body, with constraints (integrators/contact/constrained_joint_form.h)
};

/// Makes the steps of a method through the first segment of a problem with a user-defined system, to a tolerance as in
/// Settings (integrators/method.h). The problem must outlive the result. May be null.
class MakeSystemSteps {
  public:
    /// Makes the steps.
    using Function = std::unique_ptr<SystemSteps> (*)(const Problem& problem, double tolerance);

    constexpr MakeSystemSteps() = default;
    /// Null.
    // NOLINTNEXTLINE(google-explicit-constructor)
    constexpr MakeSystemSteps(std::nullptr_t) {}
    /// `coordinates`: of mechanisms whose joints have events.
    // NOLINTNEXTLINE(google-explicit-constructor)
    constexpr MakeSystemSteps(Function function, StepCoordinates coordinates = StepCoordinates::joints)
        : function_(function), coordinates_(coordinates) {}

    /// Makes the steps; must not be null.
    std::unique_ptr<SystemSteps> operator()(const Problem& problem, double tolerance) const {
        return function_(problem, tolerance);
    }
    /// Whether it is not null.
    explicit constexpr operator bool() const { return function_ != nullptr; }
    /// Whether function and coordinates are equal.
    constexpr bool operator==(const MakeSystemSteps&) const = default;
    /// The coordinates of mechanisms whose joints have events.
    constexpr StepCoordinates coordinates() const { return coordinates_; }

  private:
    Function function_ = nullptr;
    StepCoordinates coordinates_ = StepCoordinates::joints;
};

}  // namespace polhode
