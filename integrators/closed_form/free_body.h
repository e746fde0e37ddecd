// Torque-free motion of a rigid body in closed form, including attitude, over any scalar. It is evaluated at any t
// directly, without stepping.
//
// AxisRotation, FreeSymmetricBody and FreeAsymmetricBody take w and q in principal axes; q maps these to the world
// and is continuous in t.
#pragma once

#include <utility>

#include "body/algebra.h"
#include "integrators/closed_form/elliptic.h"

namespace polhode {

/// Angular velocity and attitude at one time.
template <class S>
struct Rotation {
    Vector3<S> w;     ///< rad/s, principal axes
    Quaternion<S> q;  ///< principal axes to world
};

/// Unit quaternion of a rotation by 2 * half (rad) about a coordinate axis.
template <class S>
Quaternion<S> rotation_about(int axis, const S& half) {
    S s, c;
    Elementary<S>::sine_cosine(half, s, c);
    Quaternion<S> q{c, S(0), S(0), S(0)};
    (axis == 0 ? q.x : axis == 1 ? q.y : q.z) = s;
    return q;
}

/// Unit quaternion of a rotation by 2 * half (rad) about v, |v| = length; identity for v = 0.
template <class S>
Quaternion<S> rotation_about(const Vector3<S>& v, const S& length, const S& half) {
    if (!(length > 0)) return Quaternion<S>{};
    S s, c;
    Elementary<S>::sine_cosine(half, s, c);
    s /= length;
    return {c, s * v[0], s * v[1], s * v[2]};
}

/// Rotation with w along a fixed axis: a sphere, or a body rotating about a principal axis. A torque along that axis
/// and damping -c w may act, dw/dt = a - k w, so that
///   w = w0 exp(-kt) + a (1 - exp(-kt))/k,   angle = w0 (1 - exp(-kt))/k + a (t - (1 - exp(-kt))/k)/k.
template <class S>
class AxisRotation {
  public:
    /// `axis`: unit vector, principal axes; `rate`: w0 along it, rad/s; `acceleration`, `decay`: a in rad/s^2, k in
    /// 1/s.
    AxisRotation(const Vector3<S>& axis, const S& rate, const Quaternion<S>& q, const S& acceleration = S(0),
                 const S& decay = S(0))
        : axis_(axis), rate_(rate), acceleration_(acceleration), decay_(decay), q_(q) {}

    Rotation<S> at(const S& t) const {
        S rate = rate_, angle = rate_ * t;
        if (decay_ == 0) {
            rate += acceleration_ * t;
            angle += acceleration_ * t * t / S(2);
        } else {
            const S x = decay_ * t, decayed = -Elementary<S>::exponential_less_one(S(-x));  // 1 - exp(-kt)
            const S mean = decayed / decay_;
            rate = rate_ - rate_ * decayed + acceleration_ * mean;
            angle = rate_ * mean + acceleration_ * excess(x, decayed) / (decay_ * decay_);
        }
        return {rate * axis_, q_ * rotation_about(axis_, S(1), S(angle / S(2)))};
    }

  private:
    Vector3<S> axis_;
    S rate_, acceleration_, decay_;
    Quaternion<S> q_;

    // x - (1 - exp(-x)) without cancellation; for small x from its series.
    static S excess(const S& x, const S& decayed) {
        if (Elementary<S>::magnitude(x) > S(1)) return x - decayed;
        S term = x * x / S(2), sum = term;
        for (int n = 3; Elementary<S>::magnitude(term) > Elementary<S>::epsilon() * Elementary<S>::magnitude(sum);
             ++n) {
            term *= -x / S(n);
            sum += term;
        }
        return sum;
    }
};

/// Body with two equal moments I1 transverse to `axis` and I3 about it (Landau & Lifshitz 1976, section 33):
///   q(t) = q0 turn(L_B0, |L| t/I1) turn(axis, (1 - I3/I1) w3 t),
/// where turn(v, angle) is the rotation about v.
template <class S>
class FreeSymmetricBody {
  public:
    FreeSymmetricBody(int axis, const S& I1, const S& I3, const Vector3<S>& w, const Quaternion<S>& q)
        : axis_(axis), w_(w), q_(q), L_B_(I1 * w) {
        L_B_[axis] = I3 * w[axis];
        L_ = square_root(dot(L_B_, L_B_));
        const S half = S(1) / (S(2) * I1);
        half_precession_ = L_ * half;
        half_spin_ = (I1 - I3) * half * w[axis];
    }

