// Scalars of the reference solution: multiprecision numbers of static size (no allocation, thread-safe) and a few raw
// operations whose cost matters. This header compiles slowly: only the .cpp files of the reference solution include
// it.
#pragma once

#include <boost/multiprecision/mpfr.hpp>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <string>

#include "motion/trajectory.h"

namespace polhode {

/// A number of `digits` decimal digits.
template <unsigned digits>
using Real = boost::multiprecision::number<
    boost::multiprecision::mpfr_float_backend<digits, boost::multiprecision::allocate_stack>,
    boost::multiprecision::et_off>;

/// The MPFR number inside.
template <unsigned digits>
mpfr_ptr raw(Real<digits>& x) {
    return x.backend().data();
}
template <unsigned digits>
mpfr_srcptr raw(const Real<digits>& x) {
    return x.backend().data();
}

/// sum += a b in place; `scratch` is overwritten.
template <unsigned digits>
void add_product(Real<digits>& sum, const Real<digits>& a, const Real<digits>& b, Real<digits>& scratch) {
    mpfr_mul(raw(scratch), raw(a), raw(b), MPFR_RNDN);
    mpfr_add(raw(sum), raw(sum), raw(scratch), MPFR_RNDN);
}
template <std::floating_point T>
void add_product(T& sum, const T& a, const T& b, T&) {
    sum += a * b;
}

/// x /= n in place.
template <unsigned digits>
void divide(Real<digits>& x, unsigned long n) {
    mpfr_div_ui(raw(x), raw(x), n, MPFR_RNDN);
}
template <std::floating_point T>
void divide(T& x, unsigned long n) {
    x /= static_cast<T>(n);
}

/// log2 |x| in double precision, for any exponent; -infinity for zero.
template <unsigned digits>
double log2_magnitude(const Real<digits>& x) {
    if (x == 0) return -std::numeric_limits<double>::infinity();
    long exponent = 0;
    const double mantissa = mpfr_get_d_2exp(&exponent, raw(x), MPFR_RNDN);
    return std::log2(std::abs(mantissa)) + static_cast<double>(exponent);
}
inline double log2_magnitude(double x) { return std::log2(std::abs(x)); }

template <unsigned digits>
bool is_finite(const Real<digits>& x) {
    return mpfr_number_p(raw(x)) != 0;
}

/// High and low part, about 106 bits together.
template <unsigned digits>
Pair pair_of(const Real<digits>& x) {
    const double high = x.template convert_to<double>();
    const Real<digits> rest = x - high;
    return {high, rest.template convert_to<double>()};
}

/// x in scientific notation with `significant` digits.
template <unsigned digits>
std::string decimal_of(const Real<digits>& x, int significant) {
    return x == 0 ? "0" : x.str(significant - 1, std::ios_base::scientific);
}

}  // namespace polhode
