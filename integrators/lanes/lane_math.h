// Arithmetic and elementary functions on eight binary64 numbers side by side. The result in a lane does not depend on
// the other lanes or on the instruction set (see lanes.h).
//
// Everything is always inlined and branch-free. Loops that run until all lanes converge freeze the converged lanes.
// Compile sources that use it with -fno-math-errno (square roots as instructions) and -Wno-psabi.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "integrators/lanes/lanes.h"

namespace polhode {

using Integers8 = std::int64_t __attribute__((vector_size(64)));

/// A struct, because a bare vector has neither a calling convention nor the same alignment without such registers.
struct alignas(64) Octet {
    Lanes8 v{};
};
/// All bits of a lane are set, or none. Masks are combined as sums of 0 and 1, because GCC 12 splits vector logic
/// into lanes.
struct alignas(64) OctetMask {
    Integers8 m{};
};

POLHODE_INLINE Octet octet(double x) { return {Lanes8{x, x, x, x, x, x, x, x}}; }

POLHODE_INLINE Octet octet_at(const double* from) {
    Octet x;
    std::memcpy(&x.v, from, sizeof x.v);
    return x;
}
POLHODE_INLINE void put(double* to, const Octet& x) { std::memcpy(to, &x.v, sizeof x.v); }

POLHODE_INLINE Octet operator+(const Octet& a, const Octet& b) { return {a.v + b.v}; }
POLHODE_INLINE Octet operator-(const Octet& a, const Octet& b) { return {a.v - b.v}; }
POLHODE_INLINE Octet operator*(const Octet& a, const Octet& b) { return {a.v * b.v}; }
POLHODE_INLINE Octet operator/(const Octet& a, const Octet& b) { return {a.v / b.v}; }
POLHODE_INLINE Octet operator+(const Octet& a, double b) { return {a.v + b}; }
POLHODE_INLINE Octet operator-(const Octet& a, double b) { return {a.v - b}; }
POLHODE_INLINE Octet operator*(const Octet& a, double b) { return {a.v * b}; }
POLHODE_INLINE Octet operator*(double a, const Octet& b) { return {a * b.v}; }
POLHODE_INLINE Octet operator+(double a, const Octet& b) { return {a + b.v}; }
POLHODE_INLINE Octet operator-(double a, const Octet& b) { return {a - b.v}; }
POLHODE_INLINE Octet operator/(double a, const Octet& b) { return {a / b.v}; }
POLHODE_INLINE Octet operator-(const Octet& a) { return {-a.v}; }
POLHODE_INLINE void operator+=(Octet& a, const Octet& b) { a.v += b.v; }
POLHODE_INLINE void operator-=(Octet& a, const Octet& b) { a.v -= b.v; }
POLHODE_INLINE void operator*=(Octet& a, const Octet& b) { a.v *= b.v; }

POLHODE_INLINE OctetMask operator<(const Octet& a, const Octet& b) { return {a.v < b.v}; }
POLHODE_INLINE OctetMask operator<=(const Octet& a, const Octet& b) { return {a.v <= b.v}; }
POLHODE_INLINE OctetMask operator>(const Octet& a, const Octet& b) { return {a.v > b.v}; }
POLHODE_INLINE OctetMask operator==(const Octet& a, const Octet& b) { return {a.v == b.v}; }

POLHODE_INLINE Octet select(const OctetMask& mask, const Octet& yes, const Octet& no) {
    return {mask.m ? yes.v : no.v};
}
POLHODE_INLINE bool any(const OctetMask& mask) {
    std::int64_t seen = 0;
    for (int i = 0; i < 8; ++i) seen |= mask.m[i];
    return seen != 0;
}

POLHODE_INLINE Integers8 bits(const Octet& x) {
    Integers8 b{};
    std::memcpy(&b, &x.v, sizeof b);
    return b;
}
POLHODE_INLINE Octet from_bits(const Integers8& b) {
    Octet x;
    std::memcpy(&x.v, &b, sizeof b);
    return x;
}

POLHODE_INLINE Octet magnitude(const Octet& x) { return from_bits(bits(x) & 0x7fff'ffff'ffff'ffff); }
POLHODE_INLINE Octet larger(const Octet& a, const Octet& b) { return select(a > b, a, b); }
POLHODE_INLINE Octet smaller(const Octet& a, const Octet& b) { return select(a < b, a, b); }
POLHODE_INLINE Octet square_root(const Octet& x) {
    Octet r;
    for (int i = 0; i < 8; ++i) r.v[i] = __builtin_sqrt(x.v[i]);
    return r;
}

/// Rounds to the nearest integer, ties to even; |x| < 2^51.
POLHODE_INLINE Octet rounded(const Octet& x) { return (x + 0x1.8p52) - 0x1.8p52; }

/// Returns x where `even` is an even integer, -x where it is odd; |even| < 2^51.
POLHODE_INLINE Octet signed_by_parity(const Octet& x, const Octet& even) {
    return from_bits(bits(x) ^ (bits(even + 0x1.8p52) << 63));
}

/// sin x and cos x, each to within 1.5e-16 for |x| <= largest_angle. Reduction by pi/2 in three parts of 33 bits
/// (Cody & Waite 1980), then the polynomials of fdlibm (Sun Microsystems 1993, k_sin.c and k_cos.c).
inline constexpr double largest_angle = 1e5;
POLHODE_INLINE void sine_cosine(const Octet& x, Octet& sine, Octet& cosine) {
    const Octet k = rounded(x * 0x1.45f306dc9c883p-1);
    const Octet r = ((x - k * 0x1.921fb544p0) - k * 0x1.0b4611a6p-34) - k * 0x1.3198a2e037073p-69;
    // In pairs of terms (Estrin 1960) to shorten the dependency chain.
    const Octet z = r * r, zz = z * z;
    const Octet s_high =
        (2.75573137070700676789e-06 + z * -2.50507602534068634195e-08) + zz * 1.58969099521155010221e-10;
    const Octet s_low = -1.66666666666666324348e-01 + z * 8.33333333332248946124e-03;
    const Octet s = r + (r * z) * (s_low + zz * (-1.98412698298579493134e-04 + z * s_high));
    const Octet p_high =
        (-2.75573143513906633035e-07 + z * 2.08757232129817482790e-09) + zz * -1.13596475577881948265e-11;
    const Octet p_low = 4.16666666666666019037e-02 + z * -1.38888888888741095749e-03;
    const Octet p = zz * (p_low + zz * (2.48015872894767294178e-05 + z * p_high));
    const Octet half = 0.5 * z, w = 1.0 - half;
    const Octet c = w + ((1.0 - w - half) + p);
    // Quadrant k mod 4: bit 0 exchanges the two; bit 1 of k, and of k + 1 for the cosine, gives the sign.
    const Integers8 quadrant = bits(k + 0x1.8p52);
    const OctetMask odd{-(quadrant & 1)};
    const Integers8 sine_sign = (quadrant & 2) << 62, cosine_sign = ((quadrant + 1) & 2) << 62;
    sine = from_bits(bits(select(odd, c, s)) ^ sine_sign);
    cosine = from_bits(bits(select(odd, s, c)) ^ cosine_sign);
}

/// exp x and exp x - 1, each to a relative 4e-16; x is clamped to |x| <= 690. exp x = 2^k exp r, |r| <= ln 2 / 2,
/// with exp r from its Taylor polynomial of degree 13, whose remainder is below 5e-18.
POLHODE_INLINE void exponential(const Octet& argument, Octet& value, Octet& less_one) {
    const Octet x = larger(smaller(argument, octet(690)), octet(-690));
    const Octet k = rounded(x * 0x1.71547652b82fep0);
    const Octet r = (x - k * 0x1.62e42feep-1) - k * 0x1.a39ef35793c76p-33;
    constexpr double inverse_factorial[] = {
        1,           1.0 / 2,      1.0 / 6,       1.0 / 24,       1.0 / 120,       1.0 / 720,       1.0 / 5040,
        1.0 / 40320, 1.0 / 362880, 1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800};
    Octet p = octet(inverse_factorial[12]);
    for (int i = 11; i >= 1; --i) p = p * r + inverse_factorial[i];
    p = r + r * r * p;
    const Octet power = from_bits((bits(k + 0x1.8p52) - bits(octet(0x1.8p52)) + 1023) << 52);
    value = power + power * p;
    less_one = (power - 1.0) + power * p;
}

POLHODE_INLINE Octet exponential(const Octet& x) {
    Octet value, less_one;
    exponential(x, value, less_one);
    return value;
}

}  // namespace polhode