    Rotation<S> at(const S& t) const {
        const Quaternion<S> spin = rotation_about(axis_, S(half_spin_ * t));
        const Quaternion<S> q = (q_ * rotation_about(L_B_, L_, S(half_precession_ * t))) * spin;
        // In body axes, w rotates about the symmetry axis in the opposite sense.
        const S c = spin.w, s = axis_ == 0 ? spin.x : axis_ == 1 ? spin.y : spin.z;
        const S cosine = c * c - s * s, sine = (c * s) + (c * s);
        const int i = (axis_ + 1) % 3, j = (axis_ + 2) % 3;
        Vector3<S> w = w_;
        w[i] = cosine * w_[i] + sine * w_[j];
        w[j] = cosine * w_[j] - sine * w_[i];
        return {w, q};
    }

  private:
    int axis_ = 0;
    Vector3<S> w_;
    Quaternion<S> q_;
    Vector3<S> L_B_;
    S L_, half_precession_, half_spin_;
};

/// Body with three different moments: rates by Jacobi's elliptic functions, attitude by theta functions (C. G. J.
/// Jacobi 1849; form of R. van Zon and J. Schofield 2007, J. Comput. Phys. 225, 145). The nutation is described by a
/// swing instead of Euler angles, which avoids singular cases.
///
/// Axes are relabelled: 2 has the middle moment, w3 never changes sign, and axes 1, 3 are oriented so that w1, w3 > 0
/// initially. With s = sign(I3 - I1) and u = lambda t + u0:
///   w1 = a1 cn u,  w2 = s a2 sn u,  w3 = a3 dn u
///   a1^2 = w1^2 + I2 (I3-I2) / (I1 (I3-I1)) w2^2,  a3^2 = w3^2 + I2 (I2-I1) / (I3 (I3-I1)) w2^2   (sums of squares)
///   lambda^2 = (I3-I1)(I3-I2)/(I1 I2) a3^2,   m = I1 (I2-I1) a1^2 / (I3 (I3-I2) a3^2)
///   1 - m = (I3 (I3-I2) w3^2 - I1 (I2-I1) w1^2) / (I3 (I3-I2) a3^2)
/// The numerator of 1 - m equals L^2 - 2 E I2 without its cancellation, so close to the separatrix only the inherent
/// sensitivity of the motion costs digits. Attitude: q = Q0 turn_z(psi + phi) swing(l). Here swing(l) rotates l =
/// L_B/|L| to the third axis by the shortest rotation, l2 + i l1 = |.| exp(i phi), and
///   exp(i psi) ~ exp(i B t) theta_1(u - i s eta),   sn^2(eta | 1-m) = I1 (I3-I2) / (I2 (I3-I1)).
/// The angle of (l2 + i l1) theta_1 stays within +-90 degrees, so half angles never jump.
template <class S>
class FreeAsymmetricBody {
  public:
    /// Requires different moments and at least two nonzero components of w.
    FreeAsymmetricBody(const Vector3<S>& moments, const Vector3<S>& w, const Quaternion<S>& q)
        : FreeAsymmetricBody(Labelled(moments, w), q) {}

    /// Rounds a body from higher precision, for evaluation in lower precision.
    template <class From>
    explicit FreeAsymmetricBody(const FreeAsymmetricBody<From>& b)
        : axis_(b.axis_),
          sign_{S(b.sign_[0]), S(b.sign_[1]), S(b.sign_[2])},
          lattice_(b.lattice_),
          theta_(b.theta_),
          sense_(S(b.sense_)),
          rate_(S(b.rate_)),
          phase_(S(b.phase_)),
          half_precession_(S(b.half_precession_)),
          amplitude_(cast<S>(b.amplitude_)),
          reduced_moments_(cast<S>(b.reduced_moments_)),
          base_(cast<S>(b.base_)) {}

