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

#include "integrators/lanes/lane_math.h"

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
    double least_rate = 0;                   ///< rad/s: a step's error in w is relative to this at least
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

/// Row `axis` of the rotation matrix of q: the world's axis in the body.
POLHODE_INLINE void world_axis(int axis, const Octet& a, const Octet& b, const Octet& c, const Octet& d, Octet& along,
                               Octet& second, Octet& third) {
    const int i = axis, j = (i + 1) % 3, k = (i + 2) % 3;
    const Octet v[3] = {b, c, d};
    along = a * a + (v[i] * v[i] - v[j] * v[j] - v[k] * v[k]);
    const Octet ij = v[i] * v[j], ak = a * v[k], ik = v[i] * v[k], aj = a * v[j];
    second = (ij - ak) + (ij - ak);
    third = (ik + aj) + (ik + aj);
}

/// Any body; `with_axis`: terms.axes > 0.
template <int degree, bool with_axis>
struct Series {
    static constexpr int order = degree, rates = 3;
    Octet w[3][order + 1], q[4][order + 1], e[3][3][order + 1], r[4][order + 1];
    Octet gyroscopic[3], torque[3], damping[3][3], field[3][3][3], stiffness[3], rest[4];

    static_assert(order % 2 == 0);

    POLHODE_INLINE void load(int l, const LoadedLane& b, const LoadTerms& terms) {
        for (int i = 0; i < 3; ++i) {
            w[i][0].v[l] = b.w[i], gyroscopic[i].v[l] = b.gyroscopic[i];
            torque[i].v[l] = b.torque[i], stiffness[i].v[l] = b.stiffness[i];
            for (int j = 0; j < 3; ++j) {
                damping[i][j].v[l] = b.damping[i][j];
                for (int n = 0; n < terms.axes; ++n) field[n][i][j].v[l] = b.field[n][i][j];
            }
        }
        for (int i = 0; i < 4; ++i) q[i][0].v[l] = b.q[i], rest[i].v[l] = b.rest[i];
    }

    /// Coefficients 1..order from w[.][0], q[.][0].
    POLHODE_INLINE void expand(const LoadTerms& terms) {
        for (int n = 0; n < terms.axes; ++n) {
            const int i = terms.axis[n], j = (i + 1) % 3, k = (i + 2) % 3;
            world_axis(i, q[0][0], q[1][0], q[2][0], q[3][0], e[n][i][0], e[n][j][0], e[n][k][0]);
        }
        // two orders a pass over the coefficients: what is loaded serves both
        for (int k = 0; k < order; k += 2) {
            Sums now{}, next{};
            Octet a = w[0][k], b = w[1][k], c = w[2][k];
            accumulate(now, 0, a, b, c);
            for (int j = 1; j <= k; ++j) {
                accumulate(next, j, a, b, c);
                a = w[0][k - j], b = w[1][k - j], c = w[2][k - j];
                accumulate(now, j, a, b, c);
            }
            finish(now, k, terms);
            accumulate(next, 0, w[0][k + 1], w[1][k + 1], w[2][k + 1]);
            accumulate(next, k + 1, w[0][0], w[1][0], w[2][0]);
            finish(next, k + 1, terms);
        }
    }

  private:
    struct Sums {
        Octet p0, p1, p2, q0, q1, q2, q3, e0, e1, e2;
    };

    /// Adds the products of the j-th coefficients and those of w given.
    POLHODE_INLINE void accumulate(Sums& s, int j, const Octet& a, const Octet& b, const Octet& c) const {
        const Octet x0 = q[0][j], x1 = q[1][j], x2 = q[2][j], x3 = q[3][j];
        s.p0 += w[1][j] * c;
        s.p1 += w[2][j] * a;
        s.p2 += w[0][j] * b;
        s.q0 += x1 * a + x2 * b + x3 * c;
        s.q1 += x0 * a + x2 * c - x3 * b;
        s.q2 += x0 * b + x3 * a - x1 * c;
        s.q3 += x0 * c + x1 * b - x2 * a;
        if constexpr (with_axis) {
            const Octet y0 = e[0][0][j], y1 = e[0][1][j], y2 = e[0][2][j];
            s.e0 += y1 * c - y2 * b;
            s.e1 += y2 * a - y0 * c;
            s.e2 += y0 * b - y1 * a;
        }
    }

