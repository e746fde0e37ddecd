// Rounding of decimal strings.
#pragma once

#include <string>

namespace polhode::truth {

/// A number in scientific notation ("-1.2345e-03", or "0") rounded to `significant` digits, half away from zero.
std::string rounded_decimal(const std::string& number, int significant);

}  // namespace polhode::truth
