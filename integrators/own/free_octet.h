// Closed-form motion of eight torque-free bodies side by side. The formulas are those of FreeAsymmetricBody and
// FreeSymmetricBody (free_body.h).
//
// advance_free() sorts the axes, then evaluates the symmetric and the asymmetric formulas where the eight bodies need
// them. Nomes come from their series instead of a second period. Lattice8 holds the trigonometric or hyperbolic
// lattice of each lane; both are evaluated if the bodies have different kinds. Theta8 and Point hold theta sums and
// elliptic functions.
#pragma once

#include <limits>
#include <numbers>

#include "integrators/lanes/lane_math.h"

namespace polhode {

/// Input and, after advance_free(), output. Principal axes, in any order.
struct FreeOctet {
    Octet moments[3];  ///< kg m^2, > 0
    Octet w[3];        ///< rad/s
    Octet q[4];        ///< (w, x, y, z): principal axes to world
    /// Estimated attitude error, rad: rounding, times its amplification close to a separatrix. Not finite if this
    /// kernel does not support the body.
    Octet error;
};

namespace free_octet {

constexpr int trigonometric_terms = 3, hyperbolic_terms = 4;

POLHODE_INLINE void exchange(const OctetMask& mask, Octet& a, Octet& b) {
    const Octet before = a;
    a = select(mask, b, a);
    b = select(mask, before, b);
}

/// Exchanges axes i and j where the mask is set.
POLHODE_INLINE void order(const OctetMask& mask, int i, int j, Octet I[3], Octet w[3], Octet axis[3], Octet& parity) {
    exchange(mask, I[i], I[j]), exchange(mask, w[i], w[j]), exchange(mask, axis[i], axis[j]);
    parity = select(mask, -parity, parity);
}

/// Carlson's R_F(x, y, 1), see carlson_rf.
POLHODE_INLINE Octet carlson_rf(Octet x, Octet y) {
    Octet z = octet(1), mean = (x + y + z) * (1.0 / 3);
    for (int i = 0; i < 64; ++i) {
        const Octet spread = larger(larger(magnitude(mean - x), magnitude(mean - y)), magnitude(mean - z));
        const OctetMask going = spread > 0.011 * mean;
        if (!any(going)) break;
        const Octet rx = square_root(x), ry = square_root(y), rz = square_root(z);
        const Octet lambda = rx * ry + ry * rz + rz * rx;
        x = select(going, (x + lambda) * 0.25, x);
        y = select(going, (y + lambda) * 0.25, y);
        z = select(going, (z + lambda) * 0.25, z);
        mean = select(going, (mean + lambda) * 0.25, mean);
    }
    const Octet inverse = 1.0 / mean;
    const Octet X = (mean - x) * inverse, Y = (mean - y) * inverse, Z = -X - Y;
    const Octet e2 = X * Y - Z * Z, e3 = X * Y * Z;
    const Octet series = 1.0 + e2 * (-0.1 + e2 * (1.0 / 24) - e2 * e2 * (5.0 / 208) - e3 * (3.0 / 44)) +
                         e3 * (1.0 / 14 + e3 * (3.0 / 104) + e2 * e2 * (1.0 / 16));
    return series / square_root(mean);
}

/// The arithmetic-geometric mean of 1 and b; b = 0 is replaced by 1e-300.
POLHODE_INLINE Octet mean_with_one(Octet b) {
    Octet a = octet(1);
    b = larger(b, octet(1e-300));
    for (int i = 0; i < 32; ++i) {
        const OctetMask going = magnitude(a - b) > 1e-8 * a;
        if (!any(going)) break;
        const Octet next = (a + b) * 0.5;
        b = select(going, square_root(a * b), b);
        a = select(going, next, a);
    }
    return (a + b) * 0.5;
}

/// Lattice<double> of closed_form/elliptic.h for eight parameters.
struct Lattice8 {
    OctetMask hyperbolic;
    bool some_hyperbolic = false, some_trigonometric = false;
    Octet scale, nome, quarter;
    Octet square[hyperbolic_terms + 1], pronic[hyperbolic_terms + 1];  ///< q^(n^2), q^(n(n+1))
};

/// Elliptic functions and theta sum at u; re + i im gives half the rotation angle.
struct Point {
    Octet sn, cn, dn, re, im;
};

POLHODE_INLINE Lattice8 lattice(const Octet& m, const Octet& m1) {
    Lattice8 L;
    L.hyperbolic = m1 < m;
    L.some_hyperbolic = any(L.hyperbolic), L.some_trigonometric = any(m <= m1);
    const Octet small = smaller(m, m1), large = larger(m, m1);
    const Octet near_mean = mean_with_one(square_root(large));
    constexpr double half_pi = std::numbers::pi / 2;
    L.scale = near_mean;  // pi / 2K
    L.quarter = half_pi / near_mean;
    if (L.some_hyperbolic) {
        const Octet far = half_pi / mean_with_one(square_root(m1));
        L.quarter = select(L.hyperbolic, far, L.quarter);
    }
    // q = e + 2 e^5 + 15 e^9 + 150 e^13 + .., e = (1 - sqrt k')/(2 (1 + sqrt k'))  (DLMF 19.5.6); k'^2 is `large`
    const Octet complement = square_root(large), root = square_root(complement);
    const Octet e = 0.5 * small / ((1.0 + complement) * (1.0 + root) * (1.0 + root));
    const Octet e2 = e * e, e4 = e2 * e2;
    L.nome = e * (1.0 + e4 * (2.0 + e4 * (15.0 + e4 * (150.0 + e4 * 1707.0))));
    L.square[0] = L.pronic[0] = octet(1);
    Octet power = octet(1);
    for (int n = 1; n <= hyperbolic_terms; ++n) {
        L.square[n] = L.square[n - 1] * power * L.nome * power;
        power *= L.nome;
        L.pronic[n] = L.square[n] * power;
    }
    return L;
}

/// Coefficients of theta_1(u - i s eta) in the current lattice, see ShiftedTheta.
struct Theta8 {
    Octet even[hyperbolic_terms + 1], odd[hyperbolic_terms + 1];
};

POLHODE_INLINE Theta8 trigonometric_theta(const Lattice8& L, const Octet& shift) {
    Theta8 theta;
    Octet step, less_one;
    exponential(-2.0 * shift, step, less_one);
    const Octet bounded = L.nome / step, step_squared = step * step;
    Octet decay = step, growth = octet(1);
    for (int n = 0; n <= trigonometric_terms; ++n) {
        const Octet weight = (n % 2 ? -1.0 : 1.0) * (L.square[n] * growth);
        theta.even[n] = weight * (1.0 + decay);
        theta.odd[n] = n == 0 ? -less_one : weight * (1.0 - decay);
        decay *= step_squared;
        growth *= bounded;
    }
    return theta;
}

POLHODE_INLINE Theta8 hyperbolic_theta(const Octet& shift) {
    Theta8 theta;
    Octet s, c;
    sine_cosine(shift, s, c);
    const Octet s2 = s * c + s * c, c2 = c * c - s * s;
    for (int n = 0; n <= hyperbolic_terms; ++n) {
        theta.even[n] = n % 2 ? -c : c;
        theta.odd[n] = n % 2 ? -s : s;
        const Octet next = s * c2 + c * s2;
        c = c * c2 - s * s2;
        s = next;
    }
    return theta;
}

POLHODE_INLINE Point trigonometric_point(const Lattice8& L, const Theta8& theta, const Octet& u) {
    Octet s, c;
    sine_cosine(L.scale * u, s, c);
    const Octet s2 = s * c + s * c, c2 = c * c - s * s;
    Point p;
    p.re = theta.even[0] * s;
    p.im = -(theta.odd[0] * c);
    Octet alternating_odd = s, odd = c, alternating = octet(1), even = octet(1);
    Octet even_before = octet(1), even_cosine = c2;
    Octet theta2 = octet(1), theta3 = octet(1), theta4 = octet(1);
    for (int n = 1; n <= trigonometric_terms; ++n) {
        const Octet next = s * c2 + c * s2;
        c = c * c2 - s * s2;
        s = next;
        p.re += theta.even[n] * s;
        p.im -= theta.odd[n] * c;
        const double sign = n % 2 ? -1 : 1;
        const Octet twice = L.square[n] + L.square[n];
        alternating_odd += sign * (L.pronic[n] * s);
        odd += L.pronic[n] * c;
        alternating += sign * (twice * even_cosine);
        even += twice * even_cosine;
        theta2 += L.pronic[n];
        theta3 += twice;
        theta4 += sign * twice;
        const Octet next_even = (c2 + c2) * even_cosine - even_before;
        even_before = even_cosine;
        even_cosine = next_even;
    }
    const Octet inverse = 1.0 / alternating;
    p.sn = theta3 / theta2 * alternating_odd * inverse;
    p.cn = theta4 / theta2 * odd * inverse;
    p.dn = theta4 / theta3 * even * inverse;
    return p;
}

/// Hyperbolic harmonics of eight arguments, scaled as in Harmonics.
struct HyperbolicHarmonics {
    Octet odd_sine[hyperbolic_terms + 1], odd_cosine[hyperbolic_terms + 1], even_cosine[hyperbolic_terms + 1];
};

POLHODE_INLINE HyperbolicHarmonics hyperbolic_harmonics(const Lattice8& L, const Octet& v) {
    HyperbolicHarmonics h;
    const Octet a = smaller(magnitude(v), octet(340));
    const Octet unit = exponential(-a), unit_squared = unit * unit;
    const Octet grown = L.nome / unit_squared, shrunk = L.nome * unit_squared;
    const OctetMask negative = v < octet(0);
    Octet up = octet(1), down = octet(1);
    for (int n = 0; n <= hyperbolic_terms; ++n) {
        const Octet low = down * unit_squared, even = n == 0 ? unit : unit * L.pronic[n - 1];
        const Octet sine = 0.5 * (L.square[n] * (up - low));
        h.odd_sine[n] = select(negative, -sine, sine);
        h.odd_cosine[n] = 0.5 * (L.square[n] * (up + low));
        h.even_cosine[n] = 0.5 * (even * (up + down));
        up *= grown;
        down *= shrunk;
    }
    return h;
}

POLHODE_INLINE Point hyperbolic_point(const Lattice8& L, const Theta8& theta, const Octet& u) {
    const HyperbolicHarmonics h = hyperbolic_harmonics(L, L.scale * u);
    Point p;
    p.re = theta.even[0] * h.odd_sine[0];
    p.im = -(theta.odd[0] * h.odd_cosine[0]);
    Octet alternating_odd = h.odd_sine[0], odd = h.odd_cosine[0], alternating = h.even_cosine[0], even = alternating;
    Octet theta2 = octet(1), theta3 = octet(1), theta4 = octet(1);
    for (int n = 1; n <= hyperbolic_terms; ++n) {
        const double sign = n % 2 ? -1 : 1;
        p.re += theta.even[n] * h.odd_sine[n];
        p.im -= theta.odd[n] * h.odd_cosine[n];
        alternating_odd += sign * h.odd_sine[n];
        odd += h.odd_cosine[n];
        const Octet twice = h.even_cosine[n] + h.even_cosine[n];
        alternating += sign * twice;
        even += twice;
        theta2 += L.pronic[n];
        const Octet squares = L.square[n] + L.square[n];
        theta3 += squares;
        theta4 += sign * squares;
    }
    const Octet inverse = 1.0 / odd;
    p.sn = theta3 / theta4 * alternating_odd * inverse;
    p.cn = theta2 / theta4 * alternating * inverse;
    p.dn = theta2 / theta3 * even * inverse;
    return p;
}

POLHODE_INLINE Octet one_where(const OctetMask& mask) { return select(mask, octet(1), octet(0)); }
POLHODE_INLINE void choose(const OctetMask& mask, Octet& a, const Octet& b) { a = select(mask, b, a); }

POLHODE_INLINE void point_at(const Lattice8& L, const Theta8& trigonometric, const Theta8& hyperbolic, const Octet& u,
                             Point& p) {
    if (L.some_trigonometric) p = trigonometric_point(L, trigonometric, u);
    if (!L.some_hyperbolic) return;
    const Point other = hyperbolic_point(L, hyperbolic, u);
    if (!L.some_trigonometric) {
        p = other;
        return;
    }
    choose(L.hyperbolic, p.sn, other.sn), choose(L.hyperbolic, p.cn, other.cn), choose(L.hyperbolic, p.dn, other.dn);
    choose(L.hyperbolic, p.re, other.re), choose(L.hyperbolic, p.im, other.im);
}

/// d arg(theta sum)/d(scale u) at u = 0, or at u = K where `at_quarter` is set.
POLHODE_INLINE Octet trigonometric_slope(const Theta8& theta, const OctetMask& at_quarter) {
    Octet up0 = octet(0), down0 = up0, up1 = up0, down1 = up0;
    for (int n = 0; n <= trigonometric_terms; ++n) {
        const double k = 2 * n + 1, sign = n % 2 ? -1 : 1;
        up0 += k * theta.even[n];
        down0 += theta.odd[n];
        up1 += (sign * k) * theta.odd[n];
        down1 += sign * theta.even[n];
    }
    return select(at_quarter, up1, up0) / select(at_quarter, down1, down0);
}

POLHODE_INLINE Octet hyperbolic_slope(const Lattice8& L, const Theta8& theta, const OctetMask& at_quarter) {
    const HyperbolicHarmonics h = hyperbolic_harmonics(L, select(at_quarter, L.scale * L.quarter, octet(0)));
    Octet re = octet(0), im = re, re_slope = re, im_slope = re;
    for (int n = 0; n <= hyperbolic_terms; ++n) {
        const double k = 2 * n + 1;
        re += theta.even[n] * h.odd_sine[n];
        im -= theta.odd[n] * h.odd_cosine[n];
        re_slope += k * (theta.even[n] * h.odd_cosine[n]);
        im_slope -= k * (theta.odd[n] * h.odd_sine[n]);
    }
    return (im_slope * re - re_slope * im) / (re * re + im * im);
}

/// turn_z(half angle) swing(l) in relabelled axes, not normalised: see FreeAsymmetricBody::nutation.
POLHODE_INLINE void nutation(const Octet& re, const Octet& im, const Octet l[3], Octet q[4]) {
    const Octet up = 1.0 + l[2];
    q[0] = re * up;
    q[1] = re * l[1] + im * l[0];
    q[2] = im * l[1] - re * l[0];
    q[3] = im * up;
}

POLHODE_INLINE void half_turn(const Point& p, const Octet& sense, const Octet l[3], Octet& re, Octet& im) {
    const Octet x = p.re * (sense * l[1]) - p.im * l[0], y = p.re * l[0] + p.im * (sense * l[1]);
    const Octet inverse = 1.0 / square_root(x * x + y * y);
    const Octet c = square_root((1.0 + x * inverse) * 0.5);
    re = c;
    im = sense * y * inverse / (c + c);
}

POLHODE_INLINE void multiply(const Octet a[4], const Octet b[4], Octet r[4]) {
    r[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    r[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    r[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    r[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}

}  // namespace free_octet

/// Advances the motion by the time t (s).
POLHODE_INLINE void advance_free(FreeOctet& body, double t) {
    using namespace free_octet;
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    const Octet zero = octet(0), one = octet(1);
    // Sort the axes by their moments, a <= b <= c, together with w; track the sign of the permutation.
    Octet I[3] = {body.moments[0], body.moments[1], body.moments[2]}, w[3] = {body.w[0], body.w[1], body.w[2]};
    Octet axis[3] = {zero, one, octet(2)}, parity = one;
    order(I[0] > I[1], 0, 1, I, w, axis, parity);
    order(I[1] > I[2], 1, 2, I, w, axis, parity);
    order(I[0] > I[1], 0, 1, I, w, axis, parity);
    const Octet outer = I[2] * (I[2] - I[1]) * (w[2] * w[2]), inner = I[0] * (I[1] - I[0]) * (w[0] * w[0]);
    Octet excess = outer - inner;
    order(excess < zero, 0, 2, I, w, axis, parity);
    excess = magnitude(excess);
    Octet sign[3];
    sign[0] = select(w[0] < zero, -one, one);
    sign[2] = select(w[2] < zero, -one, one);
    sign[1] = parity * sign[0] * sign[2];
    for (int i = 0; i < 3; ++i) w[i] *= sign[i];

    const Octet still = one_where(w[0] == zero) + one_where(w[1] == zero) + one_where(w[2] == zero);
    const OctetMask about_axis = still > octet(1.5);
    const Octet is_simple = one_where(about_axis) + one_where(I[0] == I[1]) + one_where(I[1] == I[2]);
    const OctetMask simple = is_simple > octet(0.5);
    const bool some_simple = any(simple), some_general = any(is_simple < octet(0.5));
    const Octet w_squared = w[0] * w[0] + w[1] * w[1] + w[2] * w[2], w_size = square_root(w_squared);
    Octet L_B[3];
    for (int i = 0; i < 3; ++i) L_B[i] = I[i] * w[i];
    const Octet L = square_root(L_B[0] * L_B[0] + L_B[1] * L_B[1] + L_B[2] * L_B[2]);
    const Octet inverse_L = 1.0 / select(L > zero, L, one);

    Octet turned[4] = {one, zero, zero, zero},
          rate[3] = {zero, zero, zero};  // relabelled axes: rotation since the start; w at the end
    Octet error = 4 * epsilon * (1.0 + w_size * t);
    const Octet out_of_reach = octet(std::numeric_limits<double>::infinity());
    const OctetMask too_far = w_size * t > octet(largest_angle);
    error = select(too_far, out_of_reach, error);
    if (some_simple) {
        // turn(L_B, L t/I_2) turn(axis 3, (1 - I_3/I_2) w_3 t), or |w| t about L_B alone
        const Octet precession = select(about_axis, w_size, L / I[1]) * (0.5 * t);
        const Octet spin = select(about_axis, zero, (I[1] - I[2]) / I[1] * w[2]) * (0.5 * t);
        Octet s, c, s3, c3;
        sine_cosine(select(too_far, zero, precession), s, c);
        sine_cosine(select(too_far, zero, spin), s3, c3);
        const Octet along = s * inverse_L;
        const Octet first[4] = {c, along * L_B[0], along * L_B[1], along * L_B[2]}, second[4] = {c3, zero, zero, s3};
        multiply(first, second, turned);
        const Octet cosine = c3 * c3 - s3 * s3, sine = c3 * s3 + c3 * s3;
        rate[0] = cosine * w[0] + sine * w[1];
        rate[1] = cosine * w[1] - sine * w[0];
        rate[2] = w[2];
    }
    if (some_general) {
        const Octet d31 = magnitude(I[2] - I[0]), d32 = magnitude(I[2] - I[1]), d21 = magnitude(I[1] - I[0]);
        const Octet ratio12 = I[1] * d32 / (I[0] * d31), ratio32 = I[1] * d21 / (I[2] * d31);
        const Octet a1_squared = w[0] * w[0] + ratio12 * (w[1] * w[1]);
        const Octet a3_squared = w[2] * w[2] + ratio32 * (w[1] * w[1]);
        const Octet scaled = 1.0 / (I[2] * d32 * a3_squared);
        const Octet m = select(simple, octet(0.5), I[0] * d21 * a1_squared * scaled);
        const Octet m1 = select(simple, octet(0.5), excess * scaled);
        const Octet sense = select(I[2] < I[0], -one, one);
        const Octet a1 = square_root(a1_squared), a3 = square_root(a3_squared), a2 = a1 / square_root(ratio12);
        const Octet rate_of_u = square_root(d31 * d32 / (I[0] * I[1])) * a3;
        const Octet cn = w[0] / a1, dn = w[2] / a3;
        const Octet start = sense * w[1] / a2 * carlson_rf(select(simple, one, cn * cn), select(simple, one, dn * dn));
        const Octet inverse_eta = 1.0 / (I[1] * d31);
        const Octet sn2_eta = select(simple, one, I[0] * d32 * inverse_eta);
        const Octet cn2_eta = select(simple, one, I[2] * d21 * inverse_eta);
        const Octet eta = square_root(sn2_eta) * carlson_rf(cn2_eta, cn2_eta + m * sn2_eta);

        const Lattice8 lattice8 = lattice(m, m1);
        const Octet shift = eta * lattice8.scale;
        Theta8 trigonometric{}, hyperbolic{};
        if (lattice8.some_trigonometric) trigonometric = trigonometric_theta(lattice8, shift);
        if (lattice8.some_hyperbolic) hyperbolic = hyperbolic_theta(shift);

        const OctetMask at_quarter = I[0] < I[1];
        Octet slope = lattice8.some_trigonometric ? trigonometric_slope(trigonometric, at_quarter) : zero;
        if (lattice8.some_hyperbolic)
            slope = select(lattice8.hyperbolic, hyperbolic_slope(lattice8, hyperbolic, at_quarter), slope);
        const Octet half_precession =
            0.5 * (L / select(at_quarter, I[1], I[0]) - sense * rate_of_u * (slope * lattice8.scale));

        Octet u = rate_of_u * t + start;
        const Octet j = rounded(u / (lattice8.quarter + lattice8.quarter));
        u -= j * (lattice8.quarter + lattice8.quarter);
        Octet half_angle = half_precession * t;
        half_angle -= select(lattice8.hyperbolic, sense * j * shift, zero);

        Octet l[3], at_start[4], at_end[4], re, im;
        Point point{};
        point_at(lattice8, trigonometric, hyperbolic, start, point);
        for (int i = 0; i < 3; ++i) l[i] = L_B[i] * inverse_L;
        half_turn(point, sense, l, re, im);
        nutation(re, im, l, at_start);

        point_at(lattice8, trigonometric, hyperbolic, u, point);
        Octet end[3] = {a1 * point.cn, sense * a2 * point.sn, a3 * point.dn};
        for (int i = 0; i < 3; ++i) l[i] = I[i] * end[i] * inverse_L;
        half_turn(point, sense, l, re, im);
        for (int i = 0; i < 2; ++i) end[i] = signed_by_parity(end[i], j), l[i] = signed_by_parity(l[i], j);
        Octet sine, cosine;
        const OctetMask within = magnitude(half_angle) + magnitude(j) <= octet(largest_angle);
        sine_cosine(select(within, half_angle, zero), sine, cosine);
        nutation(cosine * re - sine * im, sine * re + cosine * im, l, at_end);

        const Octet back[4] = {at_start[0], -at_start[1], -at_start[2], -at_start[3]};
        Octet general[4];
        multiply(back, at_end, general);
        const Octet size = 1.0 / square_root(general[0] * general[0] + general[1] * general[1] +
                                             general[2] * general[2] + general[3] * general[3]);
        for (int i = 0; i < 4; ++i)
            turned[i] = some_simple ? select(simple, turned[i], general[i] * size) : general[i] * size;
        for (int i = 0; i < 3; ++i) rate[i] = some_simple ? select(simple, rate[i], end[i]) : end[i];
        // Close to the separatrix an error grows as exp u on the way from the saddle. An error in m1 shifts each
        // passage by half its relative size.
        const Octet amplified = epsilon * smaller((1.0 + magnitude(j)) * ((outer + inner) / excess),
                                                  exponential(smaller(rate_of_u * t, octet(100))));
        error = select(simple, error, select(within, error + amplified, out_of_reach));
    }
    for (int i = 0; i < 3; ++i) turned[i + 1] *= sign[i], rate[i] *= sign[i];
    Octet principal[4];
    principal[0] = turned[0];
    for (int i = 0; i < 3; ++i) {
        const Octet k = octet(i);
        const OctetMask first = axis[0] == k, second = axis[1] == k;
        principal[i + 1] = select(first, turned[1], select(second, turned[2], turned[3]));
        body.w[i] = select(first, rate[0], select(second, rate[1], rate[2]));
    }
    Octet q[4];
    multiply(body.q, principal, q);
    for (int i = 0; i < 4; ++i) body.q[i] = q[i];
    body.error = error;
}

}  // namespace polhode
