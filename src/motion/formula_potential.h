// Potentials given by formulas.
#pragma once

#include <span>
#include <vector>

#include "motion/exact_body_of.h"
#include "motion/formula_terms.h"
#include "motion/formula_tree.h"

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

/// The sum of the formula potentials of a scene of several bodies that act at time t (s), J. `motions`: of its bodies.
template <class P>
P formula_potential_of_bodies(const Scene& scene, double t, std::span<const BodyMotion<P>> motions) {
    std::vector<MassProperties<P>> properties;
    for (const NamedBody& body : scene.bodies) properties.push_back(mass_properties<P>(body.body));
    FormulaValues<P> values(compile_formulas(scene, scene.name), mechanism_formula_constants<P>(scene, properties));
    values.enter(t);
    MechanismState<P> state(motions.size(), scene.joints.size());
    state.input[FormulaInputs::time] = P(t);
    for (std::size_t b = 0; b < motions.size(); ++b)
        state.set_body(static_cast<int>(b), motions[b].angular_velocity_B, normalized(motions[b].q),
                       motions[b].position_W, motions[b].velocity_W);
    return values.potential(state);
}

extern template double formula_potential(const Scene&, double, const Quaternion<double>&, const Vector3<double>&);
extern template double formula_potential_of_bodies(const Scene&, double, std::span<const BodyMotion<double>>);
extern template Wide formula_potential_of_bodies(const Scene&, double, std::span<const BodyMotion<Wide>>);
extern template Wide formula_potential(const Scene&, double, const Quaternion<Wide>&, const Vector3<Wide>&);

}  // namespace polhode
