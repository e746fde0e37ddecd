// Taylor coefficients of a rotation in principal axes, one step's worth.
//
//   w' = g o (w_2 w_3, w_3 w_1, w_1 w_2) + I^-1 (tau - D w + sum_b (m_b x e_b + tau_W,b e_b) - 2 k r_w r_vec)
//   q' = 1/2 q (0, w)              e_b' = e_b x w              r = rest* q
//
// e_b is the world's axis b in the body. A product's k-th coefficient is the Cauchy sum of its factors' first k + 1
// (Moore 1966), and (k + 1) y_{k+1} = f_k. The products of one term stand in eight lanes: twelve of q and w beside
// three of w and w in two registers, six of e and w in one. With u = (w_2, w_3, w_1) and v = (w_3, w_1, w_2):
//
//   (q | q) (w_1 .. | w_2 ..)      (q | u) (w_3 .. | v)      (e_u | e_v) (v | u)
//
// Degrees and loads are compile-time and run-time loops: unrolled in full the same sums take twice as long, their code
// no longer fits the first cache.
#pragma once

#include <array>

#include "integrators/lanes/lanes.h"
#include "motion/equations.h"

namespace polhode {

/// Eight lanes as two registers of four, where there are no wider ones.
struct LanePair {
    Lanes4 low, high;
};

// What a series does with eight lanes, for both.
POLHODE_INLINE Lanes4 low(const Lanes8& x) { return __builtin_shufflevector(x, x, 0, 1, 2, 3); }
POLHODE_INLINE Lanes4 high(const Lanes8& x) { return __builtin_shufflevector(x, x, 4, 5, 6, 7); }
POLHODE_INLINE void join(const Lanes4& a, const Lanes4& b, Lanes8& x) {
    x = __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
}
POLHODE_INLINE void add_product(const Lanes8& a, const Lanes8& b, Lanes8& sum) { sum += a * b; }
POLHODE_INLINE void add_scaled(const Lanes8& a, double factor, Lanes8& sum) { sum = sum * factor + a; }

POLHODE_INLINE Lanes4 low(const LanePair& x) { return x.low; }
POLHODE_INLINE Lanes4 high(const LanePair& x) { return x.high; }
POLHODE_INLINE void join(const Lanes4& a, const Lanes4& b, LanePair& x) { x.low = a, x.high = b; }
POLHODE_INLINE void add_product(const LanePair& a, const LanePair& b, LanePair& sum) {
    sum.low += a.low * b.low, sum.high += a.high * b.high;
}
POLHODE_INLINE void add_scaled(const LanePair& a, double factor, LanePair& sum) {
    sum.low = sum.low * factor + a.low, sum.high = sum.high * factor + a.high;
}

/// A motion as the series keep it: (q | u).
struct alignas(64) PackedRotation {
    std::array<double, 8> lane{};

    PackedRotation() = default;
    /// y: w (rad/s, principal axes), then q.
    explicit PackedRotation(const double* y) : lane{y[3], y[4], y[5], y[6], y[1], y[2], y[0], 0} {}
    void unpack(double* y) const {
        y[0] = lane[6], y[1] = lane[4], y[2] = lane[5];
        for (std::size_t i = 0; i < 4; ++i) y[3 + i] = lane[i];
    }
};

/// `careful`: coefficients are divided by k + 1. Else the rounded 1/(k + 1) multiplies them: quicker, but its error is
/// the same in every step (free asymmetric body, order 24, t = 10^4: energy to 1.5e-15 so and 4e-16 with care).
template <int order, class Wide, bool careful = false>
class RotationSeries {
  public:
    /// Whether these loads are among those above.
    static bool serves(const Forcing<double>& f) {
        return f.world_points.empty() && f.user_torques.empty() && f.springs.size() <= 1;
    }

    explicit RotationSeries(const PrincipalInertia<double>& inertia) {
        const Vector3<double>&g = inertia.gyroscopic, &r = inertia.inverse_moments;
        gyroscopic_ = Lanes4{g[0], g[1], g[2], 0};
        inverse_ = Lanes4{r[0], r[1], r[2], 0};
    }

