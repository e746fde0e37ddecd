// Taylor series of eight loaded rotations at once, each lane a body by itself with its own time and its own step.
//
//   w' = g o (w_2 w_3, w_3 w_1, w_1 w_2) + a - D w + sum_b M_b e_b - 2 k I^-1 r_w r_vec,    M_b e = I^-1 (m_b x e +
//   tau_b e) q' = 1/2 q (0, w),    e_b' = e_b x w,    r = rest* q
//
// in principal axes; e_b is the world's axis b in the body, a = I^-1 tau and D, k per I as well. A product's k-th
// coefficient is the Cauchy sum of its factors' first k + 1 (Moore 1966), and (k + 1) y_{k+1} = f_k. Steps by Jorba and
// Zou (2005, Experiment. Math. 14, 99): the last two coefficients stay below the tolerance.
#pragma once

#include <limits>

#include "integrators/kernels/lane_math.h"

namespace polhode {

/// Which terms a set of loads has.
struct LoadTerms {
    bool torque = false, damping = false, spring = false;
    int axes = 0;       ///< how many world axes enter
    int axis[3] = {0};  ///< which
};

/// One body in principal axes: its state, moved on by advance_loaded, and what acts on it.
struct LoadedLane {
    double w[3] = {0}, q[4] = {1, 0, 0, 0};  ///< rad/s; principal axes to world, of unit length
    double gyroscopic[3] = {0};              ///< (I2 - I3)/I1 and cyclic
    double torque[3] = {0};                  ///< I^-1 tau, rad/s^2
    double damping[3][3] = {};               ///< I^-1 D, 1/s
    double field[3][3][3] = {};              ///< M_b of LoadTerms::axis[b]
    double stiffness[3] = {0};               ///< 2 k / I
    double rest[4] = {1, 0, 0, 0};           ///< principal axes at rest to world
    long steps = 0;
    enum class End { reached, not_finite, too_many_steps } end = End::reached;
    double reached = 0;  ///< s, of the span asked
};

/// How far to go, and how.
struct LaneSteps {
    double span = 0;       ///< s
    double tolerance = 0;  ///< of a step: relative for w, rad for q
    double max_steps = 0;
};

namespace loaded_octet {

template <int order>
struct Series {
    Octet w[3][order + 1], q[4][order + 1], e[3][3][order + 1], r[4][order + 1];
    Octet gyroscopic[3], torque[3], damping[3][3], field[3][3][3], stiffness[3], rest[4];

