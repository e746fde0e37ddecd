// Potentials given by formulas.
#pragma once

#include "motion/exact_body_of.h"
#include "motion/formula_terms.h"

namespace polhode {

/// The sum of the formula potentials of a scene that act at time t (s), J. q, of unit length, maps body axes to world
/// axes; p_W (m) belongs to the centre of mass.
template <class P>
P formula_potential(const Scene& scene, double t, const Quaternion<P>& q, const Vector3<P>& p_W) {
    if (!has_formula_potential(scene)) return P(0);
    FormulaTerms<P> terms(compile_formulas(scene, scene.name), scene, exact_body<P>(scene),
                          mass_properties<P>(scene.body).inertia);
    terms.enter(t);
    return terms.potential(FormulaState<P>(P(t), Vector3<P>(), q, p_W, Vector3<P>()));
}

extern template double formula_potential(const Scene&, double, const Quaternion<double>&, const Vector3<double>&);
extern template Wide formula_potential(const Scene&, double, const Quaternion<Wide>&, const Vector3<Wide>&);

}  // namespace polhode
