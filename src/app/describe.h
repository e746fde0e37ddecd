// What `polhode describe` prints.
#pragma once

#include <string>

#include "app/description.h"
#include "integrators/method.h"
#include "scene/scene.h"

namespace polhode {

/// Mass properties, start, loads, the system posed, what was left out and why, invariants, conditioning at T,
/// and the polhode drawn in characters.
std::string describe_scene(const Scene& scene,
                           description::ConditioningBudget budget = description::ConditioningBudget::brief);

/// Name, documentation, control, order, what it conserves, source.
std::string describe_method(const Method& method);

}  // namespace polhode
