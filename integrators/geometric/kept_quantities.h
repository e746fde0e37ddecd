// Energy and momenta as polynomials of a system's state, over any scalar: what the equations themselves keep, whatever
// the length of q. The rotations enter by |q|^2 R(q), as they do in the right-hand side, so for |q| = 1 these are the
// quantities of motion/conserved.h (energy but for the constant part of a translation in closed form).
#pragma once

#include <type_traits>
#include <vector>

#include "motion/conserved.h"
#include "motion/problem.h"

namespace polhode {

/// conserved(), whatever formulation the problem was posed by. Directions are those of the reduced one.
inline std::vector<Conserved> conserved_by(const Problem& problem) {
    return conserved(problem.formulation == Formulation::full ? pose(problem.scene) : problem);
}

/// I w in posed axes, kg m^2/s.
template <class SystemType, class S>
Vector3<S> angular_momentum_posed(const Problem& problem, const Vector3<S>& w) {
    if constexpr (std::is_same_v<SystemType, FullMotion<double>>) return problem.full_inertia.tensor * w;
    const Vector3<double>& I = problem.principal.moments;
    return {I[0] * w[0], I[1] * w[1], I[2] * w[2]};
}

/// Kinetic energy and the potentials of the first segment's loads, J: a quadratic polynomial. Kept where
/// ConservedKind::energy is among what is conserved.
template <class SystemType, class S>
S state_energy(const Problem& problem, const S* y) {
    if constexpr (SystemType::dimension == 3) {
        // the half angle a with (c, s) = (cos a, sin a): torque cc c^2 + cs c s + ss s^2, over d(2 a). Where energy is
        // kept cc + ss = 0
        const PrincipalAxisRotation<double>& f = problem.segments.front().about_axis;
        const S cosine = y[1] * y[1] - y[2] * y[2], half_sine = y[1] * y[2];
        return (0.5 / f.inverse_moment) * (y[0] * y[0]) + ((0.5 * f.cs) * cosine - (f.cc - f.ss) * half_sine);
    } else {
        const Forcing<double>& f = problem.segments.front().forcing;
        const Vector3<S> w = vector_at(y, 0);
        const Quaternion<S> q = quaternion_at(y, 3);
        S energy = 0.5 * dot(w, angular_momentum_posed<SystemType>(problem, w));
        for (int b = 0; b < 3; ++b)
            if (f.field.present[b]) energy = energy - dot(f.field.moment[b], world_axis(q, b));
        for (const SpringTorque<double>& spring : f.springs) {
            const Vector3<S> r = vector_part(conjugate(spring.rest) * q);
            energy = energy + (2 * spring.stiffness) * dot(r, r);
        }
        if constexpr (SystemType::dimension == 13) {
            if (!problem.body.pivoted) {
                const Vector3<S> p = vector_at(y, 7), v = vector_at(y, 10);
                energy = energy + problem.body.mass * (0.5 * dot(v, v) - dot(f.acceleration_W, p));
            }
        }
        return energy;
    }
}

}  // namespace polhode
