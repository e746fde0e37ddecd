// Jacobi rotations to the principal axes, over any scalar with square roots.
#pragma once

#include "body/elementary.h"
#include "body/rigid_body.h"

namespace polhode {

/// One Jacobi rotation: rotates in the (p, r) plane so that the off-diagonal entry vanishes. For a 3x3 tensor a few
/// sweeps reach the precision of the scalar, whatever the spread of the moments (Golub & Van Loan, 8.5).
template <class S>
void rotate_away(Matrix3<S>& a, Quaternion<S>& q, int p, int r, double largest_slope) {
    if (a[p][r] == 0) return;
    const S theta = (a[r][r] - a[p][p]) / (2 * a[p][r]);
    const S magnitude = theta < 0 ? -theta : theta;
    if (magnitude > S(largest_slope)) {
        a[p][r] = a[r][p] = 0;
        return;
    }
    const S t = S(theta < 0 ? -1 : 1) / (magnitude + square_root(magnitude * magnitude + 1));
    const S c = 1 / square_root(t * t + 1), s = t * c;
    // columns p and r of the axes rotate by the angle whose cosine is c: x_p' = c x_p - s x_r, x_r' = s x_p + c x_r
    Matrix3<S> turn = diagonal(Vector3<S>(1, 1, 1));
    turn[p][p] = c, turn[r][r] = c, turn[p][r] = s, turn[r][p] = -s;
    a = transposed(turn) * a * turn;
    a[p][r] = a[r][p] = 0;
    // the same rotation as a quaternion: about the third axis k, by -angle if (p, r, k) is right-handed
    const S half_cosine = square_root((1 + c) / 2), half_sine = s / (2 * half_cosine);
    const int k = 3 - p - r;
    const bool right_handed = (p + 1) % 3 == r;
    Vector3<S> axis;
    axis[k] = right_handed ? -half_sine : half_sine;
    q = q * Quaternion<S>{half_cosine, axis[0], axis[1], axis[2]};
}

/// Diagonalises `inertia` by 24 Jacobi sweeps. Returns the unit quaternion that maps principal axes to the tensor's
/// axes. A tensor that is not symmetric is replaced by its symmetric part. Rotations by less than 1/(2 largest_slope)
/// rad are skipped; choose largest_slope so that they are below the scalar's precision.
template <class S>
Quaternion<S> rotate_to_principal_axes(Matrix3<S>& inertia, double largest_slope) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j) inertia[i][j] = inertia[j][i] = (inertia[i][j] + inertia[j][i]) / 2;
    Quaternion<S> q{S(1), S(0), S(0), S(0)};
    for (int sweep = 0; sweep < 24; ++sweep) {
        rotate_away(inertia, q, 0, 1, largest_slope);
        rotate_away(inertia, q, 1, 2, largest_slope);
        rotate_away(inertia, q, 0, 2, largest_slope);
    }
    const S norm = square_root(squared_norm(q));
    return {q.w / norm, q.x / norm, q.y / norm, q.z / norm};
}

}  // namespace polhode
