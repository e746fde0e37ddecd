// Taylor coefficients of a rotation in principal axes, one step's worth, in four lanes at a time.
//
//   w' = g o (w_2 w_3, w_3 w_1, w_1 w_2) + I^-1 (tau - D w + sum_b (m_b x e_b + tau_W,b e_b) - 2 k r_w r_vec)
//   q' = 1/2 q (0, w)              e_b' = e_b x w              r = rest* q
//
// e_b is the world's axis b in the body. A product's k-th coefficient is the Cauchy sum of its factors' first k + 1
// (Moore 1966), and (k + 1) y_{k+1} = f_k; sums of even and of odd terms run beside each other, in one fixed order.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "integrators/kernels/lanes.h"
#include "motion/equations.h"

namespace polhode {

template <int order>
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
        for (int b = 0; b < 3; ++b) {
            const double along = f.has_world_torque ? f.torque_W[b] : 0;
            if (!f.field.present[b] && along == 0) continue;
            const Vector3<double>& m = f.field.moment[b];
            axis_[axes_] = b;
            // m x e, with e permuted as below
            moment_u_[axes_] = Lanes4{m[1], m[2], m[0], 0} * inverse_;
            moment_v_[axes_] = Lanes4{m[2], m[0], m[1], 0} * inverse_;
            along_[axes_] = Lanes4{along, along, along, 0} * inverse_;
            ++axes_;
        }
        has_spring_ = !f.springs.empty();
        if (has_spring_) {
            stiffness_ = f.springs[0].stiffness;
            rest_ = f.springs[0].rest;
        }
    }

    /// Coefficients 0..order of the motion that starts at w (rad/s, principal axes) and q.
    [[gnu::always_inline]] inline void expand(const Lanes4& w, const Lanes4& q) {
        keep_rate(0, w);
        q_[0] = q;
        for (int n = 0; n < axes_; ++n) {
            const Vector3<double> e = world_axis(Quaternion<double>{q[0], q[1], q[2], q[3]}, axis_[n]);
            keep_axis(n, 0, Lanes4{e[0], e[1], e[2], 0});
        }
        for (int k = 0; k < order; ++k) {
            const Lanes4 zero{0, 0, 0, 0};
            Lanes4 p0 = zero, p1 = zero, a0 = zero, a1 = zero, b0 = zero, b1 = zero, c0 = zero, c1 = zero;
            int j = 0;
            for (; j + 1 <= k; j += 2) {
                p0 += u_[j] * v_[k - j], p1 += u_[j + 1] * v_[k - j - 1];
                a0 += rate_[0][k - j] * q_[j], a1 += rate_[0][k - j - 1] * q_[j + 1];
                b0 += rate_[1][k - j] * q_[j], b1 += rate_[1][k - j - 1] * q_[j + 1];
                c0 += rate_[2][k - j] * q_[j], c1 += rate_[2][k - j - 1] * q_[j + 1];
            }
            if (j <= k) {
                p0 += u_[j] * v_[k - j];
                a0 += rate_[0][k - j] * q_[j], b0 += rate_[1][k - j] * q_[j], c0 += rate_[2][k - j] * q_[j];
            }
            p0 += p1, a0 += a1, b0 += b1, c0 += c1;
            Lanes4 acceleration = gyroscopic_ * p0;
            if (has_constant_ && k == 0) acceleration += constant_;
            if (has_damping_)
                acceleration -= (damping_[0] * rate_[0][k] + damping_[1] * rate_[1][k]) + damping_[2] * rate_[2][k];
            const double share = reciprocal[k + 1];
            for (int n = 0; n < axes_; ++n) {
                acceleration +=
                    (moment_u_[n] * axis_v_[n][k] - moment_v_[n] * axis_u_[n][k]) + along_[n] * axis_e_[n][k];
                Lanes4 e0 = zero, e1 = zero;
                for (j = 0; j + 1 <= k; j += 2) {
                    e0 += axis_u_[n][j] * v_[k - j] - axis_v_[n][j] * u_[k - j];
                    e1 += axis_u_[n][j + 1] * v_[k - j - 1] - axis_v_[n][j + 1] * u_[k - j - 1];
                }
                if (j <= k) e0 += axis_u_[n][j] * v_[k - j] - axis_v_[n][j] * u_[k - j];
                keep_axis(n, k + 1, (e0 + e1) * share);
            }
            if (has_spring_) add_spring(k, acceleration);
            keep_rate(k + 1, acceleration * share);
            const Lanes4 a = __builtin_shufflevector(a0, a0, 1, 0, 3, 2) * Lanes4{-1, 1, 1, -1};
            const Lanes4 b = __builtin_shufflevector(b0, b0, 2, 3, 0, 1) * Lanes4{-1, -1, 1, 1};
            const Lanes4 c = __builtin_shufflevector(c0, c0, 3, 2, 1, 0) * Lanes4{-1, 1, -1, 1};
            q_[k + 1] = ((a + b) + c) * (0.5 * share);
        }
    }

    /// What w and q have moved by a time h after the expansion.
    [[gnu::always_inline]] inline void increment(double h, Lanes4& w, Lanes4& q) const {
        w = w_[order], q = q_[order];
        for (int k = order - 1; k >= 1; --k) w = w * h + w_[k], q = q * h + q_[k];
        w *= h, q *= h;
    }
    const Lanes4& rate(int k) const { return w_[k]; }
    const Lanes4& attitude(int k) const { return q_[k]; }

  private:
    static constexpr std::array<double, order + 1> reciprocals() {
        std::array<double, order + 1> r{};
        for (int i = 1; i <= order; ++i) r[static_cast<std::size_t>(i)] = 1.0 / i;
        return r;
    }
    static constexpr std::array<double, order + 1> reciprocal = reciprocals();

    [[gnu::always_inline]] inline void keep_rate(int k, const Lanes4& w) {
        w_[k] = w;
        u_[k] = __builtin_shufflevector(w, w, 1, 2, 0, 3);
        v_[k] = __builtin_shufflevector(w, w, 2, 0, 1, 3);
        rate_[0][k] = w[0], rate_[1][k] = w[1], rate_[2][k] = w[2];
    }
    [[gnu::always_inline]] inline void keep_axis(int n, int k, const Lanes4& e) {
        axis_e_[n][k] = e;
        axis_u_[n][k] = __builtin_shufflevector(e, e, 1, 2, 0, 3);
        axis_v_[n][k] = __builtin_shufflevector(e, e, 2, 0, 1, 3);
    }
    // plus the k-th coefficient of I^-1 (-2 k r_w r_vec)
    [[gnu::always_inline]] inline void add_spring(int k, Lanes4& acceleration) {
        const Quaternion<double> r = conjugate(rest_) * Quaternion<double>{q_[k][0], q_[k][1], q_[k][2], q_[k][3]};
        turned_[k] = Lanes4{r.x, r.y, r.z, 0}, turned_scalar_[k] = r.w;
        Lanes4 s0{0, 0, 0, 0}, s1 = s0;
        int j = 0;
        for (; j + 1 <= k; j += 2)
            s0 += turned_scalar_[k - j] * turned_[j], s1 += turned_scalar_[k - j - 1] * turned_[j + 1];
        if (j <= k) s0 += turned_scalar_[k - j] * turned_[j];
        acceleration += (s0 + s1) * (-2 * stiffness_) * inverse_;
    }

    Lanes4 gyroscopic_{}, inverse_{}, constant_{};
    std::array<Lanes4, 3> damping_{}, moment_u_{}, moment_v_{}, along_{};
    std::array<int, 3> axis_{};
    int axes_ = 0;
    bool has_constant_ = false, has_damping_ = false, has_spring_ = false;
    double stiffness_ = 0;
    Quaternion<double> rest_;

    std::array<Lanes4, order + 1> w_{}, u_{}, v_{}, q_{}, turned_{};  ///< u, v: components 1, 2, 0 and 2, 0, 1 of w
    std::array<std::array<double, order + 1>, 3> rate_{};
    std::array<double, order + 1> turned_scalar_{};
    std::array<std::array<Lanes4, order + 1>, 3> axis_e_{}, axis_u_{}, axis_v_{};
};

}  // namespace polhode
