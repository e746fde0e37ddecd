// Treatments of the gyroscopic term w x I w within a step of game engines.
#pragma once

#include <limits>

#include "body/elementary.h"
#include "body/mass_properties.h"
#include "body/orientation.h"

namespace polhode {

/// See the list in gyroscopic.cpp.
enum class GyroscopicTerm { none, explicit_euler, one_newton_step, linearly_implicit, midpoint, rescaled_momentum };

/// An inertia tensor in body axes and its inverse.
template <class S>
struct BodyInertia {
    Matrix3<S> tensor, inverse;

    /// w_B after a time h of the gyroscopic term alone.
    template <GyroscopicTerm term>
    Vector3<S> apply_gyroscopic_term(const Vector3<S>& w, S h) const {
        if constexpr (term == GyroscopicTerm::none) return w;
        const Vector3<S> L = tensor * w;
        if constexpr (term == GyroscopicTerm::explicit_euler) return w + h * (inverse * cross(L, w));
        if constexpr (term == GyroscopicTerm::one_newton_step || term == GyroscopicTerm::linearly_implicit) {
            // J and the residual times I^-1: numbers near 1 in any units.
            Matrix3<S> J = skew(w) * tensor;
            const Matrix3<S> skew_L = skew(L);
            for (int i = 0; i < 3; ++i)
                J[i] = term == GyroscopicTerm::one_newton_step ? h * (J[i] - skew_L[i]) : -(h * skew_L[i]);
            J = inverse * J;
            for (int i = 0; i < 3; ++i) J[i][i] += 1;
            return w + polhode::inverse(J) * (h * (inverse * cross(L, w)));
        }
        if constexpr (term == GyroscopicTerm::midpoint) {
            // For the mean m: m - w + (h/2) I^-1 (m x I m) = 0, with the Jacobian 1 + (h/2) I^-1 (skew(m) I - skew(I
            // m)).
            constexpr int max_iterations = 20;
            Vector3<S> mean = w;
            S before = std::numeric_limits<S>::infinity();
            for (int i = 0; i < max_iterations; ++i) {
                const Vector3<S> momentum = tensor * mean;
                Matrix3<S> J = skew(mean) * tensor;
                const Matrix3<S> skew_L = skew(momentum);
                for (int k = 0; k < 3; ++k) J[k] = (h / 2) * (J[k] - skew_L[k]);
                J = inverse * J;
                for (int k = 0; k < 3; ++k) J[k][k] += 1;
                const Vector3<S> residual = mean - w - (h / 2) * (inverse * cross(momentum, mean));
                const Vector3<S> change = polhode::inverse(J) * residual;
                mean = mean - change;
                // Iterate until rounding prevents further decrease.
                const S size = dot(change, change);
                if (!(size < before)) break;
                before = size;
            }
            return S(2) * mean - w;
        }
        if constexpr (term == GyroscopicTerm::rescaled_momentum) {
            const Vector3<S> L_new = L + h * cross(L, w);
            const S before = hypotenuse(L), after = hypotenuse(L_new);
            return after > 0 ? inverse * ((before / after) * L_new) : w;
        }
    }
};

}  // namespace polhode
