#include "body/fast_principal_frame.h"

#include <cmath>

namespace polhode {
namespace {

// One Jacobi rotation in the (p, r) plane (Golub & Van Loan, 8.5); see principal_rotation.h.
bool rotate_away(double (&a)[3][3], double (&q)[4], int p, int r) {
    const double entry = a[p][r], negligible = 1e-20 * std::abs(a[p][p]) + 1e-20 * std::abs(a[r][r]);
    if (entry == 0 || std::abs(entry) <= negligible) {
        a[p][r] = a[r][p] = 0;
        return false;
    }
    const double theta = (a[r][r] - a[p][p]) / (2 * entry);
    const double t = std::copysign(1 / (std::abs(theta) + std::sqrt(theta * theta + 1)), theta);
    const double c = 1 / std::sqrt(t * t + 1), s = t * c;
    const int k = 3 - p - r;
    a[p][p] -= t * entry, a[r][r] += t * entry;
    a[p][r] = a[r][p] = 0;
    const double kp = a[k][p], kr = a[k][r];
    a[k][p] = a[p][k] = c * kp - s * kr;
    a[k][r] = a[r][k] = s * kp + c * kr;
    // the same rotation about the third axis k, by -angle if (p, r, k) is right-handed: q times (cosine, sine e_k) of
    // the half angle
    const double cosine = std::sqrt((1 + c) / 2), half = s / (2 * cosine), sine = (p + 1) % 3 == r ? -half : half;
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double w = q[0], x = q[1 + i], y = q[1 + j], z = q[1 + k];
    q[0] = cosine * w - sine * z;
    q[1 + k] = cosine * z + sine * w;
    q[1 + i] = cosine * x + sine * y;
    q[1 + j] = cosine * y - sine * x;
    return true;
}

}  // namespace

PrincipalFrame fast_principal_frame(const Matrix3<double>& inertia) {
    double a[3][3], q[4] = {1, 0, 0, 0};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) a[i][j] = i == j ? inertia[i][i] : (inertia[i][j] + inertia[j][i]) / 2;
    bool turned = false;
    for (int sweep = 0; sweep < 12; ++sweep) {
        bool going = rotate_away(a, q, 0, 1);
        going = rotate_away(a, q, 1, 2) || going;
        going = rotate_away(a, q, 0, 2) || going;
        if (!going) break;
        turned = true;
    }
    PrincipalFrame frame;
    if (turned) {
        const double scale = 1 / std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        frame.q_BP = {scale * q[0], scale * q[1], scale * q[2], scale * q[3]};
    }
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        frame.moments[i] = a[i][i];
        frame.gyroscopic[i] = (a[j][j] - a[k][k]) / a[i][i];
        frame.inverse_moments[i] = 1 / a[i][i];
    }
    return frame;
}

}  // namespace polhode
