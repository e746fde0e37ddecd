// Symmetric compositions of a symmetric step of order 2: steps g_1 h, g_2 h, .. g_s h with g_i = g_(s+1-i).
#pragma once

#include <span>

namespace polhode {

/// Returns the g_i, in units of the step, of a composition of order 2, 4, 6 or 8; empty for any other order.
///   2  the step itself
///   4  M. Suzuki 1990, Phys. Lett. A 146, 319: five stages with g = 1/(4 - 4^(1/3))
///   6  W. Kahan & R.-C. Li 1997, Math. Comp. 66, 1089: nine stages, s9odr6a
///   8  Kahan & Li 1997: seventeen stages, s17odr8a
std::span<const double> composition(int order);

}  // namespace polhode
