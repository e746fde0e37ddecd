#include "body/algebra.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "body/rigid_body.h"
#include "motion/moderate_scene.h"

namespace polhode {
namespace {

using namespace polhode::testing;

// tolerance for a dozen operations on numbers of order one: a few ulp each
constexpr double dozen_roundings = 2e-14;

RC_GTEST_PROP(Rotation, PreservesLengthsAndHandedness, ()) {
    const Quaternion<double> q = moderate_orientation();
    const Vector3<double> a = moderate_vector(), b = moderate_vector();
    RC_ASSERT(std::abs(dot(rotate(q, a), rotate(q, b)) - dot(a, b)) < 10 * dozen_roundings);
    RC_ASSERT(distance(cross(rotate(q, a), rotate(q, b)), rotate(q, cross(a, b))) < 10 * dozen_roundings);
}

RC_GTEST_PROP(Rotation, OfAProductIsTheProductOfRotations, ()) {
    const Quaternion<double> a = moderate_orientation(), b = moderate_orientation();
    RC_ASSERT(largest_difference(rotation_matrix(a * b), rotation_matrix(a) * rotation_matrix(b)) < dozen_roundings);
    const Vector3<double> v = moderate_vector();
    RC_ASSERT(distance(rotate(a * b, v), rotate(a, rotate(b, v))) < 2 * dozen_roundings);
}

RC_GTEST_PROP(Rotation, HasOneMeaning, ()) {
    // q of any length: every form contains the factor |q|^2
    const double s = moderate(0.2, 3);
    const Quaternion<double> u = moderate_orientation(), q{s * u.w, s * u.x, s * u.y, s * u.z};
    const Vector3<double> v = moderate_vector();
    const Matrix3<double> R = rotation_matrix(q);
    const double tolerance = 20 * dozen_roundings;
    RC_ASSERT(distance(rotate(q, v), R * v) < tolerance);
    RC_ASSERT(distance(rotate_back(q, v), transposed(R) * v) < tolerance);
    const Quaternion<double> sandwich = q * Quaternion<double>{0, v[0], v[1], v[2]} * conjugate(q);
    RC_ASSERT(distance(rotate(q, v), vector_part(sandwich)) < tolerance);
    RC_ASSERT(std::abs(sandwich.w) < tolerance);
    for (int b = 0; b < 3; ++b) RC_ASSERT(distance(world_axis(q, b), R[b]) < tolerance);
}

TEST(Rotation, TurnsTheRightWay) {
    const double half = std::sqrt(0.5);
    // a quarter rotation about z maps x to y
    EXPECT_LT(distance(rotate(Quaternion<double>{half, 0, 0, half}, Vector3<double>(1, 0, 0)), {0, 1, 0}), 1e-15);
    const Quaternion<double> i{0, 1, 0, 0}, j{0, 0, 1, 0};
    EXPECT_EQ(i * j, (Quaternion<double>{0, 0, 0, 1}));
}

RC_GTEST_PROP(Matrix, TimesItsInverseIsOne, ()) {
    const Matrix3<double> I = moderate_inertia();
    const Matrix3<double> one = diagonal(Vector3<double>(1, 1, 1));
    // the condition number is at most 20
    RC_ASSERT(largest_difference(I * inverse(I), one) < 20 * dozen_roundings);
    RC_ASSERT(largest_difference(inverse(I) * I, one) < 20 * dozen_roundings);
}

RC_GTEST_PROP(CrossProduct, IsTheTensorOfAPointMass, ()) {
    // m r x (w x r) = m (|r|^2 1 - r r^T) w
    const Vector3<double> r = moderate_vector(), w = moderate_vector();
    const double m = moderate(0.1, 3);
    RC_ASSERT(distance(parallel_axis(m, r) * w, m * cross(r, cross(w, r))) < 100 * dozen_roundings);
}

/// The parallel axis theorem agrees with the definition of the inertia tensor: sums over a few point masses about
/// their centre of mass and about another point.
RC_GTEST_PROP(ParallelAxis, IsWhatPointMassesSay, ()) {
    const int n = *rc::gen::inRange(3, 8);
    std::vector<std::pair<double, Vector3<double>>> points;
    double mass = 0;
    Vector3<double> first;
    for (int i = 0; i < n; ++i) {
        points.emplace_back(moderate(0.1, 2), moderate_vector());
        mass += points.back().first;
        first = first + points.back().first * points.back().second;
    }
    const Vector3<double> center = (1 / mass) * first, other = moderate_vector();
    Matrix3<double> about_center, about_other;
    for (const auto& [m, r] : points)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                // the textbook definition: sum of m (r.r delta_ij - r_i r_j)
                const Vector3<double> c = r - center, o = r - other;
                about_center[i][j] += m * ((i == j ? dot(c, c) : 0) - c[i] * c[j]);
                about_other[i][j] += m * ((i == j ? dot(o, o) : 0) - o[i] * o[j]);
            }
    // masses up to 16, distances up to 7: entries of several hundred
    RC_ASSERT(largest_difference(about_center + parallel_axis(mass, center - other), about_other) <
              1000 * dozen_roundings);
}

}  // namespace
}  // namespace polhode
