
#include "body/rigid_body.h"
#include "body/wide.h"

namespace polhode {
namespace {

// Classical Jacobi: rotate in the (p, r) plane until the off-diagonal entry vanishes. For a 3x3 tensor a handful of
// sweeps reach the arithmetic's precision, whatever the spread or nearness of the moments (Golub & Van Loan, 8.5).
void rotate_away(Matrix3<Wide>& a, Quaternion<Wide>& q, int p, int r) {
    if (a[p][r] == 0) return;
    const Wide theta = (a[r][r] - a[p][p]) / (2 * a[p][r]);
    const Wide magnitude = theta < 0 ? -theta : theta;
    // an angle below 1e-40 rad is none in 113 bits, and theta^2 might overflow
    if (magnitude > Wide(1e40)) {
        a[p][r] = a[r][p] = 0;
        return;
    }
    const Wide t = (theta < 0 ? Wide(-1) : Wide(1)) / (magnitude + square_root(magnitude * magnitude + 1));
    const Wide c = 1 / square_root(t * t + 1), s = t * c;
    // columns p and r of the axes turn by the angle whose cosine is c: x_p' = c x_p - s x_r, x_r' = s x_p + c x_r
    Matrix3<Wide> turn = diagonal(Vector3<Wide>(1, 1, 1));
    turn[p][p] = c, turn[r][r] = c, turn[p][r] = s, turn[r][p] = -s;
    a = transposed(turn) * a * turn;
    a[p][r] = a[r][p] = 0;
    // the same turn as a quaternion: about the third axis k, by -angle if (p, r, k) is right-handed
    const Wide half_cosine = square_root((1 + c) / 2), half_sine = s / (2 * half_cosine);
    const int k = 3 - p - r;
    const bool right_handed = (p + 1) % 3 == r;
    Vector3<Wide> axis;
    axis[k] = right_handed ? -half_sine : half_sine;
    q = q * Quaternion<Wide>{half_cosine, axis[0], axis[1], axis[2]};
}

}  // namespace

WidePrincipalFrame wide_principal_frame(const Matrix3<Wide>& inertia) {
    Matrix3<Wide> a = inertia;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j) a[i][j] = a[j][i] = (a[i][j] + a[j][i]) / 2;
    Quaternion<Wide> q{1, 0, 0, 0};
    for (int sweep = 0; sweep < 24; ++sweep) {
        rotate_away(a, q, 0, 1);
        rotate_away(a, q, 1, 2);
        rotate_away(a, q, 0, 2);
    }
    const Wide norm = square_root(squared_norm(q));
    return {{a[0][0], a[1][1], a[2][2]}, {q.w / norm, q.x / norm, q.y / norm, q.z / norm}};
}

PrincipalFrame rounded(const WidePrincipalFrame& frame) {
    PrincipalFrame nearest;
    const Vector3<Wide>& I = frame.moments;
    nearest.q_BP = {double(frame.q_BP.w), double(frame.q_BP.x), double(frame.q_BP.y), double(frame.q_BP.z)};
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        nearest.moments[i] = double(I[i]);
        nearest.gyroscopic[i] = double((I[j] - I[k]) / I[i]);
        nearest.inverse_moments[i] = double(1 / I[i]);
    }
    return nearest;
}

}  // namespace polhode
