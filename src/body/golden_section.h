// Minimum of a function of one variable by golden section.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "body/elementary.h"

namespace polhode {

/// An argument and the value of the function there.
template <class P, class V>
struct Minimum {
    P x;
    V value;
};

/// Narrows a bracket [a, b] of a minimum `steps` times, or until its points are no longer distinct. Each step evaluates
/// the function once and multiplies the length by 0.618. Returns the better of the last two inner points.
template <class P, class Function>
auto golden_section(const Function& f, P a, P b, int steps) {
    const P ratio = (square_root(P(5)) - P(1)) / P(2);
    P x = b - ratio * (b - a), y = a + ratio * (b - a);
    auto fx = f(x), fy = f(y);
    for (int i = 0; i < steps && a < x && x < y && y < b; ++i) {
        if (fx < fy)
            b = y, y = x, fy = fx, x = b - ratio * (b - a), fx = f(x);
        else
            a = x, x = y, fx = fy, y = a + ratio * (b - a), fy = f(y);
    }
    using Result = Minimum<P, decltype(fx)>;
    return fx < fy ? Result{x, fx} : Result{y, fy};
}

}  // namespace polhode
