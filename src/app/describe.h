// The texts of `polhode describe`.
#pragma once

#include <string>

#include "app/description.h"
#include "integrators/method.h"
#include "scene/scene.h"

namespace polhode {

/// Returns mass properties, initial state, loads, the system posed, omitted terms with reasons, invariants,
/// conditioning at T, and the polhode drawn in characters.
std::string describe_scene(const Scene& scene,
                           description::ConditioningBudget budget = description::ConditioningBudget::brief);

/// Returns name, documentation, accepted settings, order, conserved quantities, stability and source.
std::string describe_method(const Method& method);

}  // namespace polhode
