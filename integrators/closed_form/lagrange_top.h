// Lagrange's top in closed form over any scalar: two equal moments, and a torque e3 x R(q)^T G of a world-fixed force
// field that acts on the symmetry axis e3 (gravity with a pivot on the axis, or any forces that sum to this). It is
// evaluated at any t directly.
//
// With z = -G/|G| ("up"), u = z . R e3 = cos(theta), a = I3 w3/I1, b = L.z/I1, beta = 2 |G|/I1 (Lagrange 1788; Klein
// & Sommerfeld 1897):
//
//   du/dt^2 = beta (u - u1)(u - u2)(u - u3),   u = u1 + (u2 - u1) sn^2 v,   v = lambda t + v0
//   lambda^2 = beta (u3 - u1)/4,   m = (u2 - u1)/(u3 - u1)
//
// The Cayley-Klein parameters of the attitude, q = x+ (1, k) + x- (i, j), are quotients of theta functions and have
// none of the poles of Euler angles:
//
//   x+ = cos(theta/2) exp(i (phi+psi)/2) ~ exp(i A+ t) theta_1(v - i eta+) / theta_4(v)
//   x- = sin(theta/2) exp(i (phi-psi)/2) ~ exp(i A- t) theta_2(v - i eta-) / theta_4(v)
//   sn^2(eta+|1-m) = (1+u1)/(1+u2),   sn^2(eta-|1-m) = (1-u2)(u3-u1)/((1-u1)(u3-u2))
//
// eta+ and eta- and the senses of rotation have the signs of a + b and b - a. The roots are computed relative to u at
// t = 0, u = u(0) + s, because the coefficients of the cubic in s are free of cancellation: a regular precession (u1
// = u2) costs no digits. LagrangeStart computes the constants from the initial state, LagrangeTop evaluates the
// motion.
#pragma once

#include "integrators/closed_form/free_body.h"

namespace polhode {

/// sn and the squares of cn and dn, of an argument to be determined.
template <class S>
struct JacobiSquares {
    S sn{0}, cn_squared{1}, dn_squared{1};

    S argument() const { return inverse_jacobi(sn, cn_squared, dn_squared); }
};

/// Constants of the closed form, computed from the initial state, in axes with e3 last.
///
/// Close to the sleeping top the upper roots of the cubic nearly coincide, and binary64 coefficients would lose half
/// of their digits. Computed in 113 bits and then rounded, they lose no more than the motion itself does.
template <class S>
struct LagrangeStart {
    int axis = 2;
    S w1, w2, w3, g1, g2, u;  ///< w; z in body axes, g3 = u
    S four_lambda_squared, m, m1;
    S from_bottom, from_top;                      ///< 1 + u2, 1 - u1
    S plus, minus;                                ///< a + b, b - a
    S relative_spin;                              ///< w3 - a = (1 - I3/I1) w3
    JacobiSquares<S> phase, eta_plus, eta_minus;  ///< v at t = 0; eta, of the complementary parameter