    /// The loads from now on.
    void set(const Forcing<double>& f) {
        constant_ = Lanes4{f.torque[0], f.torque[1], f.torque[2], 0} * inverse_;
        has_constant_ = f.has_torque;
        has_damping_ = f.has_damping;
        for (int j = 0; j < 3; ++j)
            damping_[j] = Lanes4{f.damping[0][j], f.damping[1][j], f.damping[2][j], 0} * inverse_;
        axes_ = 0;
        has_along_ = false;
        for (int b = 0; b < 3; ++b) {
            const double along = f.has_world_torque ? f.torque_W[b] : 0;
            if (!f.field.present[b] && along == 0) continue;
            const Vector3<double>& m = f.field.moment[b];
            axis_[axes_] = b;
            // m x e, with e permuted as above
            moment_u_[axes_] = Lanes4{m[1], m[2], m[0], 0} * inverse_;
            moment_v_[axes_] = Lanes4{m[2], m[0], m[1], 0} * inverse_;
            along_[axes_] = Lanes4{along, along, along, 0} * inverse_;
            has_along_ = has_along_ || along != 0;
            ++axes_;
        }
        has_spring_ = !f.springs.empty();
        if (!has_spring_) return;
        stiffness_ = f.springs[0].stiffness;
        // columns of q -> r = rest* q, as (x, y, z, w)
        const Quaternion<double> s = conjugate(f.springs[0].rest);
        turn_ = {Lanes4{s.x, s.y, s.z, s.w}, Lanes4{s.w, s.z, -s.y, -s.x}, Lanes4{-s.z, s.w, s.x, -s.y},
                 Lanes4{s.y, -s.x, s.w, -s.z}};
    }

    /// Coefficients 0..order of the motion that starts at `state`.
    POLHODE_INLINE void expand(const PackedRotation& state) {
        const std::array<double, 8>& y = state.lane;
        const Terms first = spread(Lanes4{y[6], y[4], y[5], 0}, Lanes4{y[0], y[1], y[2], y[3]});
        Terms newest = first;
        keep(0, first);
        for (int n = 0; n < axes_; ++n) {
            const Vector3<double> e = world_axis(Quaternion<double>{y[0], y[1], y[2], y[3]}, axis_[n]);
            keep_axis(n, 0, Lanes4{e[0], e[1], e[2], 0});
        }
        const Lanes4 zero{0, 0, 0, 0};
        Wide none{};
        join(zero, zero, none);
        for (int k = 0; k < order; ++k) {
            // from the middle outward: the newest coefficients come last, so that a degree's sums begin before the
            // degree before has ended
            const int middle = k / 2;
            const bool even = k % 2 == 0;
            Wide s = none, t = none, x = none, z = none;
            if (even) add_product(qq_[middle], w12_[middle], s), add_product(qu_[middle], w3v_[middle], x);
            for (int j = middle - even, i = k - j; j > 0; --j, ++i) {
                add_product(qq_[j], w12_[i], s), add_product(qu_[j], w3v_[i], x);
                add_product(qq_[i], w12_[j], t), add_product(qu_[i], w3v_[j], z);
            }
            if (k > 0) {
                add_product(first.qq, newest.w12, s), add_product(first.qu, newest.w3v, x);
                add_product(newest.qq, first.w12, t), add_product(newest.qu, first.w3v, z);
            }
            Lanes4 acceleration = gyroscopic_ * (high(x) + high(z));
            if (has_constant_ && k == 0) acceleration += constant_;
            if (has_damping_) add_damping(k, acceleration);
            for (int n = 0; n < axes_; ++n) {
                acceleration += moment_u_[n] * high(axis_uv_[n][k]) - moment_v_[n] * low(axis_uv_[n][k]);
                if (has_along_) acceleration += along_[n] * axis_e_[n][k];
                Wide e = none, f = none;
                if (even) add_product(axis_uv_[n][middle], vu_[middle], e);
                for (int j = middle - even, i = k - j; j > 0; --j, ++i)
                    add_product(axis_uv_[n][j], vu_[i], e), add_product(axis_uv_[n][i], vu_[j], f);
                if (k > 0) {
                    add_product(axis_uv_[n][0], newest.vu, e), add_product(axis_uv_[n][k], first.vu, f);
                }
                Lanes4 change = (low(e) + low(f)) - (high(e) + high(f));
                share(k, change);
                keep_axis(n, k + 1, change);
            }
            if (has_spring_) add_spring(k, acceleration);
            const Lanes4 a = low(s) + low(t), b = high(s) + high(t), c = low(x) + low(z);
            Lanes4 turning = (__builtin_shufflevector(a, a, 1, 0, 3, 2) * Lanes4{-0.5, 0.5, 0.5, -0.5} +
                              __builtin_shufflevector(b, b, 2, 3, 0, 1) * Lanes4{-0.5, -0.5, 0.5, 0.5}) +
                             __builtin_shufflevector(c, c, 3, 2, 1, 0) * Lanes4{-0.5, 0.5, -0.5, 0.5};
            share(k, acceleration), share(k, turning);
            newest = spread(acceleration, turning);
            keep(k + 1, newest);
        }
    }

