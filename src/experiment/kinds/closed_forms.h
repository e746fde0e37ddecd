// Closed forms and first integrals of the catalogue's scenes with contacts, joint limits and friction, compared with
// the truth.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "integrators/truth/attempt.h"
#include "scene/scene.h"

namespace polhode {

/// A number of a motion by a closed form, and polhode's number for the same quantity.
struct FormComparison {
    std::string quantity;              ///< with unit
    std::string form;                  ///< the formula; for a first integral "constant"
    std::string source;                ///< author and year
    std::string expected;              ///< the formula's value, 25 digits
    std::string computed;              ///< the truth's value, 25 digits; empty if the motion lacks the event
    std::optional<double> difference;  ///< |computed - expected| / max(|expected|, scale of the quantity)
};

/// Compares the truth of a built-in scene of contact/ or joints/ with the scene's closed forms. All formulas are
/// evaluated in 50 digits from the scene's binary64 numbers. Returns an empty list for other scenes, or without a
/// truth.
std::vector<FormComparison> compare_closed_forms(const Scene& scene, const truth::Truth& truth);

}  // namespace polhode
