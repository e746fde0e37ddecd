// Decimals in 113 bits.
#pragma once

#include <string_view>

#include "body/wide.h"

namespace polhode {

/// 10^exponent, with a relative error of some 1e-33.
Wide power_of_ten(int exponent);

/// Parses a decimal such as "-929.47" or "1e-3", with a relative error of some 1e-33.
Wide parse_wide(std::string_view text);

}  // namespace polhode