    Rotation<S> at(const S& t) const {
        S u = rate_ * t + phase_;
        const S j = lattice_.reduce(u);
        S half_angle = half_precession_ * t;
        if (!lattice_.trigonometric) half_angle -= sense_ * j * theta_.width;
        Vector3<S> w, l;
        Complex<S> half_turn;
        state(u, w, l, half_turn);
        // u passed j half periods: w1 and w2 changed sign j times.
        const S half = j / S(2);
        if (Elementary<S>::rounded(half) != half) w[0] = -w[0], w[1] = -w[1], l[0] = -l[0], l[1] = -l[1];
        S sine, cosine;
        Elementary<S>::sine_cosine(half_angle, sine, cosine);
        Rotation<S> result;
        for (int i = 0; i < 3; ++i) result.w[axis_[i]] = sign_[i] * w[i];
        result.q = unit(base_ * nutation(Complex<S>{cosine, sine} * half_turn, l));
        return result;
    }

  private:
    template <class>
    friend class FreeAsymmetricBody;

    // Sorts and orients the axes, before any elliptic function.
    struct Labelled {
        std::array<int, 3> axis{};
        std::array<S, 3> sign;
        S I1, I2, I3, w1, w2, w3, excess;  // excess: the numerator of 1 - m, >= 0

        Labelled(const Vector3<S>& I, const Vector3<S>& w) {
            int a = 0, b = 1, c = 2;
            if (I[a] > I[b]) std::swap(a, b);
            if (I[b] > I[c]) std::swap(b, c);
            if (I[a] > I[b]) std::swap(a, b);
            const S outer = I[c] * (I[c] - I[b]) * w[c] * w[c], inner = I[a] * (I[b] - I[a]) * w[a] * w[a];
            excess = outer - inner;
            if (excess < 0) excess = -excess, std::swap(a, c);
            axis = {a, b, c};
            const bool cyclic = (b - a + 3) % 3 == 1;
            sign[0] = w[a] < 0 ? S(-1) : S(1);
            sign[2] = w[c] < 0 ? S(-1) : S(1);
            sign[1] = (cyclic ? S(1) : S(-1)) * sign[0] * sign[2];  // right-handed
            I1 = I[a], I2 = I[b], I3 = I[c];
            w1 = sign[0] * w[a], w2 = sign[1] * w[b], w3 = sign[2] * w[c];
        }
        S difference(const S& x, const S& y) const { return Elementary<S>::magnitude(S(x - y)); }
        S ratio12() const { return I2 * difference(I3, I2) / (I1 * difference(I3, I1)); }
        S ratio32() const { return I2 * difference(I2, I1) / (I3 * difference(I3, I1)); }
        S a1_squared() const { return w1 * w1 + ratio12() * w2 * w2; }
        S a3_squared() const { return w3 * w3 + ratio32() * w2 * w2; }
        S m() const { return I1 * difference(I2, I1) * a1_squared() / (I3 * difference(I3, I2) * a3_squared()); }
        S m1() const { return excess / (I3 * difference(I3, I2) * a3_squared()); }
        S sn_squared_of_eta() const { return I1 * difference(I3, I2) / (I2 * difference(I3, I1)); }
        S cn_squared_of_eta() const { return I3 * difference(I2, I1) / (I2 * difference(I3, I1)); }
        S eta(const S& m) const {
            const S cn2 = cn_squared_of_eta(), sn2 = sn_squared_of_eta();
            return inverse_jacobi(square_root(sn2), cn2, S(cn2 + m * sn2));
        }
    };

