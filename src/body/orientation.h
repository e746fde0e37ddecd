// Ways to write an orientation, and between them: quaternion, rotation matrix, axis and angle, rotation vector, Euler
// angles in all twelve sequences.
//
// All of them map body vectors to world vectors: v_W = q v_B q* = A v_B. Conversions from quaternions take one of any
// length but zero; those to quaternions give one of length 1 but for a few roundings. q and -q are one orientation.
#pragma once

#include <array>
#include <string_view>

#include "body/algebra.h"

namespace polhode {

/// The tilde operator: skew(a) b = a x b.
template <class S>
Matrix3<S> skew(const Vector3<S>& a) {
    Matrix3<S> m;
    m[0] = {S(0), -a[2], a[1]};
    m[1] = {a[2], S(0), -a[0]};
    m[2] = {-a[1], a[0], S(0)};
    return m;
}

/// |q|, also where its square is beyond binary64.
double norm(const Quaternion<double>& q);

template <class S>
S determinant(const Matrix3<S>& m) {
    return dot(m[0], cross(m[1], m[2]));
}

// Rotation vectors, axis and angle

/// exp: a turn by |v| (rad) about v, right-handed. Any length; 1 for v = 0. S: double or float.
template <class S = double>
Quaternion<S> quaternion_from_rotation_vector(const Vector3<S>& v);

/// log: the shortest, |v| in [0, pi]. Jumps from v to -v (1 - pi/|v|) where |v| would pass pi; at pi exactly (w = 0)
/// the sign is that of q as given. Accurate to a few ulp of the whole vector at every angle, 0 and pi included.
Vector3<double> rotation_vector_from_quaternion(const Quaternion<double>& q);

struct AxisAngle {
    Vector3<double> axis{0, 0, 1};  ///< unit
    double angle = 0;               ///< rad
};

/// The axis may have any length but zero, the angle any value. Throws std::invalid_argument for a zero axis with an
/// angle that is not zero.
Quaternion<double> quaternion_from_axis_angle(const AxisAngle& turn);

/// The angle in [0, pi]. Without a turn there is no axis: it is z then. The axis jumps to its opposite where the angle
/// would pass pi, and is lost in rounding as the angle goes to 0 (its error is some 1e-16 / angle where q is rounded).
AxisAngle axis_angle_from_quaternion(const Quaternion<double>& q);

// Matrices

/// Frobenius norm of A^T A - 1.
double orthogonality_defect(const Matrix3<double>& A);

/// Throws std::invalid_argument, with one line that says what A is and the number that shows it, unless A is a
/// rotation: finite, A^T A = 1 within `tolerance` (orthogonality_defect), and no reflection (det A > 0).
void require_rotation(const Matrix3<double>& A, double tolerance = 1e-9);

/// The quaternion of a rotation matrix that may be off by rounding or a little drift, found by its largest component
/// (S. W. Shepperd 1978, J. Guidance and Control 1, 223), which is well-conditioned everywhere. w >= 0. Throws like
/// require_rotation.
Quaternion<double> quaternion_from_matrix(const Matrix3<double>& A);

/// The quaternion of a matrix that is not checked: what comes of anything but a rotation has no meaning. NaN in, NaN
/// out.
Quaternion<double> quaternion_from_rotation(const Matrix3<double>& A);

/// As on D. Fleck's slide: X = col1 / |col1|, Z = X x col2 / |..|, Y = Z x X / |..|. The first column keeps its
/// direction, the third takes all of the blame. NaN where the first two columns are parallel or zero. S: double or
/// float.
template <class S = double>
Matrix3<S> reorthogonalised(const Matrix3<S>& A);

/// The rotation nearest to A in the Frobenius norm: the orthogonal factor of its polar decomposition, by Newton's
/// iteration with scaling (N. J. Higham 1986, SIAM J. Sci. Stat. Comput. 7, 1160). Throws std::invalid_argument unless
/// A is finite with det A > 0.
Matrix3<double> nearest_rotation(const Matrix3<double>& A);

// Euler angles

/// The axes turned about, one after the other, each where the turns before it have brought it (intrinsic): zyx is yaw
/// about z, then pitch about the new y, then roll about the newest x. The same letters backwards about fixed axes
/// (extrinsic) are the same orientation. The first six are Tait-Bryan angles, the last six proper Euler angles.
enum class EulerSequence { xyz, xzy, yxz, yzx, zxy, zyx, xyx, xzx, yxy, yzy, zxz, zyz };

inline constexpr std::array<EulerSequence, 12> euler_sequences{
    EulerSequence::xyz, EulerSequence::xzy, EulerSequence::yxz, EulerSequence::yzx,
    EulerSequence::zxy, EulerSequence::zyx, EulerSequence::xyx, EulerSequence::xzx,
    EulerSequence::yxy, EulerSequence::yzy, EulerSequence::zxz, EulerSequence::zyz};

/// "xyz", ..
std::string_view name_of(EulerSequence sequence);
/// Throws std::invalid_argument for anything but one of the twelve names.
EulerSequence parse_euler_sequence(std::string_view name);
/// Whether the first and the last axis are the same.
bool is_proper(EulerSequence sequence);

/// In the order in which they are applied, rad.
using EulerAngles = std::array<double, 3>;

/// q = q_i(angles[0]) q_j(angles[1]) q_k(angles[2]). Any values.
Quaternion<double> quaternion_from_euler(EulerSequence sequence, const EulerAngles& angles);

/// First and third angle in (-pi, pi], the second in [-pi/2, pi/2] (Tait-Bryan) or [0, pi] (proper); after E. Bernardes
/// & S. Viollet 2022, PLoS ONE 17, e0276302.
///
/// Discontinuous where the first or third passes pi, and at gimbal lock, the ends of the second's range: there first
/// and third turn about the same axis and only their sum or difference is defined. Within 1e-15 rad of it the third is
/// set to 0. At a distance d from it the second is right to some 1e-15, first and third to some 1e-16 / d; the
/// orientation that the three stand for is right to some 1e-15 everywhere.
EulerAngles euler_from_quaternion(EulerSequence sequence, const Quaternion<double>& q);

// Between two directions and two orientations

/// Angle between two vectors of any lengths, in [0, pi], accurate also near its ends; 0 where one is zero.
double angle_between(const Vector3<double>& a, const Vector3<double>& b);

/// The orientation that a turn of constant rate reaches a share t of the way from a to b, the shorter way round (at
/// most pi); t = 0 gives a, t = 1 b or -b. Jumps where a and b are pi apart: both ways are as short then. Of unit
/// length for unit a.
Quaternion<double> slerp(const Quaternion<double>& a, const Quaternion<double>& b, double t);

/// Angle between two orientations, in [0, pi]: 2 atan2(|vec(b* a)|, |scal(b* a)|), any lengths.
double rotation_angle_between(const Quaternion<double>& a, const Quaternion<double>& b);

}  // namespace polhode
