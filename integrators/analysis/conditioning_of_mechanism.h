// Conditioning of a scene of several bodies.
#pragma once

#include <vector>

#include "integrators/analysis/conditioning.h"

namespace polhode {

/// kappa as in conditioning(), of a posed mechanism: the state are the joints' coordinates and rates in units of their
/// scales, but angles in rad; of spherical joints and free bases the rotation vector of a small turn in the
/// quaternion's place; where there are loops, changes that keep them closed. `attitude`: that of the body that answers
/// most. From the variational equation by DOP853 on dual numbers. Of more than 40 coordinates and rates 16 directions
/// are followed, each a mixture of all: kappa is no less than what they show.
Conditioning conditioning_of_mechanism(const Problem& problem, const std::vector<double>& times,
                                       const ConditioningSettings& settings);

}  // namespace polhode
