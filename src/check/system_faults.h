// The faults that engines have with several bodies: those of the scene at hand, for each of its joints and bodies.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "check/system_model.h"

namespace polhode {

/// The number of a hypothesis that is fitted.
struct FittedNumber {
    double neutral = 1;  ///< with it the fault does nothing
    double trial = 0.5;  ///< a number whose effect is small against the motion's own changes
    double least = 0;    ///< no smaller number makes sense
    double plain = 0;    ///< what is no further from `neutral` is no fault
    double most = 1e4;   ///< no larger number makes sense
};

/// The trial numbers of damping are this rate, 1/s, times the inertia that it acts on.
inline constexpr double damping_trial = 0.05;

/// A fault in a scene of several bodies.
struct SystemHypothesis {
    std::string fault;                                ///< a word for programs
    Subject subject;                                  ///< what it is about
    std::string what;                                 ///< for people; {} stands for the number fitted
    std::string remedy;                               ///< what to do about it
    std::function<bool(SystemCause&, double)> apply;  ///< as Hypothesis::apply
    std::optional<FittedNumber> fit = {};             ///< nothing is fitted without
    std::string convention = {};                      ///< the words of --convention that mend the file, if any do
};

/// The faults of the table in check/known_faults.cpp that make sense with several bodies, then those of joints and
/// bodies. The scene's bodies must be given by numbers.
std::vector<SystemHypothesis> system_faults(const Scene& scene);

}  // namespace polhode