    LagrangeStart(int axis_, const S& I1, const S& I3, const Vector3<S>& field_W, const Vector3<S>& w,
                  const Quaternion<S>& q)
        : axis(axis_) {
        const S G = square_root(dot(field_W, field_W));
        const S scale = S(-1) / (G * squared_norm(q));
        const Vector3<S> up = scale * rotate_back(q, field_W);
        const int i = (axis + 1) % 3, j = (axis + 2) % 3;
        w1 = w[i], w2 = w[j], w3 = w[axis];
        g1 = up[i], g2 = up[j], u = up[axis];
        const S beta = S(2) * G / I1, a = I3 * w3 / I1;
        relative_spin = (I1 - I3) / I1 * w3;
        const S across = g1 * g1 + g2 * g2, w_squared = w1 * w1 + w2 * w2, d = w1 * g1 + w2 * g2;  // d = b - a u
        plus = a * (S(1) + u) + d, minus = d - a * (S(1) - u);

        // (du/dt)^2 = beta s^3 + quadratic s^2 + linear s + constant
        const S rate = g1 * w2 - g2 * w1, constant = rate * rate;
        const S linear = S(2) * (a * d - u * w_squared) - beta * across;
        const S quadratic = S(2) * u * beta - (w_squared + a * a);
        const S s3 = largest_root(quadratic, S(linear * beta), S(constant * beta * beta));  // beta (u3 - u)
        // s1 s2 = -constant/s3, s1 + s2 = (linear + constant beta/s3)/s3
        const S product = constant / s3, half_sum = (linear + constant * beta / s3) / (s3 + s3);
        const S root = square_root(S(half_sum * half_sum + product));
        S s1, s2;
        if (half_sum > 0) {
            s2 = half_sum + root;
            s1 = -product / s2;
        } else {
            s1 = half_sum - root;
            s2 = s1 < 0 ? S(-product / s1) : S(0);
        }
        const S width = s2 - s1;
        from_bottom = S(1) + u + s2, from_top = S(1) - u - s1;
        four_lambda_squared = s3 - beta * s1;
        m = beta * width / four_lambda_squared;

        // f(-1) = -(a+b)^2 and f(1) = -(b-a)^2, as products over the roots.
        const S below = plus * plus / (from_bottom * (beta * (S(1) + u) + s3));  // 1 + u1
        const S upper_product = minus * minus / from_top;                        // beta (1 - u2)(u3 - 1)
        const S balance = s3 - beta * (S(1) - u) - beta * (S(1) - u - s2);       // beta (u3 - 1) - beta (1 - u2)
        const S sum = square_root(S(balance * balance + S(4) * beta * upper_product));
        // Compute the larger of the two by addition, the other from their product.
        const S larger = (sum + Elementary<S>::magnitude(balance)) / S(2);
        const S smaller = larger > 0 ? S(beta * upper_product / larger) : S(0);
        const S above = balance > 0 ? smaller : larger, beyond = balance > 0 ? larger : smaller;
        m1 = (above + beyond) / four_lambda_squared;

        const S sn_squared = below / from_bottom, cn_squared = width / from_bottom;
        eta_plus = {square_root(sn_squared), cn_squared, cn_squared + m * sn_squared};
        const S spread = above + beyond, dn_squared = width / from_top;
        if (spread > 0)
            eta_minus = {square_root(S(above / beta * four_lambda_squared / (from_top * spread))),
                         dn_squared * beyond / spread, dn_squared};
        if (width > 0) {
            const S sn = square_root(S(-s1 / width));
            phase = {rate < 0 ? S(-sn) : sn, s2 / width, s3 / four_lambda_squared};
        }
    }

    template <class From>
    explicit LagrangeStart(const LagrangeStart<From>& b)
        : axis(b.axis),
          w1(S(b.w1)),
          w2(S(b.w2)),
          w3(S(b.w3)),
          g1(S(b.g1)),
          g2(S(b.g2)),
          u(S(b.u)),
          four_lambda_squared(S(b.four_lambda_squared)),
          m(S(b.m)),
          m1(S(b.m1)),
          from_bottom(S(b.from_bottom)),
          from_top(S(b.from_top)),
          plus(S(b.plus)),
          minus(S(b.minus)),
          relative_spin(S(b.relative_spin)),
          phase(rounded(b.phase)),
          eta_plus(rounded(b.eta_plus)),
          eta_minus(rounded(b.eta_minus)) {}

  private:
    // Largest root of x^3 + c2 x^2 + c1 x + c0, c0 >= 0, by Newton's method from above, where the cubic is convex.
    static S largest_root(const S& c2, const S& c1, const S& c0) {
        using E = Elementary<S>;
        S x = S(2) * std::max({E::magnitude(c2), square_root(E::magnitude(c1)), E::cube_root(c0)});
        // Close to a double root each iteration only halves the distance, so as many iterations as S has bits may be
        // needed.
        for (int iteration = 0; iteration < 400; ++iteration) {
            const S value = ((x + c2) * x + c1) * x + c0, slope = (S(3) * x + S(2) * c2) * x + c1;
            if (!(slope > 0) || !(value > 0)) break;
            const S next = x - value / slope;
            if (!(next < x)) break;
            x = next;
        }
        return x;
    }
    template <class From>
    static JacobiSquares<S> rounded(const JacobiSquares<From>& b) {
        return {S(b.sn), S(b.cn_squared), S(b.dn_squared)};
    }
};

/// The motion of Lagrange's top, see the equations above.
template <class S>
class LagrangeTop {
  public:
    /// `axis`: of symmetry, with moment I3; I1: transverse moment; `field_W`: G in N m, not zero.
    LagrangeTop(int axis, const S& I1, const S& I3, const Vector3<S>& field_W, const Vector3<S>& w,
                const Quaternion<S>& q)
        : LagrangeTop(LagrangeStart<S>(axis, I1, I3, field_W, w, q), q) {}