    /// Coefficients k + 1 from the sums of order k.
    POLHODE_INLINE void finish(const Sums& sums, int k, const LoadTerms& terms) {
        const double share = 1.0 / (k + 1);
        Octet acceleration[3] = {gyroscopic[0] * sums.p0, gyroscopic[1] * sums.p1, gyroscopic[2] * sums.p2};
        if constexpr (with_axis) {
            e[0][0][k + 1] = sums.e0 * share, e[0][1][k + 1] = sums.e1 * share, e[0][2][k + 1] = sums.e2 * share;
            for (int n = 0; n < terms.axes; ++n) {
                for (int i = 0; i < 3; ++i)
                    acceleration[i] +=
                        field[n][i][0] * e[n][0][k] + field[n][i][1] * e[n][1][k] + field[n][i][2] * e[n][2][k];
                if (n == 0) continue;
                Octet e0 = octet(0), e1 = e0, e2 = e0;
                for (int j = 0; j <= k; ++j) {
                    const Octet a = w[0][k - j], b = w[1][k - j], c = w[2][k - j];
                    e0 += e[n][1][j] * c - e[n][2][j] * b;
                    e1 += e[n][2][j] * a - e[n][0][j] * c;
                    e2 += e[n][0][j] * b - e[n][1][j] * a;
                }
                e[n][0][k + 1] = e0 * share, e[n][1][k + 1] = e1 * share, e[n][2][k + 1] = e2 * share;
            }
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
            for (int j = 0; j <= k; ++j)
                s0 += r[0][k - j] * r[1][j], s1 += r[0][k - j] * r[2][j], s2 += r[0][k - j] * r[3][j];
            acceleration[0] -= stiffness[0] * s0;
            acceleration[1] -= stiffness[1] * s1;
            acceleration[2] -= stiffness[2] * s2;
        }
        for (int i = 0; i < 3; ++i) w[i][k + 1] = acceleration[i] * share;
        const double half = 0.5 * share;
        q[0][k + 1] = sums.q0 * -half, q[1][k + 1] = sums.q1 * half, q[2][k + 1] = sums.q2 * half;
        q[3][k + 1] = sums.q3 * half;
    }
};

/// A body whose moments across axis 3 are equal, under fields whose moments lie along it, in axes that do not spin:
///   u_1' = -c u_2 - sum_b mu_b e_b,2,  u_2' = c u_1 + sum_b mu_b e_b,1,  e_b' = e_b x u,  q' = 1/2 q (0, u),  u_3 = 0
/// with c = I_3 w_3/I_1, mu_b = m_b,3/I_1 and w_3 constant. The body has turned by w_3 t about axis 3 against them. Of
/// LoadedLane, gyroscopic[0] is c and field[b][0][0] is mu_b.
template <int degree>
struct SymmetricSeries {
    static constexpr int order = degree, rates = 2;
    static_assert(order % 2 == 0);
    Octet w[2][order + 1], q[4][order + 1], e[3][3][order + 1];
    Octet spin, field[3];

    POLHODE_INLINE void load(int l, const LoadedLane& b, const LoadTerms& terms) {
        w[0][0].v[l] = b.w[0], w[1][0].v[l] = b.w[1];
        spin.v[l] = b.gyroscopic[0];
        for (int n = 0; n < terms.axes; ++n) field[n].v[l] = b.field[n][0][0];
        for (int i = 0; i < 4; ++i) q[i][0].v[l] = b.q[i];
    }

    POLHODE_INLINE void expand(const LoadTerms& terms) {
        for (int n = 0; n < terms.axes; ++n) {
            const int i = terms.axis[n], j = (i + 1) % 3, k = (i + 2) % 3;
            world_axis(i, q[0][0], q[1][0], q[2][0], q[3][0], e[n][i][0], e[n][j][0], e[n][k][0]);
        }
        for (int k = 0; k < order; k += 2) {
            Sums now{}, next{};
            Octet a = w[0][k], b = w[1][k];
            accumulate(now, 0, a, b);
            for (int j = 1; j <= k; ++j) {
                accumulate(next, j, a, b);
                a = w[0][k - j], b = w[1][k - j];
                accumulate(now, j, a, b);
            }
            finish(now, k, terms);
            accumulate(next, 0, w[0][k + 1], w[1][k + 1]);
            accumulate(next, k + 1, w[0][0], w[1][0]);
            finish(next, k + 1, terms);
        }
    }

  private:
    struct Sums {
        Octet q0, q1, q2, q3, e0, e1, e2;
    };

    POLHODE_INLINE void accumulate(Sums& s, int j, const Octet& a, const Octet& b) const {
        const Octet x0 = q[0][j], x1 = q[1][j], x2 = q[2][j], x3 = q[3][j];
        s.q0 += x1 * a + x2 * b;
        s.q1 += x0 * a - x3 * b;
        s.q2 += x0 * b + x3 * a;
        s.q3 += x1 * b - x2 * a;
        s.e0 += e[0][2][j] * b;
        s.e1 += e[0][2][j] * a;
        s.e2 += e[0][0][j] * b - e[0][1][j] * a;
    }

