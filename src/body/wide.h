// A scalar of 113 bits for what is worked out once (principal frames) or must not be rounded (differences from the
// truth). Never used inside a step.
#pragma once

#include <cmath>
#include <limits>

namespace polhode {

/// 113 bits of precision, computed in software: IEEE 754's binary128, the same bits whatever the compiler calls it.
#ifdef __SIZEOF_FLOAT128__
__extension__ using Wide = __float128;
#else
// on AArch64 long double is of this format, and GCC has no other name for it in C++
using Wide = long double;
static_assert(std::numeric_limits<Wide>::digits == 113, "this compiler has no floating-point type with 113 bits");
#endif

/// The square root by Newton's iteration from the binary64 one: two steps from 53 bits give 113. Zero of what rounding
/// left below zero.
inline Wide square_root(const Wide& x) {
    if (!(x > 0)) return x - x;  // what is not a number stays so
    if (x - x != 0) return x;    // infinity
    // scale by a power of four into binary64's range, so that the first guess neither overflows nor vanishes
    Wide scaled = x, factor = 1;
    while (scaled > Wide(1e300)) scaled /= Wide(0x1p200), factor *= Wide(0x1p100);
    while (scaled < Wide(1e-300)) scaled *= Wide(0x1p200), factor /= Wide(0x1p100);
    Wide root = std::sqrt(static_cast<double>(scaled));
    root = (root + scaled / root) / 2;
    root = (root + scaled / root) / 2;
    return root * factor;
}

}  // namespace polhode
