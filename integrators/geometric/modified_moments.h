// Modified moments of inertia that raise the order of the discrete Moser-Veselov motion.
//
// E. Hairer & G. Vilmart 2006, J. Phys. A 39, 13225: replace r_j = 1/I_j by
//
//   a r_j + b,   a = 1 + a_1 h^2 + a_2 h^4 + ..,   b = b_1 h^2 + b_2 h^4 + ..,
//
// whose coefficients are functions of I, |y|^2 and the energy. The discrete motion then agrees with the exact one up
// to a power of h. The paper gives a_1 to a_4 and b_1 to b_4 as polynomials. Here the series are computed numerically
// for the current motion, to any number of terms, from the conditions that both motions coincide.
//
// If r_1 - r_3 is the largest difference (and not all r are equal), every motion passes through y_2 = 0. There y_1^2
// = z_1^2 = y_1^2 + (1 - l) y_2^2 .. of any other point. About such a time, taken as the middle of a step,
//   y = (z_1 A, (r_1 - r_3) z_1 z_3 t S, z_3 B),   q = (P_0, z_1 t P_1, z_1 z_3 t^2 P_2, z_3 t P_3)
// with series A .. P_3 in s = t^2. From t = -h/2 to h/2 both motions rotate by (1, e), e = (z_1 t E_1, 0, z_3 t E_3),
// and change y equally, if, at s = h^2/4 and with alpha = 1 + |e|^2,
//   alpha a = S / (A B),   alpha (a r_1 + b) A = E_1,   alpha (a r_3 + b) B = E_3.
#pragma once

#include <array>
#include <utility>

#include "body/algebra.h"

namespace polhode {

/// The first `terms` coefficients of a and b, including a_0 = 1 and b_0 = 0.
template <int terms>
class ModifiedMoments {
  public:
    ModifiedMoments() { a_[0] = 1; }

    /// `r`: inverse moments; `y`: angular momentum in principal axes, at any point of the motion.
    ModifiedMoments(const Vector3<double>& r, const Vector3<double>& y) {
        int first = 0, middle = 1, last = 2;  // r descending; the handedness of the axes does not matter
        if (r[first] < r[middle]) std::swap(first, middle);
        if (r[middle] < r[last]) std::swap(middle, last);
        if (r[first] < r[middle]) std::swap(first, middle);
        const double r1 = r[first], r2 = r[middle], r3 = r[last], range = r1 - r3;
        const double share = range > 0 ? (r2 - r3) / range : 0, y22 = y[middle] * y[middle];
        const double z11 = y[first] * y[first] + share * y22, z33 = y[last] * y[last] + (1 - share) * y22;

        Series A{1}, B{1}, S{}, P0{1}, P1{}, P2{}, P3{};
        for (int k = 0; k < terms; ++k) {
            S[k] = product(A, B, k) / (2 * k + 1);
            const auto shifted_product = [k](const Series& u, const Series& v) {
                return k > 0 ? product(u, v, k - 1) : 0;
            };
            P1[k] =
                0.5 / (2 * k + 1) *
                (r1 * product(P0, A, k) + z33 * (r3 * shifted_product(P2, B) - r2 * range * shifted_product(P3, S)));
            P3[k] =
                0.5 / (2 * k + 1) *
                (r3 * product(P0, B, k) + z11 * (r2 * range * shifted_product(P1, S) - r1 * shifted_product(P2, A)));
            P2[k] =
                0.5 / (2 * k + 2) * (r2 * range * product(P0, S, k) + r1 * product(P3, A, k) - r3 * product(P1, B, k));
            if (k + 1 == terms) break;
            A[k + 1] = -0.5 / (k + 1) * (r2 - r3) * range * z33 * product(S, B, k);
            B[k + 1] = -0.5 / (k + 1) * (r1 - r2) * range * z11 * product(S, A, k);
            P0[k + 1] = -0.25 / (k + 1) *
                        (z11 * r1 * product(P1, A, k) + z33 * r3 * product(P3, B, k) +
                         z11 * z33 * r2 * range * shifted_product(P2, S));
        }
        // (1, e) = q(-h/2)^-1 q(h/2), where q(-t) = (P_0, -.., +.., -..).
        Series turn0{}, turn1{}, turn3{};
        for (int k = 0; k < terms; ++k) {
            turn0[k] = product(P0, P0, k);
            if (k > 0) turn0[k] -= z11 * product(P1, P1, k - 1) + z33 * product(P3, P3, k - 1);
            if (k > 1) turn0[k] += z11 * z33 * product(P2, P2, k - 2);
            turn1[k] = 2 * product(P0, P1, k);
            turn3[k] = 2 * product(P0, P3, k);
            if (k > 0) turn1[k] -= 2 * z33 * product(P2, P3, k - 1), turn3[k] += 2 * z11 * product(P1, P2, k - 1);
        }
        const Series E1 = quotient(turn1, turn0), E3 = quotient(turn3, turn0);
        const Series g = quotient(S, product(A, B)), f1 = quotient(E1, A), f3 = quotient(E3, B);
        Series alpha{1}, rest{};
        for (int k = 0; k < terms; ++k) {
            if (k > 0) alpha[k] = z11 * product(E1, E1, k - 1) + z33 * product(E3, E3, k - 1);
            rest[k] = 0.5 * ((f1[k] - g[k] * r1) + (f3[k] - g[k] * r3));
        }
        a_ = quotient(g, alpha), b_ = quotient(rest, alpha);
        // In powers of h^2 = 4 s.
        double scale = 1;
        for (int k = 0; k < terms; ++k) {
            a_[k] *= scale, b_[k] *= scale;
            scale *= 0.25;
        }
        a_[0] = 1, b_[0] = 0;
    }

    /// The coefficients of h^2k.
    double a(int k) const { return a_[k]; }
    double b(int k) const { return b_[k]; }

    /// a r + b for a step h.
    Vector3<double> inverse_moments(const Vector3<double>& r, double h) const {
        const double x = h * h;
        double scale_change = 0, shift = 0;
        for (int k = terms - 1; k > 0; --k) scale_change = x * (a_[k] + scale_change), shift = x * (b_[k] + shift);
        return {r[0] + (scale_change * r[0] + shift), r[1] + (scale_change * r[1] + shift),
                r[2] + (scale_change * r[2] + shift)};
    }

  private:
    using Series = std::array<double, terms>;
    Series a_{}, b_{};

    static double product(const Series& x, const Series& y, int k) {
        double sum = 0;
        for (int l = 0; l <= k; ++l) sum += x[l] * y[k - l];
        return sum;
    }
    static Series product(const Series& x, const Series& y) {
        Series z{};
        for (int k = 0; k < terms; ++k) z[k] = product(x, y, k);
        return z;
    }
    static Series quotient(const Series& x, const Series& y) {
        Series z{};
        for (int k = 0; k < terms; ++k) {
            double sum = x[k];
            for (int l = 0; l < k; ++l) sum -= z[l] * y[k - l];
            z[k] = sum / y[0];
        }
        return z;
    }
};

}  // namespace polhode
