// What game engines make of the gyroscopic term w x I w within a step.
#pragma once

#include "body/elementary.h"
#include "body/mass_properties.h"
#include "body/orientation.h"

namespace polhode {

enum class GyroscopicTerm { none, explicit_euler, one_newton_step, rescaled_momentum };

/// A tensor in body axes and its inverse.
template <class S>
struct BodyInertia {
    Matrix3<S> tensor, inverse;

    /// w_B after a time h of the gyroscopic term alone.
    template <GyroscopicTerm term>
    Vector3<S> turned(const Vector3<S>& w, S h) const {
        if constexpr (term == GyroscopicTerm::none) return w;
        const Vector3<S> L = tensor * w;
        if constexpr (term == GyroscopicTerm::explicit_euler) return w + h * (inverse * cross(L, w));
        if constexpr (term == GyroscopicTerm::one_newton_step) {
            // J and the residual times I^-1: numbers near 1 whatever the units
            Matrix3<S> J = skew(w) * tensor;
            const Matrix3<S> skew_L = skew(L);
            for (int i = 0; i < 3; ++i) J[i] = h * (J[i] - skew_L[i]);
            J = inverse * J;
            for (int i = 0; i < 3; ++i) J[i][i] += 1;
            return w + polhode::inverse(J) * (h * (inverse * cross(L, w)));
        }
        if constexpr (term == GyroscopicTerm::rescaled_momentum) {
            const Vector3<S> turned = L + h * cross(L, w);
            const S before = hypotenuse(L), after = hypotenuse(turned);
            return after > 0 ? inverse * ((before / after) * turned) : w;
        }
    }
};

}  // namespace polhode
