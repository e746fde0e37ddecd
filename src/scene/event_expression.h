// Formulas whose zeros are events of a motion, compiled with the names of a scene.
#pragma once

#include <string>
#include <vector>

#include "formula/expression.h"
#include "scene/scene.h"

namespace polhode {

/// Scalar formulas of time and state. Inputs and constants of the expression are numbered as those of the scene's
/// formula loads (scene_formulas.h).
struct EventExpression {
    formula::Expression expression;  ///< all operations
    std::vector<int> outputs;        ///< one node per formula
};

/// Compiles formulas in the language of formula loads. They can use the scene's parameters, tables and definitions.
/// Throws InputError that names the formula, for example `events[0]: "w - 1": column 3: ..`.
EventExpression compile_event_formulas(const Scene& scene, const std::vector<std::string>& formulas);

}  // namespace polhode