    /// Coefficients 1..order from w[.][0], q[.][0].
    POLHODE_INLINE void expand(const LoadTerms& terms) {
        for (int n = 0; n < terms.axes; ++n) {
            const Octet &a = q[0][0], &b = q[1][0], &c = q[2][0], &d = q[3][0];
            const int i = terms.axis[n], j = (i + 1) % 3, k = (i + 2) % 3;
            // row i of the rotation matrix
            const Octet v[3] = {b, c, d};
            const Octet square = v[i] * v[i] - v[j] * v[j] - v[k] * v[k];
            e[n][i][0] = a * a + square;
            const Octet ij = v[i] * v[j], ak = a * v[k], ik = v[i] * v[k], aj = a * v[j];
            e[n][j][0] = (ij - ak) + (ij - ak);
            e[n][k][0] = (ik + aj) + (ik + aj);
        }
        for (int k = 0; k < order; ++k) {
            const double share = 1.0 / (k + 1);
            Octet p0 = octet(0), p1 = p0, p2 = p0, q0 = p0, q1 = p0, q2 = p0, q3 = p0;
            for (int j = 0; j <= k; ++j) {
                const Octet a = w[0][k - j], b = w[1][k - j], c = w[2][k - j];
                const Octet x0 = q[0][j], x1 = q[1][j], x2 = q[2][j], x3 = q[3][j];
                p0 += w[1][j] * c;
                p1 += w[2][j] * a;
                p2 += w[0][j] * b;
                q0 += x1 * a + x2 * b + x3 * c;
                q1 += x0 * a + x2 * c - x3 * b;
                q2 += x0 * b + x3 * a - x1 * c;
                q3 += x0 * c + x1 * b - x2 * a;
            }
            Octet acceleration[3] = {gyroscopic[0] * p0, gyroscopic[1] * p1, gyroscopic[2] * p2};
            for (int n = 0; n < terms.axes; ++n) {
                Octet e0 = octet(0), e1 = e0, e2 = e0;
                for (int j = 0; j <= k; ++j) {
                    const Octet a = w[0][k - j], b = w[1][k - j], c = w[2][k - j];
                    e0 += e[n][1][j] * c - e[n][2][j] * b;
                    e1 += e[n][2][j] * a - e[n][0][j] * c;
                    e2 += e[n][0][j] * b - e[n][1][j] * a;
                }
                for (int i = 0; i < 3; ++i)
                    acceleration[i] +=
                        field[n][i][0] * e[n][0][k] + field[n][i][1] * e[n][1][k] + field[n][i][2] * e[n][2][k];
                e[n][0][k + 1] = e0 * share, e[n][1][k + 1] = e1 * share, e[n][2][k + 1] = e2 * share;
            }
            if (terms.torque && k == 0)
                for (int i = 0; i < 3; ++i) acceleration[i] += torque[i];
            if (terms.damping)
                for (int i = 0; i < 3; ++i)
                    acceleration[i] -= damping[i][0] * w[0][k] + damping[i][1] * w[1][k] + damping[i][2] * w[2][k];
            if (terms.spring) {
                const Octet &a = q[0][k], &b = q[1][k], &c = q[2][k], &d = q[3][k];
                r[0][k] = rest[0] * a + rest[1] * b + rest[2] * c + rest[3] * d;
                r[1][k] = rest[0] * b - rest[1] * a - rest[2] * d + rest[3] * c;
                r[2][k] = rest[0] * c + rest[1] * d - rest[2] * a - rest[3] * b;
                r[3][k] = rest[0] * d - rest[1] * c + rest[2] * b - rest[3] * a;
                Octet s0 = octet(0), s1 = s0, s2 = s0;
                for (int j = 0; j <= k; ++j) {
                    s0 += r[0][k - j] * r[1][j], s1 += r[0][k - j] * r[2][j], s2 += r[0][k - j] * r[3][j];
                }
                acceleration[0] -= stiffness[0] * s0;
                acceleration[1] -= stiffness[1] * s1;
                acceleration[2] -= stiffness[2] * s2;
            }
            for (int i = 0; i < 3; ++i) w[i][k + 1] = acceleration[i] * share;
            const double half = 0.5 * share;
            q[0][k + 1] = q0 * -half, q[1][k + 1] = q1 * half, q[2][k + 1] = q2 * half, q[3][k + 1] = q3 * half;
        }
    }
};

/// log2 x for x > 0, up to 0.09 too small, -1023 for 0: the bits of x as a number.
POLHODE_INLINE Octet rough_log2(const Octet& x) {
    const Octet shifted = from_bits(((bits(x) >> 12) & 0x0007'ffff'ffff'ffff) | bits(octet(0x1p52)));
    return (shifted - 0x1p52) * 0x1p-40 - 1023.0;
}

template <int components>
POLHODE_INLINE Octet largest(const Octet* const (&x)[components], int k) {
    Octet most = magnitude(x[0][k]);
    for (int i = 1; i < components; ++i) most = larger(most, magnitude(x[i][k]));
    return most;
}

/// y += change, keeping what rounding took (Kahan's summation after Neumaier 1974; |change| may exceed |y|).
POLHODE_INLINE void add(Octet& y, Octet& lost, Octet change) {
    change += lost;
    const Octet sum = y + change, back = sum - y;
    lost = (y - (sum - back)) + (change - back);
    y = sum;
}

}  // namespace loaded_octet

/// Moves each body under its own loads. A body's lane is given to the next as soon as it has arrived.
template <int order>
POLHODE_INLINE void advance_loaded(LoadedLane* bodies, std::size_t count, const LoadTerms& terms,
                                   const LaneSteps& steps) {
    using namespace loaded_octet;
    constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
    const double span = steps.span;
    Series<order> s;
    Octet time = octet(0), lost_w[3], lost_q[4];
    std::size_t held[8];
    std::size_t next = 0, busy = 0;
    const auto zero = octet(0);
    for (auto* block : {&s.w[0][0], &s.w[1][0], &s.w[2][0], &s.q[1][0], &s.q[2][0], &s.q[3][0]}) *block = zero;
    s.q[0][0] = octet(1);
    for (int i = 0; i < 3; ++i) {
        s.gyroscopic[i] = s.torque[i] = s.stiffness[i] = lost_w[i] = zero;
        for (int j = 0; j < 3; ++j) {
            s.damping[i][j] = zero;
            for (int n = 0; n < 3; ++n) s.field[n][i][j] = zero;
        }
    }
    for (int i = 0; i < 4; ++i) s.rest[i] = lost_q[i] = zero;
    Octet taken = zero;  // steps
    // the lanes' next bodies; a lane without one stays at rest, at the end of its time
    const auto fill = [&](int l) {
        held[l] = next < count ? next++ : none;
        static constexpr LoadedLane idle{};
        const LoadedLane& b = held[l] == none ? idle : bodies[held[l]];
        busy += held[l] != none;
        time.v[l] = held[l] == none ? span : 0;
        taken.v[l] = 0;
        for (int i = 0; i < 3; ++i) {
            s.w[i][0].v[l] = b.w[i], s.gyroscopic[i].v[l] = b.gyroscopic[i], lost_w[i].v[l] = 0;
            s.torque[i].v[l] = b.torque[i], s.stiffness[i].v[l] = b.stiffness[i];
            for (int j = 0; j < 3; ++j) {
                s.damping[i][j].v[l] = b.damping[i][j];
                for (int n = 0; n < terms.axes; ++n) s.field[n][i][j].v[l] = b.field[n][i][j];
            }
        }
        for (int i = 0; i < 4; ++i) s.q[i][0].v[l] = b.q[i], s.rest[i].v[l] = b.rest[i], lost_q[i].v[l] = 0;
    };
    for (int l = 0; l < 8; ++l) fill(l);

    const Octet log_tolerance = rough_log2(octet(steps.tolerance));
    while (busy > 0) {
        s.expand(terms);
        const Octet* const w[3] = {s.w[0], s.w[1], s.w[2]};
        const Octet* const q[4] = {s.q[0], s.q[1], s.q[2], s.q[3]};
        // w against itself, or against what it reaches in the time that it takes to turn by a radian
        const Octet w0 = larger(largest(w, 0), square_root(largest(w, 1)));
        const Octet inverse_w = 1.0 / larger(w0, octet(1e-100));
        const Octet last = larger(largest(w, order) * inverse_w, largest(q, order));
        const Octet before = larger(largest(w, order - 1) * inverse_w, largest(q, order - 1));
        constexpr double ln2 = 0x1.62e42fefa39efp-1;
        const Octet exponent = smaller((log_tolerance - rough_log2(last)) * (1.0 / order),
                                       (log_tolerance - rough_log2(before)) * (1.0 / (order - 1)));
        const Octet remaining = span - time;
        Octet h = exponential(exponent * ln2);
        const OctetMask arrives = remaining <= h;
        h = select(arrives, remaining, h);
        time = select(arrives, octet(span), time + h);
        taken = taken + 1.0;
        Octet check = zero;
        for (int i = 0; i < 7; ++i) {
            const Octet* const y = i < 3 ? w[i] : q[i - 3];
            Octet change = y[order];
            for (int k = order - 1; k >= 1; --k) change = change * h + y[k];
            Octet& now = i < 3 ? s.w[i][0] : s.q[i - 3][0];
            add(now, i < 3 ? lost_w[i] : lost_q[i - 3], change * h);
            check += now * 0.0;
        }
        const Octet ended = select(
            check == zero, select(arrives, octet(1), select(taken < octet(steps.max_steps), zero, octet(3))), octet(2));
        if (!any(ended > zero)) continue;
        for (int l = 0; l < 8; ++l) {
            if (held[l] == none || ended.v[l] == 0) continue;
            LoadedLane& b = bodies[held[l]];
            for (int i = 0; i < 3; ++i) b.w[i] = s.w[i][0].v[l];
            for (int i = 0; i < 4; ++i) b.q[i] = s.q[i][0].v[l];
            b.steps += static_cast<long>(taken.v[l]);
            b.end = ended.v[l] == 1   ? LoadedLane::End::reached
                    : ended.v[l] == 2 ? LoadedLane::End::not_finite
                                      : LoadedLane::End::too_many_steps;
            b.reached = time.v[l];
            --busy;
            fill(l);
        }
    }
}

}  // namespace polhode
