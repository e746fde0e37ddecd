// Newton's method for three equations, to round-off.
#pragma once

#include <cmath>

#include "body/algebra.h"

namespace polhode {

/// Solves residual(x) = 0 from the guess x. `slope(x)` is its derivative, or near it: it is formed at the guess and
/// again only where the iteration slows down. Ends where x moves by its rounding only, as a residual that is left
/// unsolved the same way at every step would add up. False where that does not come about; x is then of no use.
template <class Residual, class Slope>
bool solve_to_rounding(Vector3<double>& x, const Residual& residual, const Slope& slope) {
    constexpr int most = 60;
    constexpr double rounding = 0x1p-53 * 0x1p-53, near = 0x1p-46 * 0x1p-46;  // of squares
    Matrix3<double> inverted = inverse(slope(x));
    double before = INFINITY;
    for (int i = 0; i < most; ++i) {
        const Vector3<double> change = inverted * residual(x);
        x = x - change;
        const double moved = dot(change, change), size = dot(x, x);
        if (!(moved < INFINITY)) return false;
        if (moved <= rounding * size) return true;
        if (moved >= 0.25 * before && moved <= near * size) return true;
        if (moved > 0.01 * before) inverted = inverse(slope(x));
        before = moved;
    }
    return false;
}

}  // namespace polhode
