// The free motion of a rigid body over one step, exact or approximate, as a rotation:
//
//   q(t + h) = q(t) (1 + d),   d a function of the angular momentum y in principal axes and of h
//
// The flows are ThreeRotations, ExactFreeMotion and DiscreteMoserVeselov. A flow has `void prepare(const
// Vector3<double>& y)`, called whenever the momentum's length or the energy has changed by more than rounding, and
// `bool compute_rotation(const Vector3<double>& y, double h, RotationIncrement& d)`, which returns false if it finds no
// solution.
#pragma once

#include <array>
#include <cmath>

#include "integrators/closed_form/closed_form.h"
#include "integrators/closed_form/compensated_rotation.h"
#include "integrators/geometric/modified_moments.h"
#include "integrators/geometric/newton.h"
#include "motion/problem.h"

namespace polhode {

/// Splits the kinetic energy y_1^2/2I_1 + y_2^2/2I_2 + y_3^2/2I_3 into its three terms. Each rotates the body about
/// one principal axis, in the symmetric order 1 2 3 2 1. Order 2. (S. Reich 1994, Physica D 76, 375; R. I. McLachlan
/// 1993, Phys. Rev. Lett. 71, 3043.)
template <class S = double>
class ThreeRotations {
  public:
    explicit ThreeRotations(const Problem& problem)
        : inverse_moments_(cast<S>(problem.body.principal_inertia.inverse_moments)) {}

    void prepare(const Vector3<S>&) {}
    bool compute_rotation(const Vector3<S>& y, S h, RotationIncrementOf<S>& d) const {
        Vector3<S> now = y;
        d = {};
        rotate_about<0>(h / 2, now, d);
        rotate_about<1>(h / 2, now, d);
        rotate_about<2>(h, now, d);
        rotate_about<1>(h / 2, now, d);
        rotate_about<0>(h / 2, now, d);
        return true;
    }

  private:
    Vector3<S> inverse_moments_;

    // Rotates by half = h y_i / 2 I_i: updates d, and rotates the other two components of y back.
    template <int i>
    void rotate_about(S h, Vector3<S>& y, RotationIncrementOf<S>& d) const {
        constexpr int j = (i + 1) % 3, k = (i + 2) % 3;
        const S half = S(0.5) * h * inverse_moments_[i] * y[i];
        const SineCosine f(half * half);
        const S c = f.cosine_less_one, s = half * f.sine_by_angle;
        // For the full angle: cos - 1 = -2 s^2, sin = 2 s cos(half).
        const S sine = 2 * s + 2 * s * c, cosine_less_one = -2 * s * s;
        const S yj = y[j], yk = y[k];
        y[j] = yj + (cosine_less_one * yj + sine * yk);
        y[k] = yk + (cosine_less_one * yk - sine * yj);
        RotationIncrementOf<S> next;
        next.w = d.w + (c + (d.w * c - d.v[i] * s));
        next.v[i] = d.v[i] + (s + (d.w * s + d.v[i] * c));
        next.v[j] = d.v[j] + (d.v[j] * c + d.v[k] * s);
        next.v[k] = d.v[k] + (d.v[k] * c - d.v[j] * s);
        d = next;
    }
};

/// The exact motion, to rounding. With two equal moments: rotations about the momentum and the axis of symmetry.
/// Otherwise the Taylor series of y while it is short, and Jacobi's elliptic functions for longer steps.
///
/// Since L_W is constant, R(1 + d) takes y(h) to y(0). With L = |y|, 1 + d is the shortest rotation that does so,
/// followed by a rotation about y(0) by phi. The angular velocity of the shortest rotation has no component along
/// y(h) + y(0), so that
///   dphi/dt = L w . (y + y(0)) / (L^2 + y . y(0)) = L (2 E + w . y(0)) / (L^2 + y . y(0)).
/// Besides the three series of y this takes a single quotient; the series of q would take four more products.
class ExactFreeMotion {
  public:
    explicit ExactFreeMotion(const Problem& problem)
        : moments_(problem.body.principal.moments), inverse_moments_(problem.body.principal_inertia.inverse_moments) {
        const Vector3<double>& g = problem.body.principal_inertia.gyroscopic;
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            if (moments_[j] == moments_[k]) axis_ = i;
            // I_i g_i / (I_j I_k) = 1/I_k - 1/I_j without its cancellation.
            coefficient_[i] = g[i] * moments_[i] * inverse_moments_[j] * inverse_moments_[k];
        }
        if (axis_ >= 0) inverse_difference_ = inverse_moments_[axis_] - inverse_moments_[(axis_ + 1) % 3];
    }

