// MuJoCo's soft constraint (E. Todorov 2014, Convex and analytically-invertible dynamics with contacts and constraints,
// ICRA; MuJoCo's documentation of solver parameters, solref and solimp). A constraint with the position r < 0 and the
// velocity u has the reference acceleration and the regularisation
//   a_ref = -b u - k d r,   b = 2 / (d_max T),   k = 1 / (d_max T z)^2,   R = (1 - d) / d / m
// with the damping ratio z = 1, the impedance d(r) from d_min at r = 0 to d_max at |r| = w, and the inverse mass 1/m of
// the constraint. T is at least two steps.
#pragma once

#include <algorithm>

namespace polhode {

/// The default values are MuJoCo's.
template <class S>
struct SoftConstraint {
    S time = S(0.02);                  ///< T, s
    S least = S(0.9), most = S(0.95);  ///< d_min, d_max
    S width = S(0.001);                ///< w, m or rad
    S step;                            ///< s

    /// T, s
    S time_constant() const { return std::max(time, S(2) * step); }
    /// d at a penetration, m or rad
    S impedance(const S& penetration) const {
        const S depth = std::min(S(1), penetration / width);
        const S shape = depth < S(0.5) ? S(2) * depth * depth : S(1) - S(2) * (S(1) - depth) * (S(1) - depth);
        return least + shape * (most - least);
    }
    /// b, 1/s
    S damping() const { return S(2) / (most * time_constant()); }
    /// k, 1/s^2
    S stiffness() const {
        const S T = time_constant();
        return S(1) / (most * T * most * T);
    }
};

}  // namespace polhode