    /// `q`: the attitude that `b` was computed from.
    LagrangeTop(const LagrangeStart<S>& b, const Quaternion<S>& q)
        : axis_(b.axis),
          w3_(b.w3),
          lattice_(b.m, b.m1),
          plus_(lattice_, ShiftedTheta<S>::Kind::theta1, b.eta_plus.argument()),
          minus_(lattice_, ShiftedTheta<S>::Kind::theta2, b.eta_minus.argument()),
          turning_plus_(b.plus < 0 ? S(-1) : S(1)),
          turning_minus_(b.minus < 0 ? S(-1) : S(1)),
          rate_(square_root(b.four_lambda_squared) / S(2)),
          phase_(b.phase.argument()),
          size_plus_(square_root(S(b.from_bottom / S(2)))),
          size_minus_(square_root(S(b.from_top / S(2)))) {
        // Moduli and rates are computed where the moduli are largest: x+ at v = K (u = u2), x- at v = 0 (u = u1). On
        // the separatrix v = K is reached only as t -> infinity; there |theta_1/theta_4| is 1 and its phase is
        // constant.
        Harmonics<S> h{};
        S phase_rate(0);
        if (lattice_.quarter < Elementary<S>::infinity()) {
            lattice_.template harmonics<true>(lattice_.quarter, h);
            size_plus_ *= lattice_.denominator(h) / magnitude(plus_.sum(h));
            phase_rate = rate_ * (lattice_.scale * angular_rate(plus_, h) + plus_.drift);
        }
        // d/dt of (phi+psi)/2 is ((w3 - a) + (a+b)/(1+u))/2, that of (phi-psi)/2 is ((a - w3) + (b-a)/(1-u))/2.
        angular_plus_ = (b.relative_spin + b.plus / b.from_bottom) / S(2) - turning_plus_ * phase_rate;
        lattice_.template harmonics<true>(S(0), h);
        size_minus_ *= lattice_.denominator(h) / magnitude(minus_.sum(h));
        phase_rate = rate_ * (lattice_.scale * angular_rate(minus_, h) + minus_.drift);
        angular_minus_ = (b.minus / b.from_top - b.relative_spin) / S(2) - turning_minus_ * phase_rate;

        // The canonical motion has an arbitrary psi. A constant rotation about e3 maps it to the body axes. It
        // follows from z or from w transverse to e3 at t = 0, whichever is larger in the motion's own units.
        Quaternion<S> top;
        Vector3<S> w_top;
        canonical(S(0), top, w_top);
        const Vector3<S> up_top = world_axis(top, 2);
        const Complex<S> z{b.g1, b.g2}, z_top{up_top[0], up_top[1]}, w{b.w1, b.w2}, own{w_top[0], w_top[1]};
        const bool by_w = squared(w) > b.four_lambda_squared * squared(z);
        Complex<S> turn = by_w ? own * conjugate(w) : z_top * conjugate(z);
        const S size = magnitude(turn);
        turn = size > 0 ? Complex<S>{turn.re / size, turn.im / size} : Complex<S>{S(1), S(0)};
        spin_ = turn;
        // Half of the rotation angle, from the larger of its sine and cosine.
        Complex<S> half;
        if (turn.re > 0) {
            half.re = square_root(S((S(1) + turn.re) / S(2)));
            half.im = turn.im / (half.re + half.re);
        } else {
            half.im = square_root(S((S(1) - turn.re) / S(2)));
            half.re = turn.im / (half.im + half.im);
        }
        half_spin_ = {half.re, S(0), S(0), half.im};
        base_ = q * conjugate(relabelled(top * half_spin_));
    }

