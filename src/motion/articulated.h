// The articulated-body recursion (Featherstone 1983; 2008, ch. 7) in classical accelerations. For a link with angular
// velocity w, angular acceleration alpha and acceleration a of its origin, all in its own axes,
//
//     n = J alpha + B a + n0,   f = B^T alpha + M a + f0
//
// are the torque about its origin and the force that move the link and everything attached below it. The pass from
// the leaves to the root computes J, B, M, n0, f0 and eliminates the degrees of freedom of each joint. The pass from
// the root to the leaves computes the accelerations. Classical accelerations do not involve linear velocities, so
// that fast flight loses no digits.
//
// Templates over the scalar S of the state and P of the constants: double, dual numbers, traced coefficients,
// multiprecision. No branch depends on a value. Cost and memory are linear in the number of links.
#pragma once

#include <vector>

#include "body/algebra.h"
#include "motion/links.h"

namespace polhode {

/// The coefficients of n = J alpha + B a + n0 and f = B^T alpha + M a + f0; `n` and `f` hold n0 and f0.
template <class S>
struct ArticulatedInertia {
    Symmetric3<S> J;
    Matrix3<S> B;
    Symmetric3<S> M;
    Vector3<S> n, f;
};

/// Torque about a link's origin and force, or angular acceleration and acceleration of the origin; in the link's
/// axes.
template <class S>
struct Pair6 {
    Vector3<S> turning, linear;
};

/// The recursion's data of one link.
template <class S>
struct LinkWork {
    Matrix3<S> R;   ///< link axes to the parent's axes
    Vector3<S> r;   ///< its origin from the parent's origin, in the parent's axes, m
    Vector3<S> w;   ///< rad/s
    Pair6<S> bias;  ///< velocity-dependent accelerations, in addition to the parent's and the joint's
    ArticulatedInertia<S> inertia;
    Pair6<S> U;                  ///< revolute, prismatic: torque and force for unit joint acceleration
    Symmetric3<S> inverse;       ///< revolute, prismatic: 1 / D in xx; spherical: J^-1; free: Schur complement^-1
    Symmetric3<S> inverse_mass;  ///< free: M^-1
    Vector3<S> force;            ///< generalized force on the joint, minus the part balanced by the link's n0, f0
    Pair6<S> acceleration;
};

/// The inverse of a regular symmetric matrix, by cofactors.
template <class S>
Symmetric3<S> inverse(const Symmetric3<S>& m) {
    const S xx = m.yy * m.zz - m.yz * m.yz, xy = m.xz * m.yz - m.xy * m.zz, xz = m.xy * m.yz - m.xz * m.yy;
    const S per = S(1) / (m.xx * xx + m.xy * xy + m.xz * xz);
    return {xx * per, (m.xx * m.zz - m.xz * m.xz) * per, (m.xx * m.yy - m.xy * m.xy) * per, xy * per,
            xz * per, (m.xy * m.xz - m.xx * m.yz) * per};
}

/// A symmetric matrix as a full matrix.
template <class S>
Matrix3<S> full_matrix(const Symmetric3<S>& m) {
    return {{Vector3<S>(m.xx, m.xy, m.xz), Vector3<S>(m.xy, m.yy, m.yz), Vector3<S>(m.xz, m.yz, m.zz)}};
}

template <class S>
Symmetric3<S> operator+(const Symmetric3<S>& a, const Symmetric3<S>& b) {
    return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.xz + b.xz, a.yz + b.yz};
}

template <class S>
Symmetric3<S> operator-(const Symmetric3<S>& a, const Symmetric3<S>& b) {
    return {a.xx - b.xx, a.yy - b.yy, a.zz - b.zz, a.xy - b.xy, a.xz - b.xz, a.yz - b.yz};
}

/// u v^T, for u and v with a symmetric product.
template <class S>
Symmetric3<S> outer(const Vector3<S>& u, const Vector3<S>& v) {
    return {u[0] * v[0], u[1] * v[1], u[2] * v[2], u[0] * v[1], u[0] * v[2], u[1] * v[2]};
}

/// R m R^T.
template <class S>
Symmetric3<S> congruence(const Matrix3<S>& R, const Symmetric3<S>& m) {
    const Matrix3<S> half = R * full_matrix(m);
    return {dot(half[0], R[0]), dot(half[1], R[1]), dot(half[2], R[2]),
            dot(half[0], R[1]), dot(half[0], R[2]), dot(half[1], R[2])};
}

/// M^T v.
template <class A, class B>
Vector3<Product<A, B>> transposed_times(const Matrix3<A>& m, const Vector3<B>& v) {
    return {m[0][0] * v[0] + m[1][0] * v[1] + m[2][0] * v[2], m[0][1] * v[0] + m[1][1] * v[1] + m[2][1] * v[2],
            m[0][2] * v[0] + m[1][2] * v[1] + m[2][2] * v[2]};
}

/// The rotation from link axes to the parent's axes: `turn` times the rotation about z with this cosine and sine.
template <class S, class P>
Matrix3<S> rotation_about_z(const Matrix3<P>& turn, const S& c, const S& s) {
    Matrix3<S> R;
    for (int i = 0; i < 3; ++i)
        R[i] = {turn[i][0] * c + turn[i][1] * s, turn[i][1] * c - turn[i][0] * s, S(turn[i][2])};
    return R;
}

/// Adds the articulated inertia of a child to its parent's: rotated by R and moved by r.
template <class S>
void add_child_inertia(const LinkWork<S>& child, const Symmetric3<S>& J, const Matrix3<S>& B, const Symmetric3<S>& M,
                       const Vector3<S>& n, const Vector3<S>& f, ArticulatedInertia<S>& parent) {
    const Matrix3<S>& R = child.R;
    const Vector3<S>& r = child.r;
    const Symmetric3<S> J_p = congruence(R, J), M_p = congruence(R, M);
    const Matrix3<S> B_p = R * B * transposed(R), mass = full_matrix(M_p);
    // the child's origin is at r: it accelerates by a + alpha x r, and its force f exerts the torque r x f
    Matrix3<S> moved;  // B_p + [r] M
    for (int j = 0; j < 3; ++j) {
        const Vector3<S> column = cross(r, mass[j]);
        for (int i = 0; i < 3; ++i) moved[i][j] = B_p[i][j] + column[i];
    }
    // J - B [r] + [r] (B + [r] M)^T: row i of -B [r] is r x (row i of B), column i of the last r x (row i of B + [r] M)
    Matrix3<S> turning;
    for (int i = 0; i < 3; ++i) {
        turning[i] = turning[i] + cross(r, B_p[i]);
        const Vector3<S> column = cross(r, moved[i]);
        for (int j = 0; j < 3; ++j) turning[j][i] = turning[j][i] + column[j];
    }
    parent.J = parent.J + J_p + symmetric_part(turning);
    parent.B = parent.B + moved;
    parent.M = parent.M + M_p;
    const Vector3<S> f_p = R * f;
    parent.f = parent.f + f_p;
    parent.n = parent.n + (R * n + cross(r, f_p));
}

}  // namespace polhode
