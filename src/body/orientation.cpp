// Conversions between quaternions, matrices, axis and angle, rotation vectors and Euler angles; see orientation.h for
// ranges and accuracy. Sources: Shepperd 1978 (quaternion_from_matrix), Higham 1986 (nearest_rotation), Bernardes &
// Viollet 2022 (euler_from_quaternion).

#include "body/orientation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "body/elementary.h"
#include "body/mass_properties.h"

namespace polhode {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double lock = 1e-15;  // rad: closer to gimbal lock, the rounding of q dominates

template <class S>
Vector3<S> column(const Matrix3<S>& m, int j) {
    return {m[0][j], m[1][j], m[2][j]};
}

template <class S>
Vector3<S> unit(const Vector3<S>& v) {
    const S l = hypotenuse(v);
    return {v[0] / l, v[1] / l, v[2] / l};
}

template <class S>
Matrix3<S> from_columns(const Vector3<S>& x, const Vector3<S>& y, const Vector3<S>& z) {
    Matrix3<S> m;
    for (int i = 0; i < 3; ++i) m[i] = {x[i], y[i], z[i]};
    return m;
}

bool finite(const Matrix3<double>& A) {
    double zeros = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) zeros += A[i][j] * 0;
    return zeros == 0;
}

std::string number(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", x);
    return text;
}

double& component(Quaternion<double>& q, int axis) { return axis == 0 ? q.x : axis == 1 ? q.y : q.z; }

Quaternion<double> about(int axis, double angle) {
    Quaternion<double> q{std::cos(angle / 2), 0, 0, 0};
    component(q, axis) = std::sin(angle / 2);
    return q;
}

struct Axes {
    int i, j, k;
};
Axes axes_of(EulerSequence sequence) {
    const std::string_view name = name_of(sequence);
    return {name[0] - 'x', name[1] - 'x', name[2] - 'x'};
}

// wraps into (-pi, pi]
double wrapped(double angle) {
    if (angle > pi) return angle - 2 * pi;
    if (angle <= -pi) return angle + 2 * pi;
    return angle;
}

}  // namespace

template <class S>
Quaternion<S> quaternion_from_rotation_vector(const Vector3<S>& v) {
    const S angle = hypotenuse(v);
    // sin(x/2)/x: 1/2 where x^2/24 is negligible
    const S s = angle < S(1e-8) ? S(0.5) : std::sin(angle / 2) / angle;
    return {std::cos(angle / 2), s * v[0], s * v[1], s * v[2]};
}
template Quaternion<double> quaternion_from_rotation_vector(const Vector3<double>&);
template Quaternion<float> quaternion_from_rotation_vector(const Vector3<float>&);

Vector3<double> rotation_vector_from_quaternion(const Quaternion<double>& q) {
    const Vector3<double> u = q.w < 0 ? -vector_part(q) : vector_part(q);
    const double sine = hypotenuse(u);
    if (sine == 0) return {};
    const double half = std::atan2(sine, std::abs(q.w));
    return (2 * half) * Vector3<double>(u[0] / sine, u[1] / sine, u[2] / sine);
}

Quaternion<double> quaternion_from_axis_angle(const AxisAngle& turn) {
    if (turn.angle == 0) return {};
    if (hypotenuse(turn.axis) == 0)
        throw std::invalid_argument("the axis of a rotation by " + number(turn.angle) + " rad has length 0");
    const double s = std::sin(turn.angle / 2);
    const Vector3<double> n = unit(turn.axis);
    return {std::cos(turn.angle / 2), s * n[0], s * n[1], s * n[2]};
}

double orthogonality_defect(const Matrix3<double>& A) {
    double sum = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const double entry = dot(column(A, i), column(A, j)) - (i == j ? 1 : 0);
            sum += entry * entry;
        }
    return std::sqrt(sum);
}

void require_rotation(const Matrix3<double>& A, double tolerance) {
    if (!finite(A)) throw std::invalid_argument("not a rotation matrix: an entry is not finite");
    const double det = determinant(A), defect = orthogonality_defect(A);
    if (!(defect <= tolerance))
        throw std::invalid_argument("not a rotation matrix: |A^T A - 1| is " + number(defect) + ", must be within " +
                                    number(tolerance) + " of 0");
    if (!(det > 0))
        throw std::invalid_argument("not a rotation matrix but a reflection: the determinant is " + number(det) +
                                    ", must be 1");
}

Quaternion<double> quaternion_from_matrix(const Matrix3<double>& A) {
    require_rotation(A);
    return quaternion_from_rotation(A);
}

Quaternion<double> quaternion_from_rotation(const Matrix3<double>& A) {
    // 4 w^2 = 1 + tr, 4 x^2 = 1 + 2 A_xx - tr, ..: the largest of the four is at least 1
    const double trace = A[0][0] + A[1][1] + A[2][2];
    int i = 0;
    for (int k = 1; k < 3; ++k)
        if (A[k][k] > A[i][i]) i = k;
    Quaternion<double> q;
    if (trace >= A[i][i]) {
        q = {1 + trace, A[2][1] - A[1][2], A[0][2] - A[2][0], A[1][0] - A[0][1]};
    } else {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        q.w = A[k][j] - A[j][k];
        component(q, i) = 1 + A[i][i] - A[j][j] - A[k][k];
        component(q, j) = A[j][i] + A[i][j];
        component(q, k) = A[k][i] + A[i][k];
    }
    q = normalized(q);
    return q.w < 0 ? Quaternion<double>{-q.w, -q.x, -q.y, -q.z} : q;
}

