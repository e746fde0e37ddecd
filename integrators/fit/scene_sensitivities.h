// Derivatives of the motion of any scene that has a reference.
#pragma once

#include <span>
#include <vector>

#include "integrators/analysis/sensitivity.h"

namespace polhode {

/// Computes the derivatives by central differences of the reference (truth/reference.h) in 34 digits. With a change of
/// the number by 2^-42 of its size, the error is about 1e-20. Failed if a reference is unavailable, or where the
/// derivative is not defined, as at the time of an event whose time changes with the number: there, the motion itself
/// is not the mean of those ahead and behind. Arguments, limits and exceptions as sensitivities().
Sensitivities difference_sensitivities(const Scene& scene, std::span<const SceneChange> changes,
                                       const std::vector<double>& times, const SensitivitySettings& settings = {});

/// Computes the derivatives by difference_sensitivities() if the scene has a part_with_events(), else by
/// sensitivities().
Sensitivities scene_sensitivities(const Scene& scene, std::span<const SceneChange> changes,
                                  const std::vector<double>& times, const SensitivitySettings& settings = {});

}  // namespace polhode
