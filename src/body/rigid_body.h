// Mass properties in the form that the equations of motion use, over any scalar.
#pragma once

#include "body/algebra.h"
#include "body/wide.h"

namespace polhode {

/// The term of the parallel axis theorem for a point `arm` (m) away from the centre of mass: m (|a|^2 1 - a a^T), in
/// kg m^2.
template <class S>
Matrix3<S> parallel_axis(const S& mass, const Vector3<S>& arm) {
    const S square = dot(arm, arm);
    Matrix3<S> m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m[i][j] = mass * ((i == j ? square : S(0)) - arm[i] * arm[j]);
    return m;
}

/// Principal moments (kg m^2) and the unit quaternion that maps principal components to body components:
/// I_B = R(q_BP) diag(moments) R(q_BP)^T. A diagonal tensor keeps its axes and their order, with q_BP = 1 exactly.
struct PrincipalFrame {
    Vector3<double> moments;          ///< I1, I2, I3, kg m^2
    Quaternion<double> q_BP;          ///< principal axes to body axes, of unit length
    Vector3<double> gyroscopic;       ///< (I2 - I3)/I1, (I3 - I1)/I2, (I1 - I2)/I3, each rounded once
    Vector3<double> inverse_moments;  ///< 1/I_i, rounded once
};

/// A principal frame before it is rounded to binary64.
struct WidePrincipalFrame {
    Vector3<Wide> moments;  ///< kg m^2
    Quaternion<Wide> q_BP;  ///< principal axes to body axes, of unit length
};

/// The principal frame of an inertia tensor (kg m^2), by Jacobi rotations in 128-bit arithmetic. If the tensor is not
/// symmetric, its symmetric part is used.
WidePrincipalFrame wide_principal_frame(const Matrix3<Wide>& inertia);

/// The frame in binary64. Every number is rounded once.
PrincipalFrame rounded(const WidePrincipalFrame& frame);

/// The principal frame of an inertia tensor (kg m^2) in binary64. Every number is rounded once.
inline PrincipalFrame principal_frame(const Matrix3<Wide>& inertia) { return rounded(wide_principal_frame(inertia)); }

}  // namespace polhode