    FreeAsymmetricBody(const Labelled& b, const Quaternion<S>& q)
        : axis_(b.axis),
          sign_(b.sign),
          lattice_(b.m(), b.m1()),
          theta_(lattice_, ShiftedTheta<S>::Kind::theta1, b.eta(b.m())),
          sense_(b.I3 > b.I1 ? S(1) : S(-1)) {
        const S a1 = square_root(b.a1_squared()), a3 = square_root(b.a3_squared());
        const S a2 = a1 / square_root(b.ratio12());
        rate_ = square_root(S(b.difference(b.I3, b.I1) * b.difference(b.I3, b.I2) / (b.I1 * b.I2))) * a3;
        amplitude_ = {a1, sense_ * a2, a3};
        const S cn = b.w1 / a1, dn = b.w3 / a3;
        phase_ = inverse_jacobi(S(sense_ * b.w2 / a2), S(cn * cn), S(dn * dn));

        const S L1 = b.I1 * b.w1, L2 = b.I2 * b.w2, L3 = b.I3 * b.w3, L = square_root(S(L1 * L1 + L2 * L2 + L3 * L3));
        reduced_moments_ = {b.I1 / L, b.I2 / L, b.I3 / L};

        // d psi/dt is L/I1 at u = 0, where w2 = 0, and L/I2 at u = K, where w1 = 0. The larger moment gives the
        // smaller quotient and avoids cancellation.
        Harmonics<S> h{};
        S slope(0);
        const bool at_quarter = b.I2 > b.I1;
        if (!at_quarter || lattice_.quarter < Elementary<S>::infinity()) {
            lattice_.template harmonics<false>(at_quarter ? lattice_.quarter : S(0), h);
            const Complex<S> value = theta_.sum(h), derivative = theta_.derivative(h);
            slope = (derivative.im * value.re - derivative.re * value.im) /
                    (value.re * value.re + value.im * value.im) * lattice_.scale;
        }
        half_precession_ = (L / (at_quarter ? b.I2 : b.I1) - sense_ * rate_ * slope) / S(2);

        Vector3<S> w, l;
        Complex<S> half_turn;
        state(phase_, w, l, half_turn);
        base_ = unit(q * conjugate(nutation(half_turn, l)));
    }

    std::array<int, 3> axis_{};
    std::array<S, 3> sign_;
    Lattice<S> lattice_;
    ShiftedTheta<S> theta_;
    S sense_, rate_, phase_, half_precession_;
    Vector3<S> amplitude_, reduced_moments_;  // of w; I/|L|
    Quaternion<S> base_;

    static Quaternion<S> unit(const Quaternion<S>& q) {
        const S scale = S(1) / square_root(squared_norm(q));
        return {scale * q.w, scale * q.x, scale * q.y, scale * q.z};
    }

    // turn_z * swing(l), not normalised, with its vector part in principal axes.
    Quaternion<S> nutation(const Complex<S>& half, const Vector3<S>& l) const {
        const S up = S(1) + l[2];
        const Vector3<S> v(half.re * l[1] + half.im * l[0], half.im * l[1] - half.re * l[0], half.im * up);
        Vector3<S> principal;
        for (int i = 0; i < 3; ++i) principal[axis_[i]] = sign_[i] * v[i];
        return {half.re * up, principal[0], principal[1], principal[2]};
    }

    // At |u| <= K: w, l = L_B/|L|, and the unit complex number with half the angle of (l2 + i l1) theta_1.
    void state(const S& u, Vector3<S>& w, Vector3<S>& l, Complex<S>& half_turn) const {
        Harmonics<S> h{};
        lattice_.template harmonics<false>(u, h);
        const Jacobi<S> f = lattice_.jacobi(h);
        w = {amplitude_[0] * f.cn, amplitude_[1] * f.sn, amplitude_[2] * f.dn};
        l = {reduced_moments_[0] * w[0], reduced_moments_[1] * w[1], reduced_moments_[2] * w[2]};
        const Complex<S> z = theta_.sum(h) * Complex<S>{sense_ * l[1], l[0]};
        const S size = square_root(S(z.re * z.re + z.im * z.im));
        const S c = square_root(S((S(1) + z.re / size) / S(2)));
        half_turn = {c, sense_ * z.im / size / (c + c)};
    }
};

}  // namespace polhode
