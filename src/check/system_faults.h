// The faults of engines with several bodies, listed for each joint and body of a scene.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "check/system_model.h"

namespace polhode {

/// The fitted number of a hypothesis.
struct FittedNumber {
    double neutral = 1;  ///< value without effect
    double trial = 0.5;  ///< first value of the fit; its effect is small
    double least = 0;    ///< smallest valid value
    double plain = 0;    ///< smallest difference from `neutral` that counts as a fault
    double most = 1e4;   ///< largest valid value
};

/// Decay rate, 1/s, that gives the trial value of damping when multiplied by the inertia that it acts on.
inline constexpr double damping_trial = 0.05;

/// A fault in a scene of several bodies.
struct SystemHypothesis {
    std::string fault;                                ///< identifier for programs
    Subject subject;                                  ///< what the fault is about
    std::string what;                                 ///< for users; {} stands for the fitted number
    std::string remedy;                               ///< what to do about it
    std::function<bool(SystemCause&, double)> apply;  ///< as Hypothesis::apply
    std::optional<FittedNumber> fit = {};             ///< empty: no number is fitted
    std::string convention = {};                      ///< the --convention that corrects the file, if there is one
};

/// Lists the faults of check/known_faults.cpp that apply to several bodies, then those of joints and bodies. The
/// scene's bodies must have numeric mass properties.
std::vector<SystemHypothesis> system_faults(const Scene& scene);

}  // namespace polhode