    POLHODE_INLINE void finish(const Sums& s, int k, const LoadTerms& terms) {
        const double share = 1.0 / (k + 1), half = 0.5 * share;
        e[0][0][k + 1] = s.e0 * -share, e[0][1][k + 1] = s.e1 * share, e[0][2][k + 1] = s.e2 * share;
        Octet across = spin * w[1][k] + field[0] * e[0][1][k], along = spin * w[0][k] + field[0] * e[0][0][k];
        for (int n = 1; n < terms.axes; ++n) {
            across += field[n] * e[n][1][k], along += field[n] * e[n][0][k];
            Octet e0 = octet(0), e1 = e0, e2 = e0;
            for (int j = 0; j <= k; ++j) {
                const Octet a = w[0][k - j], b = w[1][k - j];
                e0 += e[n][2][j] * b;
                e1 += e[n][2][j] * a;
                e2 += e[n][0][j] * b - e[n][1][j] * a;
            }
            e[n][0][k + 1] = e0 * -share, e[n][1][k + 1] = e1 * share, e[n][2][k + 1] = e2 * share;
        }
        w[0][k + 1] = across * -share, w[1][k + 1] = along * share;
        q[0][k + 1] = s.q0 * -half, q[1][k + 1] = s.q1 * half, q[2][k + 1] = s.q2 * half, q[3][k + 1] = s.q3 * half;
    }
};

/// log2 x for x > 0, up to 0.09 too small, -1023 for 0: the bits of x as a number.
POLHODE_INLINE Octet rough_log2(const Octet& x) {
    const Octet shifted = from_bits(((bits(x) >> 12) & 0x0007'ffff'ffff'ffff) | bits(octet(0x1p52)));
    return (shifted - 0x1p52) * 0x1p-40 - 1023.0;
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
template <class Series>
POLHODE_INLINE void advance_loaded(LoadedLane* bodies, std::size_t count, const LoadTerms& terms,
                                   const LaneSteps& steps) {
    using namespace loaded_octet;
    constexpr int order = Series::order, rates = Series::rates;
    constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
    const double span = steps.span;
    const Octet zero = octet(0);
    Series s{};
    Octet time = zero, taken = zero, least_rate = zero, lost_w[3] = {zero, zero, zero};
    Octet lost_q[4] = {zero, zero, zero, zero};
    std::size_t held[8];
    std::size_t next = 0, busy = 0;
    // the lanes' next bodies; a lane without one stays at rest, at the end of its time
    const auto fill = [&](int l) {
        held[l] = next < count ? next++ : none;
        static constexpr LoadedLane idle{};
        const bool held_one = held[l] != none;
        const LoadedLane& b = held_one ? bodies[held[l]] : idle;
        busy += held_one ? 1 : 0;
        time.v[l] = held_one ? 0 : span;
        taken.v[l] = 0, least_rate.v[l] = b.least_rate;
        for (int i = 0; i < 3; ++i) lost_w[i].v[l] = 0;
        for (int i = 0; i < 4; ++i) lost_q[i].v[l] = 0;
        s.load(l, b, terms);
    };
    for (int l = 0; l < 8; ++l) fill(l);

    const Octet log_tolerance = rough_log2(octet(steps.tolerance));
    while (busy > 0) {
        s.expand(terms);
        Octet w_size[3] = {zero, zero, zero}, q_size[2] = {zero, zero};  // coefficients 0, N - 1, N
        Octet acceleration = zero;
        for (int i = 0; i < rates; ++i) {
            w_size[0] = larger(w_size[0], magnitude(s.w[i][0])),
            acceleration = larger(acceleration, magnitude(s.w[i][1]));
            w_size[1] = larger(w_size[1], magnitude(s.w[i][order - 1]));
            w_size[2] = larger(w_size[2], magnitude(s.w[i][order]));
        }
        for (int i = 0; i < 4; ++i) {
            q_size[0] = larger(q_size[0], magnitude(s.q[i][order - 1]));
            q_size[1] = larger(q_size[1], magnitude(s.q[i][order]));
        }
        // w against itself, or against what it reaches in the time that it takes to turn by a radian
        const Octet rate = larger(larger(w_size[0], square_root(acceleration)), larger(least_rate, octet(1e-100)));
        const Octet inverse_rate = 1.0 / rate;
        const Octet before = larger(w_size[1] * inverse_rate, q_size[0]);
        const Octet last = larger(w_size[2] * inverse_rate, q_size[1]);
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
        for (int i = 0; i < rates + 4; ++i) {
            Octet* const y = i < rates ? s.w[i] : s.q[i - rates];
            Octet change = y[order];
            for (int k = order - 1; k >= 1; --k) change = change * h + y[k];
            add(y[0], i < rates ? lost_w[i] : lost_q[i - rates], change * h);
            check += y[0] * 0.0;
        }
        const Octet unfinished = select(taken < octet(steps.max_steps), zero, octet(3));
        const Octet ended = select(check == zero, select(arrives, octet(1), unfinished), octet(2));
        if (!any(ended > zero)) continue;
        for (int l = 0; l < 8; ++l) {
            if (held[l] == none || ended.v[l] == 0) continue;
            LoadedLane& b = bodies[held[l]];
            for (int i = 0; i < rates; ++i) b.w[i] = s.w[i][0].v[l];
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