    void prepare(const Vector3<double>&) {}
    bool compute_rotation(const Vector3<double>& y, double h, RotationIncrement& d) const {
        if (axis_ < 0) return series(y, h, d) || closed_form(y, h, d);
        // w = y / I1 + (1/I3 - 1/I1) y3 e3: a rotation about y, which is fixed in the world, and one about e3.
        d = rotation_increment((h * inverse_moments_[(axis_ + 1) % 3]) * y);
        const double half = 0.5 * h * inverse_difference_ * y[axis_];
        const SineCosine f(half * half);
        RotationIncrement spin;
        spin.w = f.cosine_less_one, spin.v[axis_] = half * f.sine_by_angle;
        d = compose(d, spin);
        return true;
    }

  private:
    static constexpr int max_terms = 20;  ///< terms; beyond this number the closed form is cheaper

    Vector3<double> moments_, inverse_moments_, coefficient_;
    int axis_ = -1;
    double inverse_difference_ = 0;

    // With t in units of h: (k+1) y_i,k+1 = h (1/I_k - 1/I_j) sum of y_j,l y_k,k-l.
    bool series(const Vector3<double>& start, double h, RotationIncrement& d) const {
        d = {};
        const double square = dot(start, start);
        if (square == 0) return true;
        const double inverse_square = 1 / square, length = std::sqrt(square);
        const double a0 = h * coefficient_[0], a1 = h * coefficient_[1], a2 = h * coefficient_[2];
        const Vector3<double> rate(inverse_moments_[0] * start[0], inverse_moments_[1] * start[1],
                                   inverse_moments_[2] * start[2]);
        std::array<double, max_terms + 1> y0{}, y1{}, y2{}, D{}, F{};
        y0[0] = start[0], y1[0] = start[1], y2[0] = start[2];
        F[0] = dot(rate, start) * inverse_square;
        const double small = 0x1p-58 * length, small_rate = 0x1p-58 * F[0];
        double phi = F[0];
        Vector3<double> rest;
        int small_terms = 0;
        for (int k = 0; k < max_terms; ++k) {
            double p0 = 0, p1 = 0, p2 = 0;
            for (int l = 0; l <= k; ++l) {
                p0 += y1[l] * y2[k - l];
                p1 += y2[l] * y0[k - l];
                p2 += y0[l] * y1[k - l];
            }
            const int n = k + 1;
            const double share = reciprocal[n];
            y0[n] = a0 * share * p0, y1[n] = a1 * share * p1, y2[n] = a2 * share * p2;
            if (n > 1) rest = rest + Vector3<double>(y0[n], y1[n], y2[n]);
            // Both in units of D_0 = 2 L^2.
            D[n] = 0.5 * inverse_square * (start[0] * y0[n] + start[1] * y1[n] + start[2] * y2[n]);
            double f = 0.5 * inverse_square * (rate[0] * y0[n] + rate[1] * y1[n] + rate[2] * y2[n]);
            for (int l = 1; l <= n; ++l) f -= D[l] * F[n - l];
            F[n] = f;
            phi += f * reciprocal[n + 1];
            const double last = std::abs(y0[n]) + std::abs(y1[n]) + std::abs(y2[n]);
            if (!(last <= 4 * length)) return false;
            // Two small terms in a row are required, because one may vanish by coincidence.
            small_terms = last <= small && std::abs(f) <= small_rate ? small_terms + 1 : 0;
            if (small_terms < 2) continue;
            // Add the largest term last. In the reverse order the rounding errors have a bias, and the energy drifts.
            const Vector3<double> change = Vector3<double>(y0[1], y1[1], y2[1]) + rest;
            // sin^2 of a quarter of the angle between y(h) and y(0).
            const double sigma = 0.25 * inverse_square * dot(change, change);
            if (sigma > 0.5) return false;
            const double cosine = std::sqrt(1 - sigma), scale = 2 * square * cosine;
            // Divide instead of multiplying by a reciprocal. The reciprocal's rounding error is the same at every
            // step; it would scale all swings by the same factor and make the energy drift.
            const Vector3<double> across = cross(change, start);
            const RotationIncrement swing{-sigma / (1 + cosine),
                                          {across[0] / scale, across[1] / scale, across[2] / scale}};
            d = compose(rotation_increment((h * phi) * start), swing);
            return true;
        }
        return false;
    }
    static constexpr std::array<double, max_terms + 2> reciprocal = [] {
        std::array<double, max_terms + 2> r{};
        for (int n = 1; n < max_terms + 2; ++n) r[n] = 1.0 / n;
        return r;
    }();
    bool closed_form(const Vector3<double>& y, double h, RotationIncrement& d) const {
        const Vector3<double> w(inverse_moments_[0] * y[0], inverse_moments_[1] * y[1], inverse_moments_[2] * y[2]);
        if (!(dot(w, w) < INFINITY)) return false;
        const auto form = ClosedForm<double>::find(moments_, Forcing<double>{}, w, Quaternion<double>{}, 0);
        if (!form) return false;
        const Quaternion<double> q = form->at(h).q;
        d = {q.w - 1, vector_part(q)};
        return true;
    }
};

