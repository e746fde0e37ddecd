// The conserved quantities of a scene's motion, derived from its loads.
#pragma once

#include <string>
#include <vector>

#include "motion/problem.h"

namespace polhode {

/// The kind of a conserved quantity.
enum class ConservedKind {
    energy,
    angular_momentum,
    angular_momentum_component,
    linear_momentum,
    linear_momentum_component,
    spin,
    integral_of_a_special_top  ///< Kovalevskaya's integral; Goryachev and Chaplygin's integral
};

/// A quantity of one body or of a whole system that keeps its value at t = 0+ (after any impulse there) until the
/// end.
struct Conserved {
    ConservedKind kind;
    std::string name;           ///< "E", "L . u along gravity", ..
    std::string formula;        ///< definition, with units
    std::vector<double> value;  ///< one number, or the three components of a vector in world axes
    /// The value of this quantity at another sample of a scene of one body, with components ordered as in `value`;
    /// null for several bodies.
    std::vector<double> (*of)(const Problem&, const Conserved&, const Sample&);
    Vector3<double> direction;  ///< unit vector of quantities along a direction: world or posed axes
};

/// Finds the conserved energy, angular and linear momentum (vectors or single components), spin about an axis of
/// symmetry, Kovalevskaya's integral, and Goryachev and Chaplygin's. `problem` must be posed as Formulation::reduced.
/// Every result is conserved by the exact motion; other kinds of integrals are not searched for. Directions and
/// moments count as equal within 1e-12. For several bodies see conserved_by_mechanism().
std::vector<Conserved> conserved(const Problem& problem);

}  // namespace polhode
