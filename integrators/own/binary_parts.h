// Exponent and mantissa of normal binary64 numbers, without library calls. The approximate logarithms and powers of
// step controls use them, so that they give the same bits with every C library.
#pragma once

#include <bit>
#include <cstdint>

namespace polhode {

/// e of |x| = m 2^e, 1 <= m < 2.
inline int exponent_of(double x) { return static_cast<int>(std::bit_cast<std::uint64_t>(x) >> 52 & 0x7FF) - 1023; }
/// m of x = m 2^e, x > 0.
inline double mantissa_of(double x) {
    return std::bit_cast<double>((std::bit_cast<std::uint64_t>(x) & 0xFFFFFFFFFFFFF) | 0x3FF0000000000000);
}
/// 2^n, -1023 < n < 1024.
inline double power_of_two(int n) { return std::bit_cast<double>(static_cast<std::uint64_t>(n + 1023) << 52); }

}  // namespace polhode
