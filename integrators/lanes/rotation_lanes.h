// Right-hand side of rotations in one register of eight lanes, y = (w1, w2, w3, q_w, q_x, q_y, q_z, 0), as sums of
// products of permuted copies of y:
//
//   dw1/dt = (I2 - I3)/I1 w2 w3 + tau1/I1 and cyclic,   dq/dt = 1/2 q (0, w)
//
// with tau = tau_0 - D w + quadratic forms in q: fields about a pivot, torques constant in the world, springs.
//
// Everything is inlined into functions compiled for one instruction set, see lanes.h.
#pragma once

#include <optional>
#include <type_traits>
#include <utility>

#include "integrators/lanes/lanes.h"
#include "motion/equations.h"

namespace polhode {

/// Supported torque terms. Fewer terms need fewer products.
enum class RotationTerms {
    none,
    axial_field,  ///< field along the world z axis acting on a moment along the third axis, as in Lagrange's top
    quadratic,    ///< any tau_0, - D w and quadratic forms in q
};

/// Coefficients of the right-hand side, eight lanes per row.
struct RotationCoefficients {
    RotationTerms terms = RotationTerms::none;
    alignas(64) double product[3][8] = {};  ///< factors of the three products of every rotation
    alignas(64) double response[8] = {};    ///< inverse moments, then ones
    alignas(64) double constant[8] = {};    ///< tau_0
    alignas(64) double damping[3][8] = {};  ///< -D, by columns
    alignas(
        64) double monomial[10][8] = {};  ///< of wx, wy, wz, xy, xz, yz, ww, xx, yy, zz in q: the torque's coefficients
};

/// Returns nullopt if a torque has another form: user-defined, or dependent on the position.
std::optional<RotationCoefficients> rotation_coefficients(const PrincipalInertia<double>& inertia,
                                                          const Forcing<double>* forcing);

/// State of a rotation: y + lost, where `lost` is the rounding error of the last addition.
struct RotationState {
    alignas(64) double y[8] = {}, lost[8] = {};
};

/// Result of a step. Squared errors are sums over the components, in units of the allowed error of each.
struct RotationStep {
    RotationState state;
    double squared_error = 0;
    double squared_error_before = 0;  ///< of lower order in the step
};

/// Allowed error of each component; positive, also in the unused lane.
struct RotationAllowance {
    alignas(64) double squared_scale[8] = {};
    double rounding = 0;  ///< additional allowance per unit of increment, times the amplification if any
};

/// Eight lanes in two narrower registers.
struct LaneHalves {
    Lanes4 low, high;

    POLHODE_INLINE friend LaneHalves operator+(const LaneHalves& a, const LaneHalves& b) {
        return {a.low + b.low, a.high + b.high};
    }
    POLHODE_INLINE friend LaneHalves operator-(const LaneHalves& a, const LaneHalves& b) {
        return {a.low - b.low, a.high - b.high};
    }
    POLHODE_INLINE friend LaneHalves operator*(const LaneHalves& a, const LaneHalves& b) {
        return {a.low * b.low, a.high * b.high};
    }
    POLHODE_INLINE friend LaneHalves operator/(const LaneHalves& a, const LaneHalves& b) {
        return {a.low / b.low, a.high / b.high};
    }
};

template <class Register>
POLHODE_INLINE Register loaded(const double* values) {
    if constexpr (sizeof(Register) == sizeof(Lanes8) && !requires(Register r) { r.low; }) {
        return *reinterpret_cast<const Lanes8*>(values);
    } else {
        return {*reinterpret_cast<const Lanes4*>(values), *reinterpret_cast<const Lanes4*>(values + 4)};
    }
}
POLHODE_INLINE void store(double* values, const Lanes8& r) { *reinterpret_cast<Lanes8*>(values) = r; }
POLHODE_INLINE void store(double* values, const LaneHalves& r) {
    *reinterpret_cast<Lanes4*>(values) = r.low;
    *reinterpret_cast<Lanes4*>(values + 4) = r.high;
}
/// x in every lane.
template <class Register>
POLHODE_INLINE Register broadcast(double x) {
    if constexpr (requires(Register r) { r.low; }) {
        return {Lanes4{x, x, x, x}, Lanes4{x, x, x, x}};
    } else {
        return Lanes8{x, x, x, x, x, x, x, x};
    }
}
/// Lane k of the result is lane i_k of r.
template <int i0, int i1, int i2, int i3, int i4, int i5, int i6, int i7>
POLHODE_INLINE Lanes8 permuted(const Lanes8& r) {
    return __builtin_shufflevector(r, r, i0, i1, i2, i3, i4, i5, i6, i7);
}
template <int i0, int i1, int i2, int i3, int i4, int i5, int i6, int i7>
POLHODE_INLINE LaneHalves permuted(const LaneHalves& r) {
    return {__builtin_shufflevector(r.low, r.high, i0, i1, i2, i3),
            __builtin_shufflevector(r.low, r.high, i4, i5, i6, i7)};
}
template <int i, class Register>
POLHODE_INLINE Register lane(const Register& r) {
    return permuted<i, i, i, i, i, i, i, i>(r);
}

/// dy/dt, with its coefficients in registers.
template <RotationTerms terms, class Register>
class RotationRate {
  public:
    POLHODE_INLINE explicit RotationRate(const RotationCoefficients& c)
        : coefficients_(c),
          first_(loaded<Register>(c.product[0])),
          second_(loaded<Register>(c.product[1])),
          third_(loaded<Register>(c.product[2])),
          response_(loaded<Register>(c.response)) {}