    /// Component i of the k-th coefficients of w (rad/s^(k+1)) and of q (1/s^k).
    double rate(int k, int i) const { return high(qu_[k])[(i + 2) % 3]; }
    double attitude(int k, int i) const { return low(qu_[k])[i]; }
    /// Lengths of both, squared.
    double squared_rate(int k) const { return squared(high(qu_[k])); }
    double squared_attitude(int k) const { return squared(low(qu_[k])); }

    /// The state a time h after the expansion; `lost`: what rounding has kept out of the state (Kahan 1965), brought up
    /// to date. Even and odd degrees beside each other.
    POLHODE_INLINE void move(double h, PackedRotation& state, PackedRotation& lost) const {
        static_assert(order % 2 == 0);
        const double hh = h * h;
        Wide even = qu_[order], odd = qu_[order - 1];
        for (int k = order - 2; k >= 2; k -= 2) add_scaled(qu_[k], hh, even), add_scaled(qu_[k - 1], hh, odd);
        const Lanes4 dq = low(odd) * h + low(even) * hh, du = high(odd) * h + high(even) * hh;
        add_compensated(dq, &state.lane[0], &lost.lane[0]);
        add_compensated(du, &state.lane[4], &lost.lane[4]);
    }

    /// The sum of y_k h^(k - from) from k = from on: w, then q.
    template <int from>
    POLHODE_INLINE void tail(double h, double* sum) const {
        static_assert(order % 2 == 0 && from % 2 == 1 && from < order);
        const double hh = h * h;
        Wide even = qu_[order], odd = qu_[order - 1];
        for (int k = order - 2; k > from; k -= 2) add_scaled(qu_[k], hh, even), add_scaled(qu_[k - 1], hh, odd);
        const Lanes4 dq = low(odd) + low(even) * h, du = high(odd) + high(even) * h;
        sum[0] = du[2], sum[1] = du[0], sum[2] = du[1];
        for (int i = 0; i < 4; ++i) sum[3 + i] = dq[i];
    }

  private:
    static constexpr std::array<double, order + 1> reciprocals() {
        std::array<double, order + 1> r{};
        for (int i = 1; i <= order; ++i) r[static_cast<std::size_t>(i)] = 1.0 / i;
        return r;
    }
    static constexpr std::array<double, order + 1> reciprocal = reciprocals();

