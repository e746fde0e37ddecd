// Conversions between attitude representations: round trips, comparison with each other and with closed forms, and
// behaviour at their discontinuities.
#include "body/orientation.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numbers>
#include <set>
#include <string_view>

#include "motion/moderate_scene.h"

namespace polhode {
namespace {

using namespace polhode::testing;

using std::numbers::pi;
// rounding error in rad of a dozen operations on numbers of order one: a few ulp
constexpr double angle_roundings = 4e-15;

Quaternion<double> negative(const Quaternion<double>& q) { return {-q.w, -q.x, -q.y, -q.z}; }

/// Any orientation, including rotations by nearly or exactly 0 and pi.
Quaternion<double> any_orientation() {
    const Vector3<double> axis = moderate_vector() + Vector3<double>(0, 0, 5);
    const double small = std::pow(10, -moderate(0, 20));
    const double sign = *rc::gen::arbitrary<bool>() ? 1 : -1;
    switch (*rc::gen::inRange(0, 4)) {
        case 0:
            return moderate_orientation();
        case 1:
            return quaternion_from_axis_angle({axis, sign * small});
        case 2:
            return quaternion_from_axis_angle({axis, pi + sign * small});
        default:
            return normalized(Quaternion<double>{moderate(-1, 1), moderate(-1, 1), moderate(-1, 1), 1.001});
    }
}

/// Elementary rotation matrix about x, y or z, as printed on the slide.
Matrix3<double> elementary(char axis, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    if (axis == 'x') return {{Vector3<double>(1, 0, 0), Vector3<double>(0, c, -s), Vector3<double>(0, s, c)}};
    if (axis == 'y') return {{Vector3<double>(c, 0, s), Vector3<double>(0, 1, 0), Vector3<double>(-s, 0, c)}};
    return {{Vector3<double>(c, -s, 0), Vector3<double>(s, c, 0), Vector3<double>(0, 0, 1)}};
}

RC_GTEST_PROP(RotationVector, GoesThereAndBack, ()) {
    const Quaternion<double> q = any_orientation();
    const Vector3<double> v = rotation_vector_from_quaternion(q);
    RC_ASSERT(length(v) <= pi * (1 + 1e-15));
    RC_ASSERT(rotation_angle_between(quaternion_from_rotation_vector(v), q) < angle_roundings);
    RC_ASSERT(distance(rotation_vector_from_quaternion(negative(q)), v) < angle_roundings || std::abs(q.w) < 1e-15);
    RC_ASSERT(rotation_angle_between(quaternion_from_axis_angle({v, length(v)}), q) < angle_roundings);
}

/// The quaternion agrees with Rodrigues' formula R = 1 + sin a [n] + (1 - cos a) [n]^2, evaluated with matrices.
RC_GTEST_PROP(RotationVector, IsRodriguesFormula, ()) {
    const Vector3<double> v = moderate_vector() + Vector3<double>(0, 0, 2.5);
    const double a = length(v);
    const Matrix3<double> n = skew(1 / a * v), square = n * n;
    Matrix3<double> R = diagonal(Vector3<double>(1, 1, 1));
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) R[i][j] += std::sin(a) * n[i][j] + (1 - std::cos(a)) * square[i][j];
    RC_ASSERT(largest_difference(rotation_matrix(quaternion_from_rotation_vector(v)), R) < angle_roundings);
}

TEST(RotationVector, KeepsEveryDigitOfASmallTurn) {
    for (const double size : {1e-3, 1e-7, 1e-9, 1e-20, 1e-200}) {
        const Vector3<double> v(0.48 * size, -0.6 * size, 0.64 * size);
        const Vector3<double> back = rotation_vector_from_quaternion(quaternion_from_rotation_vector(v));
        EXPECT_LT(distance(back, v), 4e-16 * size) << size;
    }
    EXPECT_EQ(quaternion_from_rotation_vector({}), Quaternion<double>{});
    EXPECT_EQ(rotation_vector_from_quaternion({-1, 0, 0, 0}), Vector3<double>());
}

TEST(RotationVector, JumpsToItsOppositeAtAHalfTurn) {
    const auto there_and_back = [](double angle) {
        return rotation_vector_from_quaternion(quaternion_from_rotation_vector({0, angle, 0}));
    };
    EXPECT_NEAR(there_and_back(pi - 1e-6)[1], pi - 1e-6, 1e-15);
    EXPECT_NEAR(there_and_back(pi + 1e-6)[1], -pi + 1e-6, 1e-15);
    // at exactly pi the sign is that of the quaternion
    EXPECT_EQ(rotation_vector_from_quaternion({0, 0, 1, 0})[1], pi);
    EXPECT_EQ(rotation_vector_from_quaternion({0, 0, -1, 0})[1], -pi);
}

TEST(AxisAngle, NeedsNoAxisWithoutATurn) {
    EXPECT_EQ(quaternion_from_axis_angle({{0, 0, 0}, 0}), Quaternion<double>{});
    EXPECT_THROW(quaternion_from_axis_angle({{0, 0, 0}, 1}), std::invalid_argument);
}

RC_GTEST_PROP(RotationMatrix, GoesThereAndBack, ()) {
    const Quaternion<double> q = any_orientation(), back = quaternion_from_matrix(rotation_matrix(q));
    RC_ASSERT(rotation_angle_between(back, q) < angle_roundings);
    RC_ASSERT(back.w >= 0);
    RC_ASSERT(std::abs(squared_norm(back) - 1) < angle_roundings);
}

TEST(RotationMatrix, OfEveryHalfTurnAboutAnAxisGivesThatAxis) {
    for (int axis = 0; axis < 3; ++axis) {
        Vector3<double> d(-1, -1, -1);
        d[axis] = 1;
        const Vector3<double> v = rotation_vector_from_quaternion(quaternion_from_matrix(diagonal(d)));
        EXPECT_EQ(std::abs(v[axis]), pi);
    }
}

std::string refusal(const Matrix3<double>& A) {
    try {
        quaternion_from_matrix(A);
    } catch (const std::invalid_argument& refused) {
        return refused.what();
    }
    return "";
}

/// A rotation with one axis mirrored is orthogonal with determinant -1.
RC_GTEST_PROP(RotationMatrix, RefusesEveryReflection, ()) {
    for (int i = 0; i < 3; ++i) {
        Vector3<double> mirror(1, 1, 1);
        mirror[i] = -1;
        const Matrix3<double> A = rotation_matrix(any_orientation()) * diagonal(mirror);
        RC_ASSERT(orthogonality_defect(A) < angle_roundings);
        RC_ASSERT(refusal(A).find("not a rotation matrix but a reflection: the determinant is -1") == 0);
    }
}

TEST(RotationMatrix, RefusesWhatIsNotOrthogonalAndSaysByHowMuch) {
    EXPECT_EQ(refusal(diagonal(Vector3<double>(1, 1, 2))),
              "not a rotation matrix: |A^T A - 1| is 3, must be within 1e-09 of 0");
    EXPECT_EQ(refusal(Matrix3<double>()), "not a rotation matrix: |A^T A - 1| is 1.73, must be within 1e-09 of 0");
    EXPECT_EQ(refusal(diagonal(Vector3<double>(1, NAN, 1))), "not a rotation matrix: an entry is not finite");
    EXPECT_EQ(refusal(diagonal(Vector3<double>(1, 1, 1 + 1e-10))), "");
    EXPECT_NO_THROW(require_rotation(diagonal(Vector3<double>(1, 1, 1.1)), 0.5));
}

/// A rotation times a symmetric stretch along arbitrary orthogonal axes.
struct Stretched {
    Matrix3<double> rotation, whole;
};
Stretched stretched(double most) {
    const Matrix3<double> R = rotation_matrix(any_orientation()), U = rotation_matrix(moderate_orientation());
    const Vector3<double> s(moderate(1, most), moderate(1, most), moderate(1, most));
    return {R, R * (U * diagonal(s) * transposed(U))};
}

/// The nearest rotation to A = R S, with S symmetric and positive definite, is R.
RC_GTEST_PROP(NearestRotation, IsThePolarFactor, ()) {
    const Stretched A = stretched(10);
    RC_ASSERT(largest_difference(nearest_rotation(A.whole), A.rotation) < 20 * angle_roundings);
    RC_ASSERT(orthogonality_defect(nearest_rotation(A.whole)) < angle_roundings);
}

TEST(NearestRotation, OfAnyScale) {
    const Matrix3<double> R = rotation_matrix(normalized(Quaternion<double>{0.3, -0.5, 0.7, 0.2}));
    for (const double scale : {1e-90, 1.0, 1e90}) {
        const Matrix3<double> A = R * diagonal(Vector3<double>(scale, 3 * scale, 2 * scale));
        EXPECT_LT(largest_difference(nearest_rotation(A), R), 1e-15) << scale;
    }
    EXPECT_THROW(nearest_rotation(diagonal(Vector3<double>(1, 1, -1))), std::invalid_argument);
    EXPECT_THROW(nearest_rotation(Matrix3<double>()), std::invalid_argument);
    EXPECT_THROW(nearest_rotation(diagonal(Vector3<double>(INFINITY, 1, 1))), std::invalid_argument);
}

/// The slide's algorithm returns a rotation. The first column keeps its direction; the third is perpendicular to the
/// first two columns of A.
RC_GTEST_PROP(Reorthogonalised, IsARotationAndKeepsTheFirstColumn, ()) {
    const Matrix3<double> A = stretched(1.5).whole, B = reorthogonalise(A);
    RC_ASSERT(orthogonality_defect(B) < angle_roundings);
    RC_ASSERT(std::abs(determinant(B) - 1) < angle_roundings);
    const auto column = [](const Matrix3<double>& m, int j) { return Vector3<double>(m[0][j], m[1][j], m[2][j]); };
    RC_ASSERT(length(cross(column(A, 0), column(B, 0))) < 2 * angle_roundings);
    RC_ASSERT(std::abs(dot(column(A, 1), column(B, 2))) < 2 * angle_roundings);
    // a rotation is returned unchanged
    RC_ASSERT(largest_difference(reorthogonalise(B), B) < angle_roundings);
}

RC_GTEST_PROP(Skew, IsTheCrossProduct, ()) {
    const Vector3<double> a = moderate_vector(), b = moderate_vector();
    RC_ASSERT(skew(a) * b == cross(a, b));
    RC_ASSERT(transposed(skew(a)) == skew(-a));
}

/// The quaternion agrees with the product of the three elementary matrices.
RC_GTEST_PROP(EulerAngles, AreThreeTurnsInTheirOrder, ()) {
    const EulerAngles angles{moderate(-7, 7), moderate(-7, 7), moderate(-7, 7)};
    for (const EulerSequence sequence : euler_sequences) {
        const std::string_view name = name_of(sequence);
        Matrix3<double> R = elementary(name[0], angles[0]);
        R = R * elementary(name[1], angles[1]);
        R = R * elementary(name[2], angles[2]);
        RC_ASSERT(largest_difference(rotation_matrix(quaternion_from_euler(sequence, angles)), R) < angle_roundings);
    }
}

bool in_range(EulerSequence sequence, const EulerAngles& a) {
    const double low = is_proper(sequence) ? 0 : -pi / 2, high = is_proper(sequence) ? pi : pi / 2;
    const double slack = 1e-15;
    return std::abs(a[0]) <= pi && std::abs(a[2]) <= pi && a[1] >= low - slack && a[1] <= high + slack;
}

/// Round trip of any orientation in any sequence, including second angles at a distance d = 10^0 .. 10^-20 rad from
/// gimbal lock. The orientation is always recovered to a few ulp; away from gimbal lock the angles are recovered too.
RC_GTEST_PROP(EulerAngles, GoThereAndBack, ()) {
    const Quaternion<double> anywhere = any_orientation();
    const double d = std::pow(10, -moderate(0, 20)), far = moderate(0.1, 1.4);
    const double first = moderate(-3.1, 3.1), third = moderate(-3.1, 3.1);
    const bool upper = *rc::gen::arbitrary<bool>();
    for (const EulerSequence sequence : euler_sequences) {
        EulerAngles angles = euler_from_quaternion(sequence, anywhere);
        RC_ASSERT(in_range(sequence, angles));
        RC_ASSERT(rotation_angle_between(quaternion_from_euler(sequence, angles), anywhere) < 2 * angle_roundings);

        const double low = is_proper(sequence) ? 0 : -pi / 2, high = is_proper(sequence) ? pi : pi / 2;
        for (const double distance_from_lock : {d, far}) {
            const double second = upper ? high - distance_from_lock : low + distance_from_lock;
            const EulerAngles in{first, second, third};
            const Quaternion<double> q = quaternion_from_euler(sequence, in);
            const EulerAngles out = euler_from_quaternion(sequence, q);
            RC_ASSERT(in_range(sequence, out));
            RC_ASSERT(rotation_angle_between(quaternion_from_euler(sequence, out), q) < 2 * angle_roundings);
            RC_ASSERT(std::abs(out[1] - second) < 2 * angle_roundings);
            const double tolerance = angle_roundings / distance_from_lock;
            if (tolerance < 0.01) {
                RC_ASSERT(std::abs(out[0] - first) < tolerance);
                RC_ASSERT(std::abs(out[2] - third) < tolerance);
            }
        }
    }
}

TEST(EulerAngles, HaveNoThirdAngleInGimbalLock) {
    for (const EulerSequence sequence : euler_sequences) {
        const double locked = is_proper(sequence) ? 0 : pi / 2;
        const Quaternion<double> q = quaternion_from_euler(sequence, {0.3, locked, 0.4});
        const EulerAngles out = euler_from_quaternion(sequence, q);
        EXPECT_EQ(out[2], 0) << name_of(sequence);
        EXPECT_NEAR(out[1], locked, 1e-15) << name_of(sequence);
        EXPECT_LT(rotation_angle_between(quaternion_from_euler(sequence, out), q), angle_roundings)
            << name_of(sequence);
    }
    // at z-y-x with pitch +90 deg only yaw - roll is determined
    const EulerAngles zyx =
        euler_from_quaternion(EulerSequence::zyx, quaternion_from_euler(EulerSequence::zyx, {0.9, pi / 2, 0.4}));
    EXPECT_NEAR(zyx[0], 0.5, 1e-15);
}

/// Yaw, pitch and roll agree with the textbook formulas from the matrix (z-y-x), away from gimbal lock.
RC_GTEST_PROP(EulerAngles, OfZyxAreYawPitchRoll, ()) {
    const EulerAngles in{moderate(-3, 3), moderate(-1.4, 1.4), moderate(-3, 3)};
    const Matrix3<double> R = rotation_matrix(quaternion_from_euler(EulerSequence::zyx, in));
    RC_ASSERT(std::abs(std::atan2(R[1][0], R[0][0]) - in[0]) < 1e-13);
    RC_ASSERT(std::abs(-std::asin(R[2][0]) - in[1]) < 1e-13);
    RC_ASSERT(std::abs(std::atan2(R[2][1], R[2][2]) - in[2]) < 1e-13);
}

TEST(EulerAngles, HaveDistinctNames) {
    std::set<std::string_view> names;
    for (const EulerSequence sequence : euler_sequences) names.insert(name_of(sequence));
    EXPECT_EQ(names.size(), euler_sequences.size());
}

/// Slerp has constant rate, meets both ends and never covers more than pi. q and -q are the same orientation.
RC_GTEST_PROP(Slerp, GoesTheShortestWayAtConstantRate, ()) {
    const Quaternion<double> a = any_orientation(), b = any_orientation();
    const double whole = rotation_angle_between(a, b);
    RC_ASSERT(whole <= pi * (1 + 1e-15));
    RC_ASSERT(rotation_angle_between(slerp(a, b, 0), a) < angle_roundings);
    RC_ASSERT(rotation_angle_between(slerp(a, b, 1), b) < 2 * angle_roundings);
    const int n = 8;
    Quaternion<double> before = a;
    for (int k = 1; k <= n; ++k) {
        const Quaternion<double> q = slerp(a, b, k / double(n));
        RC_ASSERT(std::abs(squared_norm(q) - 1) < 2 * angle_roundings);
        RC_ASSERT(std::abs(rotation_angle_between(q, before) - whole / n) < 2 * angle_roundings);
        before = q;
    }
    if (pi - whole > 1e-9) {
        RC_ASSERT(rotation_angle_between(slerp(a, b, 0.3), slerp(a, negative(b), 0.3)) < 2 * angle_roundings);
    }
}

}  // namespace
}  // namespace polhode