/// Discrete motion of J. Moser & A. P. Veselov 1991, Commun. Math. Phys. 139, 217, in the form of E. Hairer & G.
/// Vilmart 2006, J. Phys. A 39, 13225, eqs. 16-18: with inverse moments r and e = r m,
///
///   m = (1 + |e|^2) h y / 2 + m x e,   1 + d = (1, e) / sqrt(1 + |e|^2)
///
/// It conserves y . r y. Order 2 for r = 1/I; with `terms` > 1, r comes from ModifiedMoments and the order is 2
/// `terms`.
template <int terms, class S = double>
class DiscreteMoserVeselov {
  public:
    explicit DiscreteMoserVeselov(const Problem& problem)
        : inverse_moments_(cast<S>(problem.body.principal_inertia.inverse_moments)) {}

    void prepare(const Vector3<S>& y) {
        if constexpr (terms > 1) modified_ = ModifiedMoments<terms>(inverse_moments_, y);
    }
    bool compute_rotation(const Vector3<S>& y, S h, RotationIncrementOf<S>& d) const {
        Vector3<S> r = inverse_moments_;
        if constexpr (terms > 1) r = modified_.inverse_moments(inverse_moments_, h);
        const auto scaled = [&r](const Vector3<S>& m) { return Vector3<S>(r[0] * m[0], r[1] * m[1], r[2] * m[2]); };
        const Vector3<S> g = (S(0.5) * h) * y;
        const auto map = [&](const Vector3<S>& m) {
            const Vector3<S> e = scaled(m);
            return (1 + dot(e, e)) * g + cross(m, e);
        };
        const auto slope = [&](const Vector3<S>& m) {
            const Vector3<S> e = scaled(m);
            const Vector3<S> pull(2 * r[0] * e[0], 2 * r[1] * e[1], 2 * r[2] * e[2]);
            Matrix3<S> M;
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) M[i][j] = S(i == j) - g[i] * pull[j];
            // d(m x e) = dm x e + m x (r dm).
            for (int i = 0; i < 3; ++i) {
                const int j = (i + 1) % 3, k = (i + 2) % 3;
                M[i][j] += m[k] * r[j] - e[k];
                M[i][k] += e[j] - m[j] * r[k];
            }
            return M;
        };
        Vector3<S> m = map(map(g));
        if (!solve_to_rounding(
                m, [&](const Vector3<S>& x) { return x - map(x); }, slope))
            return false;
        const Vector3<S> e = scaled(m);
        const S square = dot(e, e), root = std::sqrt(1 + square), inverse_root = 1 / root;
        d = {-square * inverse_root / (1 + root), inverse_root * e};
        return true;
    }

  private:
    Vector3<S> inverse_moments_;
    ModifiedMoments<terms> modified_;
};

}  // namespace polhode
