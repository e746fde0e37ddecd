// Conversion of balls and bounds to decimal strings.
#pragma once

#include <string>

#include "integrators/truth/balls/ball.h"

namespace polhode::truth {

/// The bound with two significant digits, rounded upward (for example "3.1e-35"); "0" if it is zero.
std::string decimal_above(const Bound& bound);

/// The midpoint rounded to a multiple of 10^place, in scientific notation; "0" if it rounds to zero. Sets `error` to an
/// upper bound of the distance from the decimal to any number in the ball.
std::string decimal_near(const Ball& ball, long place, Bound& error);

}  // namespace polhode::truth
