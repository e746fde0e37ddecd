// What a scene's motion keeps, found from its loads.
#pragma once

#include <string>
#include <vector>

#include "motion/problem.h"

namespace polhode {

enum class ConservedKind {
    energy,
    angular_momentum,
    angular_momentum_component,
    linear_momentum,
    linear_momentum_component,
    spin,
    integral_of_a_special_top  ///< Kovalevskaya's, Goryachev and Chaplygin's
};

/// A quantity of one body or of several together that stays what it is at t = 0+ (after any impulse there) until the
/// end.
struct Conserved {
    ConservedKind kind;
    std::string name;           ///< "E", "L . u along gravity", ..
    std::string formula;        ///< what it is, with units
    std::vector<double> value;  ///< one number, or three of a vector in world axes
    /// The value of this quantity at another sample of a scene of one body, its components in the order of `value`;
    /// null of several bodies.
    std::vector<double> (*of)(const Problem&, const Conserved&, const Sample&);
    Vector3<double> direction;  ///< unit vector that some quantities are taken along: world or posed axes
};

/// Energy, the vectors of angular and linear momentum or as many of their components as stay, the spin about an axis
/// of symmetry, Kovalevskaya's integral, Goryachev and Chaplygin's. `problem` must be posed as Formulation::reduced.
/// Each is kept by the exact motion: no other kind of integral is looked for. Directions and moments count as equal
/// within 1e-12. Of several bodies see conserved_by_mechanism().
std::vector<Conserved> conserved(const Problem& problem);

}  // namespace polhode