template <class S>
Matrix3<S> reorthogonalise(const Matrix3<S>& A) {
    const Vector3<S> X = unit(column(A, 0)), Z = unit(cross(X, column(A, 1))), Y = unit(cross(Z, X));
    return from_columns(X, Y, Z);
}
template Matrix3<double> reorthogonalise(const Matrix3<double>&);
template Matrix3<float> reorthogonalise(const Matrix3<float>&);

Matrix3<double> nearest_rotation(const Matrix3<double>& A) {
    if (!finite(A)) throw std::invalid_argument("a matrix with entries that are not finite has no nearest rotation");
    const double det = determinant(A);
    if (!(det > 0))
        throw std::invalid_argument("a matrix must have a determinant > 0 to have a nearest rotation, not " +
                                    number(det));
    const auto norm = [](const Matrix3<double>& m) {
        return std::hypot(hypotenuse(m[0]), hypotenuse(m[1]), hypotenuse(m[2]));
    };
    Matrix3<double> X = A;
    // X <- (g X + X^-T / g) / 2: about ten iterations for any condition number that binary64 can represent
    constexpr int most = 60;
    for (int n = 0; n < most; ++n) {
        const Matrix3<double> Y = transposed(inverse(X));
        const double g = std::sqrt(norm(Y) / norm(X));
        double change = 0;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const double next = (g * X[i][j] + Y[i][j] / g) / 2;
                change = std::max(change, std::abs(next - X[i][j]));
                X[i][j] = next;
            }
        if (!(change > 4 * std::numeric_limits<double>::epsilon())) break;
    }
    return X;
}

std::string_view name_of(EulerSequence sequence) {
    constexpr std::array<std::string_view, 12> names{"xyz", "xzy", "yxz", "yzx", "zxy", "zyx",
                                                     "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"};
    return names.at(static_cast<std::size_t>(sequence));
}

bool is_proper(EulerSequence sequence) {
    const Axes a = axes_of(sequence);
    return a.i == a.k;
}

Quaternion<double> quaternion_from_euler(EulerSequence sequence, const EulerAngles& angles) {
    const Axes a = axes_of(sequence);
    return about(a.i, angles[0]) * about(a.j, angles[1]) * about(a.k, angles[2]);
}

// Proper angles first. With e_i e_j = s e_k (s = 1 for cyclic i, j, k), q_i(a) q_j(b) q_i(c) has the components
//   w = cos(b/2) cos((a+c)/2),  i: cos(b/2) sin((a+c)/2),  j: sin(b/2) cos((a-c)/2),  k: s sin(b/2) sin((a-c)/2).
// Tait-Bryan angles are the proper angles of another quaternion: the quarter rotation P = q_j(pi/2) maps e_i to -s
// e_k, so q_k(c) = P q_i(-s c) P* and q P = q_i(a) q_j(b + pi/2) q_i(-s c).
EulerAngles euler_from_quaternion(EulerSequence sequence, const Quaternion<double>& quaternion) {
    const Axes axes = axes_of(sequence);
    const bool proper = axes.i == axes.k;
    const int i = axes.i, j = axes.j, k = 3 - i - j;
    const double s = (j - i + 3) % 3 == 1 ? 1 : -1;
    Quaternion<double> q = quaternion;
    if (!proper) {
        Quaternion<double> quarter{1, 0, 0, 0};  // the quarter rotation times sqrt 2
        component(quarter, j) = 1;
        q = q * quarter;
    }
    const double qi = component(q, i), qj = component(q, j), qk = s * component(q, k);
    const double cosine = std::hypot(q.w, qi), sine = std::hypot(qj, qk);
    const double sum = std::atan2(qi, q.w), difference = std::atan2(qk, qj);
    EulerAngles angles{sum + difference, 2 * std::atan2(sine, cosine), sum - difference};
    // half of the distance from gimbal lock, where only rounding remains
    if (sine <= lock / 2 * cosine) angles = {2 * sum, angles[1], 0};
    if (cosine <= lock / 2 * sine) angles = {2 * difference, angles[1], 0};
    if (!proper) {
        angles[1] -= pi / 2;
        angles[2] *= -s;
    }
    return {wrapped(angles[0]), angles[1], wrapped(angles[2])};
}

double norm(const Quaternion<double>& q) { return std::hypot(std::hypot(q.w, q.x), std::hypot(q.y, q.z)); }

Quaternion<double> slerp(const Quaternion<double>& a, const Quaternion<double>& b, double t) {
    return a * quaternion_from_rotation_vector(t * rotation_vector_from_quaternion(conjugate(a) * b));
}

double angle_between(const Vector3<double>& a, const Vector3<double>& b) {
    return std::atan2(hypotenuse(cross(a, b)), dot(a, b));
}

double rotation_angle_between(const Quaternion<double>& a, const Quaternion<double>& b) {
    const Quaternion<double> d = conjugate(b) * a;
    return 2 * std::atan2(hypotenuse(vector_part(d)), std::abs(d.w));
}

}  // namespace polhode