    /// Rotation at any t (s), before or after the start.
    Rotation<S> at(const S& t) const {
        Quaternion<S> top;
        Vector3<S> w_top;
        canonical(t, top, w_top);
        const int i = (axis_ + 1) % 3, j = (axis_ + 2) % 3;
        Rotation<S> result;
        result.w[i] = spin_.re * w_top[0] + spin_.im * w_top[1];
        result.w[j] = spin_.re * w_top[1] - spin_.im * w_top[0];
        result.w[axis_] = w3_;
        const Quaternion<S> q = base_ * relabelled(top * half_spin_);
        const S scale = S(1) / square_root(squared_norm(q));
        result.q = {scale * q.w, scale * q.x, scale * q.y, scale * q.z};
        return result;
    }

  private:
    int axis_ = 0;
    S w3_;
    Lattice<S> lattice_;
    ShiftedTheta<S> plus_, minus_;
    S turning_plus_, turning_minus_;
    S rate_, phase_, size_plus_, size_minus_, angular_plus_, angular_minus_;
    Complex<S> spin_;
    Quaternion<S> half_spin_, base_;

    static S squared(const Complex<S>& z) { return z.re * z.re + z.im * z.im; }
    static S magnitude(const Complex<S>& z) { return square_root(squared(z)); }
    static S angular_rate(const ShiftedTheta<S>& theta, const Harmonics<S>& h) {
        const Complex<S> value = theta.sum(h), slope = theta.derivative(h);
        return (slope.im * value.re - slope.re * value.im) / squared(value);
    }
    // From axes with e3 last to the principal axes.
    Quaternion<S> relabelled(const Quaternion<S>& q) const {
        const S v[3] = {q.x, q.y, q.z};
        S p[3];
        for (int k = 0; k < 3; ++k) p[(axis_ + 1 + k) % 3] = v[k];
        return {q.w, p[0], p[1], p[2]};
    }

    // The motion up to rotations of the world about z and of the body about e3: q, and w transverse to the axis.
    void canonical(const S& t, Quaternion<S>& q, Vector3<S>& w) const {
        S v = rate_ * t + phase_;
        const S j = lattice_.reduce(v);
        Harmonics<S> h{};
        lattice_.template harmonics<true>(v, h);
        const S inverse = S(1) / lattice_.denominator(h);
        const S fast = lattice_.scale * rate_, decay = lattice_.denominator_slope(h) * inverse * fast;
        Complex<S> x, dx, y, dy;
        parameter(t, v, j, h, plus_, turning_plus_, angular_plus_, S(size_plus_ * inverse), fast, decay, x, dx);
        parameter(t, v, j, h, minus_, turning_minus_, angular_minus_, S(size_minus_ * inverse), fast, decay, y, dy);
        q = {x.re, y.re, y.im, x.im};
        // w = 2 vec(q* dq/dt)
        const Quaternion<S> rate{dx.re, dy.re, dy.im, dx.im};
        const Quaternion<S> half = conjugate(q) * rate;
        w = {half.x + half.x, half.y + half.y, half.z + half.z};
    }

    // One Cayley-Klein parameter and its time derivative: size exp(i (A t + s drift v)) theta(v), where the theta
    // function rotates in the opposite sense for s = -1. theta_1 and theta_2 change sign with each half period,
    // theta_4 does not.
    void parameter(const S& t, const S& v, const S& j, const Harmonics<S>& h, const ShiftedTheta<S>& theta,
                   const S& turning, const S& angular, const S& size, const S& fast, const S& decay, Complex<S>& x,
                   Complex<S>& dx) const {
        S sine, cosine;
        Elementary<S>::sine_cosine(S(angular * t + turning * theta.drift * v), sine, cosine);
        const S half = j / S(2), signed_size = Elementary<S>::rounded(half) == half ? size : S(-size);
        const Complex<S> factor{signed_size * cosine, signed_size * sine};
        Complex<S> sum = theta.sum(h), slope = theta.derivative(h);
        if (turning < 0) sum = conjugate(sum), slope = conjugate(slope);
        x = factor * sum;
        slope = factor * slope;
        const S phase_rate = angular + turning * theta.drift * rate_;
        dx = {fast * slope.re - decay * x.re - phase_rate * x.im, fast * slope.im - decay * x.im + phase_rate * x.re};
    }
};

}  // namespace polhode
