// Representations of orientations and conversions between them: quaternion, rotation matrix, axis and angle, rotation
// vector, Euler angles in all twelve sequences.
//
// All of them map body vectors to world vectors: v_W = q v_B q* = A v_B. Conversions from quaternions accept any
// nonzero length. Conversions to quaternions return unit length within a few rounding errors. q and -q are the same
// orientation.
#pragma once

#include <array>
#include <string_view>

#include "body/algebra.h"

namespace polhode {

/// The matrix of the cross product: skew(a) b = a x b.
template <class S>
Matrix3<S> skew(const Vector3<S>& a) {
    Matrix3<S> m;
    m[0] = {S(0), -a[2], a[1]};
    m[1] = {a[2], S(0), -a[0]};
    m[2] = {-a[1], a[0], S(0)};
    return m;
}

/// |q| without overflow or underflow of its square.
double norm(const Quaternion<double>& q);

/// The determinant of m.
template <class S>
S determinant(const Matrix3<S>& m) {
    return dot(m[0], cross(m[1], m[2]));
}

// Rotation vectors, axis and angle

/// Exponential map: the rotation by |v| (rad) about v, right-handed. |v| may have any value; v = 0 gives 1. S: double
/// or float.
template <class S = double>
Quaternion<S> quaternion_from_rotation_vector(const Vector3<S>& v);

/// Logarithm: the shortest rotation vector (rad), |v| in [0, pi]. It jumps from v to -v (1 - pi/|v|) where |v| would
/// pass pi; at exactly pi (w = 0) its sign follows that of q. Accurate to a few ulp of |v| at every angle, including
/// 0 and pi.
Vector3<double> rotation_vector_from_quaternion(const Quaternion<double>& q);

/// A rotation by an angle about an axis, right-handed.
struct AxisAngle {
    Vector3<double> axis{0, 0, 1};  ///< unit
    double angle = 0;               ///< rad
};

/// The axis may have any nonzero length, the angle any value. Throws std::invalid_argument for a zero axis with a
/// nonzero angle.
Quaternion<double> quaternion_from_axis_angle(const AxisAngle& turn);

// Matrices

/// Frobenius norm of A^T A - 1.
double orthogonality_defect(const Matrix3<double>& A);

/// Throws std::invalid_argument unless A is a rotation: finite, A^T A = 1 within `tolerance` (orthogonality_defect),
/// det A > 0. The message is one line with the defect and its value.
void require_rotation(const Matrix3<double>& A, double tolerance = 1e-9);

/// The quaternion of a rotation matrix with rounding errors or a small drift, w >= 0. It is computed from its largest
/// component (S. W. Shepperd 1978, J. Guidance and Control 1, 223), which is well-conditioned for every rotation.
/// Throws like require_rotation.
Quaternion<double> quaternion_from_matrix(const Matrix3<double>& A);

/// The quaternion of a rotation matrix, without checks. The result is meaningless for any other matrix. NaN input
/// gives NaN.
Quaternion<double> quaternion_from_rotation(const Matrix3<double>& A);

/// The orthogonalisation of D. Fleck's slide: X = col1 / |col1|, Z = X x col2 / |..|, Y = Z x X / |..|. It keeps the
/// direction of the first column and ignores the third. NaN if the first two columns are parallel or zero. S: double
/// or float.
template <class S = double>
Matrix3<S> reorthogonalise(const Matrix3<S>& A);

/// The rotation nearest to A in the Frobenius norm: the orthogonal factor of its polar decomposition, by scaled
/// Newton iteration (N. J. Higham 1986, SIAM J. Sci. Stat. Comput. 7, 1160). Throws std::invalid_argument unless A is
/// finite with det A > 0.
Matrix3<double> nearest_rotation(const Matrix3<double>& A);

// Euler angles

/// The axes of three successive rotations about the moving axes (intrinsic): zyx is yaw about z, pitch about the new
/// y, roll about the newest x. The reversed sequence about fixed axes (extrinsic) gives the same orientation. The
/// first six are Tait-Bryan sequences, the last six proper Euler sequences.
enum class EulerSequence { xyz, xzy, yxz, yzx, zxy, zyx, xyx, xzx, yxy, yzy, zxz, zyz };

/// All twelve sequences.
inline constexpr std::array<EulerSequence, 12> euler_sequences{
    EulerSequence::xyz, EulerSequence::xzy, EulerSequence::yxz, EulerSequence::yzx,
    EulerSequence::zxy, EulerSequence::zyx, EulerSequence::xyx, EulerSequence::xzx,
    EulerSequence::yxy, EulerSequence::yzy, EulerSequence::zxz, EulerSequence::zyz};

/// The sequence as text: "xyz", ..
std::string_view name_of(EulerSequence sequence);
/// Whether the first and the last axis are the same.
bool is_proper(EulerSequence sequence);

/// Angles in the order of application, rad.
using EulerAngles = std::array<double, 3>;

/// q = q_i(angles[0]) q_j(angles[1]) q_k(angles[2]). The angles may have any value.
Quaternion<double> quaternion_from_euler(EulerSequence sequence, const EulerAngles& angles);

/// The Euler angles (rad) of q: first and third in (-pi, pi], second in [-pi/2, pi/2] (Tait-Bryan) or [0, pi]
/// (proper). After E. Bernardes & S. Viollet 2022, PLoS ONE 17, e0276302.
///
/// Discontinuous where the first or third angle passes pi, and at gimbal lock, the ends of the second angle's range.
/// There, first and third rotation share an axis, and only the sum or difference of their angles is defined. Within
/// 1e-15 rad of gimbal lock the third angle is set to 0. At a distance d from it, the second angle is accurate to
/// about 1e-15, the first and third to about 1e-16 / d. The orientation given by all three is accurate to about 1e-15
/// everywhere.
EulerAngles euler_from_quaternion(EulerSequence sequence, const Quaternion<double>& q);

// Between two directions and two orientations

/// Angle between two vectors of any lengths, in [0, pi], accurate also near 0 and pi; 0 if one of them is zero.
double angle_between(const Vector3<double>& a, const Vector3<double>& b);

/// Spherical linear interpolation: the fraction t of the rotation from a to b, the shorter way (at most pi). t = 0
/// gives a, t = 1 gives b or -b. Discontinuous where a and b are pi apart, since both ways have the same length. Of
/// unit length for unit a.
Quaternion<double> slerp(const Quaternion<double>& a, const Quaternion<double>& b, double t);

/// Angle between two orientations, in [0, pi]: 2 atan2(|vec(b* a)|, |scal(b* a)|). The quaternions may have any
/// nonzero length.
double rotation_angle_between(const Quaternion<double>& a, const Quaternion<double>& b);

}  // namespace polhode
