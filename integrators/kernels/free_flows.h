// The free motion of a rigid body over one step, exactly or nearly, as the turn that it makes:
//
//   q(t + h) = q(t) (1 + d),   d a function of the angular momentum y in principal axes and of h
//
// A flow has `void prepare(const Vector3<double>& y)`, called whenever the momentum's length or the energy have changed
// by more than rounding, and `bool turn(const Vector3<double>& y, double h, Turn& d)`: false where it finds none.
#pragma once

#include <array>
#include <cmath>

#include "integrators/kernels/closed_form.h"
#include "integrators/kernels/modified_moments.h"
#include "integrators/kernels/newton.h"
#include "integrators/kernels/turn.h"
#include "motion/problem.h"

namespace polhode {

/// The kinetic energy y_1^2/2I_1 + y_2^2/2I_2 + y_3^2/2I_3 split into its three terms: each turns the body about one
/// principal axis, in the symmetric order 1 2 3 2 1. (S. Reich 1994, Physica D 76, 375; R. I. McLachlan 1993, Phys.
/// Rev. Lett. 71, 3043.) Order 2.
class ThreeRotations {
  public:
    explicit ThreeRotations(const Problem& problem) : inverse_moments_(problem.principal_inertia.inverse_moments) {}

    void prepare(const Vector3<double>&) {}
    bool turn(const Vector3<double>& y, double h, Turn& d) const {
        Vector3<double> now = y;
        d = {};
        about<0>(h / 2, now, d);
        about<1>(h / 2, now, d);
        about<2>(h, now, d);
        about<1>(h / 2, now, d);
        about<0>(h / 2, now, d);
        return true;
    }

  private:
    Vector3<double> inverse_moments_;

    // by half = h y_i / 2 I_i: d after the turn, and the other two components of y turned back
    template <int i>
    void about(double h, Vector3<double>& y, Turn& d) const {
        constexpr int j = (i + 1) % 3, k = (i + 2) % 3;
        const double half = 0.5 * h * inverse_moments_[i] * y[i];
        const SineCosine f(half * half);
        const double c = f.cosine_less_one, s = half * f.sine_by_angle;
        // of the whole angle: cos - 1 = -2 s^2, sin = 2 s cos(half)
        const double sine = 2 * s + 2 * s * c, cosine_less_one = -2 * s * s;
        const double yj = y[j], yk = y[k];
        y[j] = yj + (cosine_less_one * yj + sine * yk);
        y[k] = yk + (cosine_less_one * yk - sine * yj);
        Turn next;
        next.w = d.w + (c + (d.w * c - d.v[i] * s));
        next.v[i] = d.v[i] + (s + (d.w * s + d.v[i] * c));
        next.v[j] = d.v[j] + (d.v[j] * c + d.v[k] * s);
        next.v[k] = d.v[k] + (d.v[k] * c - d.v[j] * s);
        d = next;
    }
};

/// The exact motion, to rounding: by turns about the momentum and the axis of symmetry where two moments are equal;
/// else by the Taylor series of w and q, as long as it is short, and by Jacobi's functions for steps beyond that.
class ExactFreeMotion {
  public:
    explicit ExactFreeMotion(const Problem& problem)
        : moments_(problem.principal.moments),
          inverse_moments_(problem.principal_inertia.inverse_moments),
          gyroscopic_(problem.principal_inertia.gyroscopic) {
        for (int i = 0; i < 3; ++i)
            if (moments_[(i + 1) % 3] == moments_[(i + 2) % 3]) axis_ = i;
        if (axis_ >= 0) excess_ = inverse_moments_[axis_] - inverse_moments_[(axis_ + 1) % 3];
    }

    void prepare(const Vector3<double>&) {}
    bool turn(const Vector3<double>& y, double h, Turn& d) const {
        if (axis_ < 0) return series(y, h, d) || closed_form(y, h, d);
        // w = y / I1 + (1/I3 - 1/I1) y3 e3: a turn about y, which stays where it is in the world, and one about e3
        d = turn_by((h * inverse_moments_[(axis_ + 1) % 3]) * y);
        const double half = 0.5 * h * excess_ * y[axis_];
        const SineCosine f(half * half);
        Turn spin;
        spin.w = f.cosine_less_one, spin.v[axis_] = half * f.sine_by_angle;
        d = then(d, spin);
        return true;
    }

  private:
    static constexpr int most = 20;  ///< terms: beyond them the closed form costs less

    Vector3<double> moments_, inverse_moments_, gyroscopic_;
    int axis_ = -1;
    double excess_ = 0;

