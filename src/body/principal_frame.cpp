#include "body/principal_rotation.h"
#include "body/rigid_body.h"
#include "body/wide.h"

namespace polhode {

WidePrincipalFrame wide_principal_frame(const Matrix3<Wide>& inertia) {
    Matrix3<Wide> a = inertia;
    // rotations below 1e-40 rad are below 113 bits, and the square of a larger slope might overflow
    const Quaternion<Wide> q = rotate_to_principal_axes(a, 1e40);
    return {{a[0][0], a[1][1], a[2][2]}, q};
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
