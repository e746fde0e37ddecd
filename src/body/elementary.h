// Elementary functions for every scalar in which closed forms are evaluated: binary64, 128 bits (by the C library)
// and number types with functions in their own namespace (multiprecision). Balls define their own.
#pragma once

#include <cmath>
#include <concepts>
#include <limits>
#include <numbers>

#include "body/algebra.h"
#include "body/wide.h"

/// @cond declarations of the C library
#ifdef __clang__
// the C library provides these for every compiler but declares them only for GCC
extern "C" {
polhode::Wide expf128(polhode::Wide);
polhode::Wide expm1f128(polhode::Wide);
polhode::Wide sinf128(polhode::Wide);
polhode::Wide cosf128(polhode::Wide);
polhode::Wide roundf128(polhode::Wide);
polhode::Wide cbrtf128(polhode::Wide);
}
#endif
/// @endcond

namespace polhode {

/// The square root in any scalar. The 128-bit version is in body/wide.h.
template <class S>
S square_root(const S& x) {
    using std::sqrt;
    return sqrt(x);
}

/// |v|.
template <class S>
S length(const Vector3<S>& v) {
    return square_root(dot(v, v));
}
/// |v| without overflow or underflow of its square.
template <class S>
S hypotenuse(const Vector3<S>& v) {
    return std::hypot(v[0], v[1], v[2]);
}

/// Elementary functions and constants of a scalar whose library defines them in its own namespace.
template <class S>
struct Elementary {
    /// The ratio of a circle's circumference to its diameter.
    static S pi() {
        static thread_local const S value = acos(S(-1));
        return value;
    }
    // Not std::numeric_limits<S>: Boost 1.74 keeps its values in statics that the first call fills without a lock (if
    // there are no expression templates), so that a second thread may read a half-written value.
    /// The distance from 1 to the next number above it.
    static S epsilon() { return ldexp(S(1), 1 - std::numeric_limits<S>::digits); }
    /// Positive infinity.
    static S infinity() { return S(std::numeric_limits<double>::infinity()); }
    /// e^x.
    static S exponential(const S& x) { return exp(x); }
    /// e^x - 1, without cancellation near x = 0.
    static S exponential_less_one(const S& x) { return expm1(x); }
    /// The sine and the cosine of an angle in rad.
    static void sine_cosine(const S& x, S& sine, S& cosine) { sine = sin(x), cosine = cos(x); }
    /// |x|.
    static S magnitude(const S& x) { return abs(x); }
    /// The nearest integer.
    static S rounded(const S& x) { return round(x); }
    /// The real cube root.
    static S cube_root(const S& x) { return cbrt(x); }
};

/// The sine and the cosine of an angle in rad, in any scalar with a specialisation of Elementary.
template <class S>
void sine_cosine(const S& x, S& sine, S& cosine) {
    Elementary<S>::sine_cosine(x, sine, cosine);
}

/// @cond specialisations

template <std::floating_point F>
struct Elementary<F> {
    static constexpr F pi() { return std::numbers::pi_v<F>; }
    static constexpr F epsilon() { return std::numeric_limits<F>::epsilon(); }
    static constexpr F infinity() { return std::numeric_limits<F>::infinity(); }
    static F exponential(F x) { return std::exp(x); }
    static F exponential_less_one(F x) { return std::expm1(x); }
    static void sine_cosine(F x, F& sine, F& cosine) { sine = std::sin(x), cosine = std::cos(x); }
    static F magnitude(F x) { return std::abs(x); }
    static F rounded(F x) { return std::nearbyint(x); }
    static F cube_root(F x) { return std::cbrt(x); }
};

template <>
struct Elementary<Wide> {
    static Wide pi() { return Wide(std::numbers::pi) + Wide(0x1.1a62633145c07p-53) - Wide(0x1.f1976b7ed8fbcp-109); }
    static constexpr Wide epsilon() { return Wide(0x1p-112); }
    static Wide infinity() { return Wide(std::numeric_limits<double>::infinity()); }
    static Wide exponential(const Wide& x) { return expf128(x); }
    static Wide exponential_less_one(const Wide& x) { return expm1f128(x); }
    static void sine_cosine(const Wide& x, Wide& sine, Wide& cosine) { sine = sinf128(x), cosine = cosf128(x); }
    static Wide magnitude(const Wide& x) { return x < 0 ? -x : x; }
    static Wide rounded(const Wide& x) { return roundf128(x); }
    static Wide cube_root(const Wide& x) { return cbrtf128(x); }
};
/// @endcond

}  // namespace polhode
