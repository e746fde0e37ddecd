// The impulse at one contact with Coulomb's cone, solved exactly.
#pragma once

#include <cmath>

#include "body/algebra.h"
#include "body/elementary.h"

namespace polhode::contact_stepping {

/// Solves a p = -b by cofactors for a matrix K + diag(0, a, a).
template <class S>
Vector3<S> solve_with_slip(const Matrix3<S>& K, const S& a, const Vector3<S>& b) {
    Matrix3<S> M = K;
    M[1][1] = M[1][1] + a, M[2][2] = M[2][2] + a;
    const Vector3<S> c0 = cross(M[1], M[2]), c1 = cross(M[2], M[0]), c2 = cross(M[0], M[1]);
    return (S(-1) / dot(M[0], c0)) * (b[0] * c0 + b[1] * c1 + b[2] * c2);
}

/// The impulse p (contact axes n, t1, t2) at one contact with the velocity b at zero impulse:
///   u = K p + b,  0 <= p_n, 0 <= u_n, p_n u_n = 0,  |p_t| <= mu p_n,  u_t = -a p_t with a >= 0, and a = 0 inside the
///   cone.
/// For given a, p(a) is linear; a = 0 sticks. Otherwise g(a) = mu p_n - |p_t| is negative at 0, and positive for large
/// a, where p_t vanishes. Its root is found by regula falsi (Illinois) in s = a / (a + k), where k is the mean
/// tangential entry of K.
template <class S>
Vector3<S> solve_coulomb_contact(const Matrix3<S>& K, const Vector3<S>& b, const S& mu) {
    if (!(b[0] < S(0))) return {};
    if (!(mu > S(0))) return {-b[0] / K[0][0], S(0), S(0)};
    constexpr int most_iterations = 100;
    const S k = (K[1][1] + K[2][2]) / S(2);
    const auto cone = [&](const Vector3<S>& p) { return mu * p[0] - std::hypot(p[1], p[2]); };
    Vector3<S> p = solve_with_slip(K, S(0), b);
    S g = cone(p);
    if (g >= S(0) && p[0] >= S(0)) return p;
    S low = S(0), low_g = g, high = S(1), high_g = mu * (-b[0] / K[0][0]);
    for (int i = 0; i < most_iterations; ++i) {
        S s = (low * high_g - high * low_g) / (high_g - low_g);
        if (!(s > low && s < high)) s = (low + high) / S(2);
        if (!(s > low && s < high)) break;
        p = solve_with_slip(K, k * s / (S(1) - s), b);
        const S before = g;
        g = cone(p);
        if (!(std::abs(g) > S(2) * Elementary<S>::epsilon() * mu * std::abs(p[0]))) break;
        if (g < S(0)) {
            low = s, low_g = g;
            if (before < S(0)) high_g = high_g / S(2);
        } else {
            high = s, high_g = g;
            if (before > S(0)) low_g = low_g / S(2);
        }
    }
    return p;
}

}  // namespace polhode::contact_stepping
