// Functions of formulas on balls.
#pragma once

#include "formula/evaluate.h"
#include "integrators/truth/balls/ball.h"

namespace polhode::truth {

/// Thrown where a formula depends on the sign of a ball that contains zero and other numbers.
struct UndecidedSign {};

}  // namespace polhode::truth

namespace polhode::formula {

/// @cond specialisation
template <>
struct Functions<truth::Ball> {
    using Ball = truth::Ball;
    static Ball logarithm(const Ball& x) { return truth::apply(arb_log, x); }
    static Ball arctangent(const Ball& y, const Ball& x) {
        Ball angle;
        arb_atan2(angle.raw(), y.raw(), x.raw(), Ball::precision());
        return angle;
    }
    static Ball arcsine(const Ball& x) { return truth::apply(arb_asin, x); }
    static Ball arccosine(const Ball& x) { return truth::apply(arb_acos, x); }
    static Ball hyperbolic_tangent(const Ball& x) { return truth::apply(arb_tanh, x); }
    static Ball hyperbolic_sine(const Ball& x) { return truth::apply(arb_sinh, x); }
    static Ball power(const Ball& x, const Ball& y) {
        Ball result;
        arb_pow(result.raw(), x.raw(), y.raw(), Ball::precision());
        return result;
    }
    /// Throws UndecidedSign.
    static int sign(const Ball& x) {
        if (x.is_zero()) return 0;
        if (x.contains_zero()) throw truth::UndecidedSign();
        return x.is_positive() ? 1 : -1;
    }
};
/// @endcond

}  // namespace polhode::formula
