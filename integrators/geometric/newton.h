// Newton's method for three equations, converged to rounding.
#pragma once

#include <cmath>
#include <limits>

#include "body/algebra.h"

namespace polhode {

/// M^-1 by cofactors, with one division.
template <class S>
class Inverse {
  public:
    explicit Inverse(const Matrix3<S>& M)
        : cofactors_{cross(M[1], M[2]), cross(M[2], M[0]), cross(M[0], M[1])},
          inverse_determinant_(1 / dot(M[0], cofactors_[0])) {}

    Vector3<S> operator()(const Vector3<S>& v) const {
        return inverse_determinant_ * (v[0] * cofactors_[0] + (v[1] * cofactors_[1] + v[2] * cofactors_[2]));
    }

  private:
    Vector3<S> cofactors_[3];
    S inverse_determinant_;
};

/// Solves residual(x) = 0 from the initial guess x. `slope(x)` is the residual's derivative or close to it. It is
/// evaluated at the guess and again only if the iteration slows down. Iterates until x changes only by rounding,
/// because a residual that is left unsolved in the same way at every step would accumulate. Returns false if this
/// fails; x is then not usable.
template <class S, class Residual, class Slope>
bool solve_to_rounding(Vector3<S>& x, const Residual& residual, const Slope& slope) {
    constexpr int max_iterations = 60;
    constexpr S unit = std::numeric_limits<S>::epsilon() / 2;
    constexpr S rounding = unit * unit, near = 128 * unit * (128 * unit);  // of squares
    Inverse<S> inverted(slope(x));
    S before = std::numeric_limits<S>::infinity();
    for (int i = 0; i < max_iterations; ++i) {
        const Vector3<S> change = inverted(residual(x));
        x = x - change;
        const S moved = dot(change, change), size = dot(x, x);
        if (!std::isfinite(moved)) return false;
        if (moved <= rounding * size) return true;
        if (moved >= S(0.25) * before && moved <= near * size) return true;
        if (moved > S(0.01) * before) inverted = Inverse<S>(slope(x));
        before = moved;
    }
    return false;
}

}  // namespace polhode