    // Lanes 0..2: gyroscopic terms, w2 w3 and cyclic; in an axial field m also -2m (yz + wx) and 2m (xz - wy). Lanes
    // 3..6: 1/2 times (-x w1 - y w2 - z w3,  w w1 + y w3 - z w2,  w w2 + z w1 - x w3,  w w3 + x w2 - y w1).
    POLHODE_INLINE Register operator()(const Register& y) const {
        const Register a = first_ * (permuted<1, 2, 0, 4, 3, 3, 3, 7>(y) * permuted<2, 0, 1, 0, 0, 1, 2, 7>(y));
        const Register b = second_ * (permuted<5, 4, 7, 5, 5, 6, 4, 7>(y) * permuted<6, 6, 7, 1, 2, 0, 1, 7>(y));
        const Register c = third_ * (permuted<3, 3, 7, 6, 6, 4, 5, 7>(y) * permuted<4, 5, 7, 2, 1, 2, 0, 7>(y));
        if constexpr (terms == RotationTerms::axial_field) {
            return a + response_ * (b + c);
        } else if constexpr (terms == RotationTerms::none) {
            return (a + b) + c;
        } else {
            return ((a + b) + c) + response_ * torque(y);
        }
    }

  private:
    POLHODE_INLINE Register torque(const Register& y) const {
        const Register u = permuted<3, 3, 3, 4, 4, 5, 3, 4>(y) * permuted<4, 5, 6, 5, 6, 6, 3, 4>(y);
        const Register v = permuted<5, 6, 7, 7, 7, 7, 7, 7>(y) * permuted<5, 6, 7, 7, 7, 7, 7, 7>(y);
        const Register mixed = (monomial<0>(u, 0) + monomial<1>(u, 1)) + (monomial<2>(u, 2) + monomial<3>(u, 3)) +
                               (monomial<4>(u, 4) + monomial<5>(u, 5));
        const Register squares = (monomial<6>(u, 6) + monomial<7>(u, 7)) + (monomial<0>(v, 8) + monomial<1>(v, 9));
        const Register rest =
            (loaded<Register>(coefficients_.constant) + damping<0>(y)) + (damping<1>(y) + damping<2>(y));
        return (mixed + squares) + rest;
    }
    template <int i>
    POLHODE_INLINE Register damping(const Register& y) const {
        return loaded<Register>(coefficients_.damping[i]) * lane<i>(y);
    }
    template <int i>
    POLHODE_INLINE Register monomial(const Register& products, int k) const {
        return loaded<Register>(coefficients_.monomial[k]) * lane<i>(products);
    }

    const RotationCoefficients& coefficients_;
    Register first_, second_, third_, response_;
};

/// Calls f(integral_constant 0), f(1), .. f(count - 1).
template <class F, int... i>
POLHODE_INLINE void unrolled(std::integer_sequence<int, i...>, const F& f) {
    (f(std::integral_constant<int, i>()), ...);
}
template <int count, class F>
POLHODE_INLINE void unrolled(const F& f) {
    unrolled(std::make_integer_sequence<int, count>(), f);
}

/// Sum of all lanes, in an order that is the same for every instruction set.
template <class Register>
POLHODE_INLINE double sum_of(const Register& values) {
    const Register pairs = values + permuted<1, 0, 3, 2, 5, 4, 7, 6>(values);
    const Register fours = pairs + permuted<2, 3, 0, 1, 6, 7, 4, 5>(pairs);
    alignas(64) double sums[8];
    store(sums, fours);
    return sums[0] + sums[4];
}

/// Sum of (error_i / allowed_i)^2, allowed_i^2 = scale_i^2 + (rounding z_i)^2. NaN if an error is NaN.
template <class Register>
POLHODE_INLINE double squared_norm(const Register& error, const Register& allowed) {
    return sum_of((error * error) / allowed);
}

/// Rounding error of sum = a + b (Knuth's TwoSum).
template <class Register>
POLHODE_INLINE Register rounded_away(const Register& a, const Register& b, const Register& sum) {
    const Register part = sum - a;
    return (a - (sum - part)) + (b - part);
}

}  // namespace polhode