    POLHODE_INLINE static void add_compensated(const Lanes4& increment, double* sum, double* lost) {
        Lanes4 before, rest;
        for (int i = 0; i < 4; ++i) before[i] = sum[i], rest[i] = lost[i];
        const Lanes4 corrected = increment + rest, after = before + corrected, kept = after - before;
        rest = (before - (after - kept)) + (corrected - kept);
        for (int i = 0; i < 4; ++i) sum[i] = after[i], lost[i] = rest[i];
    }
    /// y_{k+1} of f_k
    POLHODE_INLINE static void share(int k, Lanes4& f) {
        if constexpr (careful)
            f /= k + 1.0;
        else
            f *= reciprocal[k + 1];
    }
    static double squared(const Lanes4& v) { return (v[0] * v[0] + v[1] * v[1]) + (v[2] * v[2] + v[3] * v[3]); }

    /// One coefficient of w and q as products need it.
    struct Terms {
        Wide qq, w12, qu, w3v, vu;
    };
    POLHODE_INLINE static Terms spread(const Lanes4& w, const Lanes4& q) {
        const Lanes4 u = __builtin_shufflevector(w, w, 1, 2, 0, 3), v = __builtin_shufflevector(w, w, 2, 0, 1, 3);
        const Lanes4 w1 = __builtin_shufflevector(w, w, 0, 0, 0, 0), w2 = __builtin_shufflevector(w, w, 1, 1, 1, 1);
        const Lanes4 w3 = __builtin_shufflevector(w, w, 2, 2, 2, 2);
        Terms terms{};
        join(q, q, terms.qq), join(w1, w2, terms.w12), join(q, u, terms.qu), join(w3, v, terms.w3v);
        join(v, u, terms.vu);
        return terms;
    }
    POLHODE_INLINE void keep(int k, const Terms& terms) {
        qq_[k] = terms.qq, w12_[k] = terms.w12, qu_[k] = terms.qu, w3v_[k] = terms.w3v, vu_[k] = terms.vu;
    }
    POLHODE_INLINE void keep_axis(int n, int k, const Lanes4& e) {
        axis_e_[n][k] = e;
        join(__builtin_shufflevector(e, e, 1, 2, 0, 3), __builtin_shufflevector(e, e, 2, 0, 1, 3), axis_uv_[n][k]);
    }
    POLHODE_INLINE void add_damping(int k, Lanes4& acceleration) const {
        acceleration -= (damping_[0] * low(w12_[k]) + damping_[1] * high(w12_[k])) + damping_[2] * low(w3v_[k]);
    }
    // plus the k-th coefficient of I^-1 (-2 k r_w r_vec)
    POLHODE_INLINE void add_spring(int k, Lanes4& acceleration) {
        const Lanes4 q = low(qu_[k]);
        turned_[k] = (turn_[0] * q[0] + turn_[1] * q[1]) + (turn_[2] * q[2] + turn_[3] * q[3]);
        turned_scalar_[k] = turned_[k][3];
        Lanes4 s{0, 0, 0, 0}, t = s;
        for (int j = 0, i = k; j < i; ++j, --i)
            s += turned_scalar_[i] * turned_[j], t += turned_scalar_[j] * turned_[i];
        if (k % 2 == 0) s += turned_scalar_[k / 2] * turned_[k / 2];
        acceleration += (s + t) * (-2 * stiffness_) * inverse_;
    }

    Lanes4 gyroscopic_{}, inverse_{}, constant_{};
    std::array<Lanes4, 3> damping_{}, moment_u_{}, moment_v_{}, along_{};
    std::array<int, 3> axis_{};
    int axes_ = 0;
    bool has_constant_ = false, has_damping_ = false, has_along_ = false, has_spring_ = false;
    double stiffness_ = 0;
    std::array<Lanes4, 4> turn_{};

    template <class T>
    using Coefficients = std::array<T, order + 1>;
    Coefficients<Wide> qq_{}, w12_{}, qu_{}, w3v_{}, vu_{};
    std::array<Coefficients<Wide>, 3> axis_uv_{};
    std::array<Coefficients<Lanes4>, 3> axis_e_{};
    Coefficients<Lanes4> turned_{};
    Coefficients<double> turned_scalar_{};
};

}  // namespace polhode
