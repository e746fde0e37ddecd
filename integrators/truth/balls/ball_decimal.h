// Balls as decimals.
#pragma once

#include <string>

#include "integrators/truth/balls/ball.h"

namespace polhode::truth {

/// The bound in two significant digits, rounded upward ("3.1e-35"; "0").
std::string decimal_above(const Bound& bound);

/// The midpoint rounded to a multiple of 10^place, in scientific notation ("0" where it is that); `error` becomes a
/// bound of the distance from the decimal to any number in the ball.
std::string decimal_near(const Ball& ball, long place, Bound& error);

}  // namespace polhode::truth
