// A scalar of 113 bits for values that are computed once (principal frames) or must not be rounded (differences from
// the reference). Never used inside a step.
#pragma once

#include <cmath>
#include <limits>

namespace polhode {

/// IEEE 754 binary128, 113 bits of precision, computed in software. Gives the same bits under either name of the
/// type.
#ifdef __SIZEOF_FLOAT128__
__extension__ using Wide = __float128;
#else
// on AArch64 long double has this format, and GCC has no other name for it in C++
using Wide = long double;
static_assert(std::numeric_limits<Wide>::digits == 113, "no floating-point type of 113 bits on this machine");
#endif

/// The square root by Newton's iteration from the binary64 root: two steps extend 53 bits to 113. Zero for values
/// that rounding has left below zero.
inline Wide square_root(const Wide& x) {
    if (!(x > 0)) return x - x;  // NaN stays NaN
    if (x - x != 0) return x;    // infinity
    // scale by a power of four into the range of binary64, so that the initial guess neither overflows nor underflows
    Wide scaled = x, factor = 1;
    while (scaled > Wide(1e300)) scaled /= Wide(0x1p200), factor *= Wide(0x1p100);
    while (scaled < Wide(1e-300)) scaled *= Wide(0x1p200), factor /= Wide(0x1p100);
    Wide root = std::sqrt(static_cast<double>(scaled));
    root = (root + scaled / root) / 2;
    root = (root + scaled / root) / 2;
    return root * factor;
}

}  // namespace polhode