    // with t in units of h: (k+1) w_i,k+1 = g_i sum of w_j,l w_m,k-l and 2 (k+1) q_k+1 = sum of q_l w_k-l, w in
    // radians a step
    bool series(const Vector3<double>& y, double h, Turn& d) const {
        std::array<Vector3<double>, most + 1> w;
        std::array<Quaternion<double>, most + 1> q;
        for (int i = 0; i < 3; ++i) w[0][i] = h * inverse_moments_[i] * y[i];
        d = {};
        const double size = std::abs(w[0][0]) + std::abs(w[0][1]) + std::abs(w[0][2]);
        bool small = false;
        for (int k = 0; k < most; ++k) {
            Vector3<double> product;
            // q_0 = 1
            Quaternion<double> rate{0, w[k][0], w[k][1], w[k][2]};
            for (int l = 0; l <= k; ++l) {
                const Vector3<double>&a = w[l], &b = w[k - l];
                for (int i = 0; i < 3; ++i) product[i] += a[(i + 1) % 3] * b[(i + 2) % 3];
                if (l == 0) continue;
                const Quaternion<double>& p = q[l];
                rate.w -= p.x * b[0] + p.y * b[1] + p.z * b[2];
                rate.x += p.w * b[0] + (p.y * b[2] - p.z * b[1]);
                rate.y += p.w * b[1] + (p.z * b[0] - p.x * b[2]);
                rate.z += p.w * b[2] + (p.x * b[1] - p.y * b[0]);
            }
            const double share = 1.0 / (k + 1), half_share = 0.5 * share;
            for (int i = 0; i < 3; ++i) w[k + 1][i] = share * gyroscopic_[i] * product[i];
            q[k + 1] = {half_share * rate.w, half_share * rate.x, half_share * rate.y, half_share * rate.z};
            d.w += q[k + 1].w;
            d.v = d.v + vector_part(q[k + 1]);
            const Quaternion<double>& p = q[k + 1];
            const double last = std::abs(p.w) + std::abs(p.x) + std::abs(p.y) + std::abs(p.z);
            // two terms in a row, as either may vanish by chance; the first alone says nothing
            const bool now_small = k > 0 && last <= 0x1p-55 * size;
            if (now_small && small) return true;
            small = now_small;
            if (!(last <= 4)) return false;
        }
        return false;
    }
    bool closed_form(const Vector3<double>& y, double h, Turn& d) const {
        const Vector3<double> w(inverse_moments_[0] * y[0], inverse_moments_[1] * y[1], inverse_moments_[2] * y[2]);
        if (!(dot(w, w) < INFINITY)) return false;
        const auto form = ClosedForm<double>::find(moments_, Forcing<double>{}, w, Quaternion<double>{}, 0);
        if (!form) return false;
        const Quaternion<double> q = form->at(h).q;
        d = {q.w - 1, vector_part(q)};
        return true;
    }
};

/// The discrete motion of J. Moser & A. P. Veselov 1991, Commun. Math. Phys. 139, 217, in the form of E. Hairer &
/// G. Vilmart 2006, J. Phys. A 39, 13225, eqs. 16-18: with inverse moments r and e = r m,
///
///   m = (1 + |e|^2) h y / 2 + m x e,   1 + d = (1, e) / sqrt(1 + |e|^2)
///
/// It keeps y . r y. Order 2 for r = 1/I; `terms` > 1 take r from ModifiedMoments, and the order is 2 `terms`.
template <int terms>
class DiscreteMoserVeselov {
  public:
    explicit DiscreteMoserVeselov(const Problem& problem)
        : inverse_moments_(problem.principal_inertia.inverse_moments) {}

    void prepare(const Vector3<double>& y) {
        if constexpr (terms > 1) modified_ = ModifiedMoments<terms>(inverse_moments_, y);
    }
    bool turn(const Vector3<double>& y, double h, Turn& d) const {
        Vector3<double> r = inverse_moments_;
        if constexpr (terms > 1) r = modified_.inverse_moments(inverse_moments_, h);
        const auto scaled = [&r](const Vector3<double>& m) {
            return Vector3<double>(r[0] * m[0], r[1] * m[1], r[2] * m[2]);
        };
        const Vector3<double> g = (0.5 * h) * y;
        const auto right = [&](const Vector3<double>& m) {
            const Vector3<double> e = scaled(m);
            return (1 + dot(e, e)) * g + cross(m, e);
        };
        const auto slope = [&](const Vector3<double>& m) {
            const Vector3<double> e = scaled(m);
            const Vector3<double> pull(2 * r[0] * e[0], 2 * r[1] * e[1], 2 * r[2] * e[2]);
            Matrix3<double> M;
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) M[i][j] = (i == j ? 1.0 : 0.0) - g[i] * pull[j];
            // d(m x e) = dm x e + m x (r dm)
            for (int i = 0; i < 3; ++i) {
                const int j = (i + 1) % 3, k = (i + 2) % 3;
                M[i][j] += m[k] * r[j] - e[k];
                M[i][k] += e[j] - m[j] * r[k];
            }
            return M;
        };
        Vector3<double> m = right(right(g));
        if (!solve_to_rounding(
                m, [&](const Vector3<double>& x) { return x - right(x); }, slope))
            return false;
        const Vector3<double> e = scaled(m);
        const double square = dot(e, e), root = std::sqrt(1 + square), inverse_root = 1 / root;
        d = {-square * inverse_root / (1 + root), inverse_root * e};
        return true;
    }

  private:
    Vector3<double> inverse_moments_;
    ModifiedMoments<terms> modified_;
};

}  // namespace polhode
