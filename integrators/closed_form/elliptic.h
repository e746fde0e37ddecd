// Elliptic integrals and Jacobi's theta functions over any scalar, for the closed forms of a free body and of
// Lagrange's top.
//
// The parameter m = k^2 is given with its complement m1 = 1 - m, each as accurately as the caller knows it, so that
// no digits are lost close to a separatrix (m1 -> 0). Theta series use the nome of the better of two lattices:
// trigonometric in q = exp(-pi K'/K) for m <= m1, otherwise hyperbolic in q' = exp(-pi K/K') (Jacobi's imaginary
// transformation). The nome is then at most exp(-pi) and five terms suffice for binary64. m = 0 and m1 = 0 need no
// special treatment.
//
// Lattice holds the periods and theta constants, Harmonics the sines and cosines of an argument u, ShiftedTheta a
// theta function with a complex shift.
#pragma once

#include <algorithm>
#include <array>
#include <type_traits>

#include "body/elementary.h"

namespace polhode {

/// Arithmetic-geometric mean of a, b >= 0 (Gauss).
template <class S>
S arithmetic_geometric_mean(S a, S b) {
    if (!(a > 0) || !(b > 0)) return S(0);
    // Convergence is quadratic: once the gap is below sqrt(epsilon), one more mean is exact.
    const S enough = square_root(Elementary<S>::epsilon());
    for (;;) {
        S mean = (a + b) / S(2);
        const S gap = Elementary<S>::magnitude(S(a - b));
        if (gap <= enough * mean) return mean;
        b = square_root(S(a * b));
        a = mean;
    }
}

/// Carlson's R_F(x, y, z) = 1/2 int_0^inf dt / sqrt((t+x)(t+y)(t+z)), arguments >= 0, at most one of them zero. Uses
/// duplication, then the series to the seventh order (B. C. Carlson 1995, Numer. Algorithms 10, 13; DLMF 19.36.1).
template <class S>
S carlson_rf(S x, S y, S z) {
    const S third = S(1) / S(3);
    S mean = (x + y + z) * third;
    // The remainder of the series is of eighth order: epsilon^(1/8).
    const S reach = square_root(square_root(square_root(Elementary<S>::epsilon())));
    for (;;) {
        const S spread = std::max({Elementary<S>::magnitude(S(mean - x)), Elementary<S>::magnitude(S(mean - y)),
                                   Elementary<S>::magnitude(S(mean - z))});
        if (spread <= reach * mean) break;
        const S rx = square_root(x), ry = square_root(y), rz = square_root(z);
        const S lambda = rx * ry + ry * rz + rz * rx;
        x = (x + lambda) / S(4), y = (y + lambda) / S(4), z = (z + lambda) / S(4);
        mean = (mean + lambda) / S(4);
    }
    const S inverse = S(1) / mean;
    const S X = (mean - x) * inverse, Y = (mean - y) * inverse, Z = -X - Y;
    const S e2 = X * Y - Z * Z, e3 = X * Y * Z;
    const S series = S(1) + e2 * (-S(1) / S(10) + e2 / S(24) - e2 * e2 * S(5) / S(208) - e3 * S(3) / S(44)) +
                     e3 * (S(1) / S(14) + e3 * S(3) / S(104) + e2 * e2 / S(16));
    return series / square_root(mean);
}

/// Incomplete integral of the first kind at the amplitude with sn, cn >= 0, dn (any parameter): F = sn R_F(cn^2,
/// dn^2, 1). Infinite where cn = dn = 0.
template <class S>
S inverse_jacobi(const S& sn, const S& cn_squared, const S& dn_squared) {
    if (!(cn_squared > 0) && !(dn_squared > 0))
        return sn < 0 ? S(-Elementary<S>::infinity()) : Elementary<S>::infinity();
    return sn * carlson_rf(cn_squared, dn_squared, S(1));
}

/// The Jacobi elliptic functions sn, cn and dn.
template <class S>
struct Jacobi {
    S sn, cn, dn;
};

/// A complex number.
template <class S>
struct Complex {
    S re{0}, im{0};
};
template <class To, class From>
Complex<To> cast(const Complex<From>& z) {
    return {To(z.re), To(z.im)};
}
template <class S>
Complex<S> operator*(const Complex<S>& a, const Complex<S>& b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
template <class S>
Complex<S> conjugate(const Complex<S>& a) {
    return {a.re, -a.im};
}

/// Number of terms in the theta sums, which decrease as q^(n(n-1)) with a nome q <= exp(-pi): for binary64, for 113
/// bits and for 180 digits.
template <class S>
constexpr int most_theta_terms = std::is_same_v<S, double> ? 4
                                 : std::is_same_v<S, Wide> ? 6
                                                           : 12;
template <class S>
using ThetaTerms = std::array<S, most_theta_terms<S> + 1>;
template <class To, class From>
ThetaTerms<To> rounded(const ThetaTerms<From>& terms) {
    ThetaTerms<To> result{};
    for (std::size_t n = 0; n < std::min(result.size(), terms.size()); ++n) result[n] = To(terms[n]);
    return result;
}

/// Trigonometric lattice: sin kz and cos kz for k = 0 .. 2N+1. Hyperbolic lattice: q^(n(n+1)) times sinh and cosh of
/// (2n+1) v and q^(n^2) times those of 2n v, all divided by exp |v| to avoid overflow.
template <class S>
struct Harmonics {
    ThetaTerms<S> odd_sine, odd_cosine, even_sine, even_cosine;
};

/// Periods and theta constants for one parameter.
template <class S>
class Lattice {
  public:
    /// Requires m, m1 >= 0 and m + m1 = 1, each accurate relative to itself.
    Lattice(const S& m, const S& m1) : trigonometric(m <= m1) {
        const S half_pi = Elementary<S>::pi() / S(2);
        quarter = m1 > 0 ? S(half_pi / arithmetic_geometric_mean(S(1), square_root(m1))) : Elementary<S>::infinity();
        imaginary_quarter =
            m > 0 ? S(half_pi / arithmetic_geometric_mean(S(1), square_root(m))) : Elementary<S>::infinity();
        const S& near = trigonometric ? quarter : imaginary_quarter;
        const S& far = trigonometric ? imaginary_quarter : quarter;
        scale = half_pi / near;
        log_nome = -Elementary<S>::pi() * (far / near);
        nome = Elementary<S>::exponential(log_nome);
        squares[0] = pronics[0] = S(1);
        S power = S(1);
        for (terms = 0; terms < most_theta_terms<S>; ++terms) {
            // Bound of term n = terms + 1: q^(n^2), or q^(n(n-1)) at the edge |u| = K of the hyperbolic lattice.
            const S next = squares[terms] * power * nome * power;
            if (!((trigonometric ? next : pronics[terms]) > Elementary<S>::epsilon())) break;
            power *= nome;
            squares[terms + 1] = next;
            pronics[terms + 1] = next * power;
        }
        for (int n = 0; n <= terms; ++n) {
            odd_weight[n] = trigonometric ? pronics[n] : S(1);
            even_weight[n] = n == 0 ? S(1) : trigonometric ? S(squares[n] + squares[n]) : S(2);
        }
        S theta2 = S(1), theta3 = S(1), theta4 = S(1);
        for (int n = 1; n <= terms; ++n) {
            theta2 += pronics[n];
            theta3 += squares[n] + squares[n];
            theta4 += n % 2 ? S(-(squares[n] + squares[n])) : S(squares[n] + squares[n]);
        }
        // DLMF 22.2.4-6; with 20.7.30-33 in the hyperbolic lattice.
        sn_factor = trigonometric ? S(theta3 / theta2) : S(theta3 / theta4);
        cn_factor = trigonometric ? S(theta4 / theta2) : S(theta2 / theta4);
        dn_factor = trigonometric ? S(theta4 / theta3) : S(theta2 / theta3);
    }

    /// Rounds a lattice from higher precision, for evaluation in lower precision.
    template <class From>
    explicit Lattice(const Lattice<From>& b)
        : trigonometric(b.trigonometric),
          quarter(S(b.quarter)),
          imaginary_quarter(S(b.imaginary_quarter)),
          scale(S(b.scale)),
          nome(S(b.nome)),
          log_nome(S(b.log_nome)),
          terms(std::min(b.terms, most_theta_terms<S>)),
          squares(rounded<S, From>(b.squares)),
          pronics(rounded<S, From>(b.pronics)),
          odd_weight(rounded<S, From>(b.odd_weight)),
          even_weight(rounded<S, From>(b.even_weight)),
          sn_factor(S(b.sn_factor)),
          cn_factor(S(b.cn_factor)),
          dn_factor(S(b.dn_factor)) {}

    bool trigonometric;
    S quarter, imaginary_quarter;  ///< K, K'
    S scale;                       ///< pi/2K or pi/2K'; multiplies the argument u
    S nome, log_nome;
    int terms;                                  ///< N: sums run over n = 0 .. N
    ThetaTerms<S> squares{}, pronics{};         ///< q^(n^2), q^(n(n+1))
    ThetaTerms<S> odd_weight{}, even_weight{};  ///< weights of the harmonics in the theta series
    S sn_factor, cn_factor, dn_factor;

    /// Reduces u = rest + 2 K j to |rest| <= K and returns j. On the separatrix j = 0.
    S reduce(S& u) const {
        if (!(quarter < Elementary<S>::infinity())) return S(0);
        const S period = quarter + quarter;
        S j = Elementary<S>::rounded(S(u / period));
        u -= j * period;
        return j;
    }

    /// Harmonics of u, |u| <= K. Computes the even sines only with `sines_too`.
    template <bool sines_too>
    void harmonics(const S& u, Harmonics<S>& h) const {
        const S z = scale * u;
        if (trigonometric)
            circular<sines_too>(z, h);
        else
            hyperbolic<sines_too>(z, h);
    }

    /// theta_4 on the real line, up to a factor common to all these sums. It is the denominator of sn, cn and dn.
    S denominator(const Harmonics<S>& h) const { return trigonometric ? alternating_even(h) : plain_odd(h); }

    /// Derivative of denominator() with respect to scale * u. The harmonics must include the even sines.
    S denominator_slope(const Harmonics<S>& h) const {
        S sum = trigonometric ? S(0) : h.odd_sine[0];
        for (int n = 1; n <= terms; ++n) {
            if (!trigonometric)
                sum += S(2 * n + 1) * odd_weight[n] * h.odd_sine[n];
            else
                sum += S(n % 2 ? 2 * n : -2 * n) * even_weight[n] * h.even_sine[n];
        }
        return sum;
    }

    Jacobi<S> jacobi(const Harmonics<S>& h) const {
        S alternating_odd = h.odd_sine[0], odd = h.odd_cosine[0], alternating = h.even_cosine[0], even = alternating;
        for (int n = 1; n <= terms; ++n) {
            const S a = odd_weight[n] * h.odd_sine[n], b = even_weight[n] * h.even_cosine[n];
            alternating_odd += n % 2 ? S(-a) : a;
            odd += odd_weight[n] * h.odd_cosine[n];
            alternating += n % 2 ? S(-b) : b;
            even += b;
        }
        const S inverse = S(1) / (trigonometric ? alternating : odd);
        return {sn_factor * alternating_odd * inverse, cn_factor * (trigonometric ? odd : alternating) * inverse,
                dn_factor * even * inverse};
    }

  private:
    S alternating_even(const Harmonics<S>& h) const {
        S sum = h.even_cosine[0];
        for (int n = 1; n <= terms; ++n) {
            const S term = even_weight[n] * h.even_cosine[n];
            sum += n % 2 ? S(-term) : term;
        }
        return sum;
    }
    S plain_odd(const Harmonics<S>& h) const {
        S sum = h.odd_cosine[0];
        for (int n = 1; n <= terms; ++n) sum += odd_weight[n] * h.odd_cosine[n];
        return sum;
    }

    template <bool sines_too>
    void circular(const S& z, Harmonics<S>& h) const {
        S s, c;
        Elementary<S>::sine_cosine(z, s, c);
        h.odd_sine[0] = s, h.odd_cosine[0] = c;
        h.even_sine[0] = S(0), h.even_cosine[0] = S(1);
        const S s2 = s * c + s * c, c2 = c * c - s * s;
        for (int n = 0; n < terms; ++n) {
            h.odd_sine[n + 1] = h.odd_sine[n] * c2 + h.odd_cosine[n] * s2;
            h.odd_cosine[n + 1] = h.odd_cosine[n] * c2 - h.odd_sine[n] * s2;
            h.even_cosine[n + 1] = n == 0 ? c2 : S((c2 + c2) * h.even_cosine[n] - h.even_cosine[n - 1]);
            if constexpr (sines_too)
                h.even_sine[n + 1] = n == 0 ? s2 : S((c2 + c2) * h.even_sine[n] - h.even_sine[n - 1]);
        }
    }

    // With a = |v|: q^(n(n+1)) exp(+-(2n+1)a) exp(-a) = q^(n^2) (q exp(+-2a))^n, the lower sign times exp(-2a), and
    // q^(n^2) exp(+-2na) exp(-a) = q^(n(n-1)) (q exp(+-2a))^n exp(-a).
    template <bool sines_too>
    void hyperbolic(const S& v, Harmonics<S>& h) const {
        const S a = Elementary<S>::magnitude(v), half = S(1) / S(2), sign = v < 0 ? S(-half) : half;
        const S unit = Elementary<S>::exponential(S(-a)), unit_squared = unit * unit;
        const S grown = Elementary<S>::exponential(S(log_nome + (a + a))), shrunk = nome * unit_squared;
        S up = S(1), down = S(1);
        for (int n = 0; n <= terms; ++n) {
            const S low = down * unit_squared, even = n == 0 ? unit : S(unit * pronics[n - 1]);
            h.odd_sine[n] = sign * squares[n] * (up - low);
            h.odd_cosine[n] = half * squares[n] * (up + low);
            h.even_cosine[n] = half * even * (up + down);
            if constexpr (sines_too) h.even_sine[n] = sign * even * (up - down);
            up *= grown;
            down *= shrunk;
        }
    }
};

/// theta_1(u - i eta) or theta_2(u - i eta) along the real line, up to a constant positive factor, 0 <= eta <= K'. In
/// the hyperbolic lattice the Gaussian factor of the transformation leaves a phase linear in u: the function is exp(i
/// drift u) times sum(). Both functions change sign when u increases by 2K.
template <class S>
class ShiftedTheta {
  public:
    enum class Kind { theta1, theta2 };

    ShiftedTheta(const Lattice<S>& lattice, Kind kind, const S& eta) : kind_(kind), terms_(lattice.terms) {
        using E = Elementary<S>;
        const S shift = eta * lattice.scale;
        hyperbolic_ = !lattice.trigonometric;
        if (lattice.trigonometric) {
            // sinh and cosh of (2n+1) y over exp(y)/2: 1 -+ exp(-2(2n+1) y), times q^(n(n+1)) exp(2ny).
            const bool finite = shift < E::infinity();
            const S twice = shift + shift;
            const S step = finite ? E::exponential(S(-twice)) : S(0), step_squared = step * step;
            S decay = step, growth = S(1);
            // q exp(2y) <= 1 since eta <= K'. Taking its powers first avoids overflow.
            const S bounded = finite ? E::exponential(S(lattice.log_nome + twice)) : S(0);
            for (int n = 0; n <= terms_; ++n) {
                const S weight = signed_by(n, S(lattice.squares[n] * growth));
                even_[n] = weight * (S(1) + decay);
                odd_[n] = weight * (n == 0 && finite ? S(-E::exponential_less_one(S(-twice))) : S(S(1) - decay));
                decay *= step_squared;
                growth *= bounded;
            }
            drift = S(0);
        } else {
            S s, c;
            E::sine_cosine(shift, s, c);
            const S s2 = s * c + s * c, c2 = c * c - s * s;
            const bool first = kind == Kind::theta1;
            // (2n+1) w for theta_1; 2n w for theta_2, which transforms to a theta_4.
            S sine = first ? s : S(0), cosine = first ? c : S(1);
            for (int n = 0; n <= terms_; ++n) {
                const S weight = n % 2 ? S(-1) : S(1);
                const S size = first ? lattice.odd_weight[n] : lattice.even_weight[n];
                even_[n] = weight * size * cosine;
                odd_[n] = weight * size * sine;
                const S next = sine * c2 + cosine * s2;
                cosine = cosine * c2 - sine * s2;
                sine = next;
            }
            drift = lattice.quarter < E::infinity() ? S(shift / lattice.quarter) : S(0);
        }
        width = shift;
    }

    template <class From>
    explicit ShiftedTheta(const ShiftedTheta<From>& b)
        : drift(S(b.drift)),
          width(S(b.width)),
          kind_(b.kind_ == ShiftedTheta<From>::Kind::theta1 ? Kind::theta1 : Kind::theta2),
          hyperbolic_(b.hyperbolic_),
          terms_(std::min(b.terms_, most_theta_terms<S>)),
          even_(rounded<S, From>(b.even_)),
          odd_(rounded<S, From>(b.odd_)) {}

    S drift;  ///< rad per unit of u
    S width;  ///< pi eta / 2K or pi eta / 2K'

    /// Evaluates the sum. theta_2 in the hyperbolic lattice needs harmonics with even sines.
    Complex<S> sum(const Harmonics<S>& h) const {
        Complex<S> total;
        for (int n = 0; n <= terms_; ++n) {
            if (kind_ == Kind::theta1) {
                total.re += even_[n] * h.odd_sine[n];
                total.im -= odd_[n] * h.odd_cosine[n];
            } else if (hyperbolic_) {
                total.re += even_[n] * h.even_cosine[n];
                total.im -= odd_[n] * h.even_sine[n];
            } else {
                total.re += even_[n] * h.odd_cosine[n];
                total.im += odd_[n] * h.odd_sine[n];
            }
        }
        return total;
    }

    /// Derivative of sum() with respect to scale * u.
    Complex<S> derivative(const Harmonics<S>& h) const {
        Complex<S> total;
        for (int n = 0; n <= terms_; ++n) {
            const S k(2 * n + 1), even_k(2 * n);
            if (kind_ == Kind::theta1) {
                total.re += k * even_[n] * h.odd_cosine[n];
                total.im -= k * odd_[n] * (hyperbolic_ ? h.odd_sine[n] : S(-h.odd_sine[n]));
            } else if (hyperbolic_) {
                total.re += even_k * even_[n] * h.even_sine[n];
                total.im -= even_k * odd_[n] * h.even_cosine[n];
            } else {
                total.re -= k * even_[n] * h.odd_sine[n];
                total.im += k * odd_[n] * h.odd_cosine[n];
            }
        }
        return total;
    }

  private:
    template <class>
    friend class ShiftedTheta;
    Kind kind_;
    bool hyperbolic_ = false;
    int terms_;
    ThetaTerms<S> even_{}, odd_{};  // signs included

    S signed_by(int n, const S& x) const { return kind_ == Kind::theta1 && n % 2 ? S(-x) : x; }
};

}  // namespace polhode
