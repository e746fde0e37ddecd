// Conditioning of a scene of several bodies, or with loads given by formulas.
#pragma once

#include <vector>

#include "integrators/analysis/conditioning.h"

namespace polhode {

/// Computes kappa as conditioning() does, for a posed mechanism or for one body with formula loads without switches.
/// The state of a mechanism consists of the joint coordinates and rates in units of their scales, but angles in rad;
/// spherical joints and free bases use the rotation vector of a small rotation. With loops, only changes that keep them
/// closed count. `attitude` is that of the body with the largest response. Solves the variational equation by DOP853 on
/// dual numbers. With more than 40 coordinates and rates, 16 random combinations of all directions are followed, and
/// the result is a lower bound of kappa.
Conditioning model_conditioning(const Problem& problem, const std::vector<double>& times,
                                const ConditioningSettings& settings);

}  // namespace polhode
