#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "body/rigid_body.h"
#include "body/wide.h"
#include "motion/moderate_scene.h"

namespace polhode {
namespace {

using namespace polhode::testing;

/// The largest entry of I - R diag R^T, computed in 128 bits, relative to the largest entry of I.
double misfit(const Matrix3<double>& tensor, const PrincipalFrame& frame) {
    const Quaternion<Wide> q = cast<Wide>(frame.q_BP);
    const Wide norm = squared_norm(q);
    Matrix3<Wide> R = rotation_matrix(q);
    Wide worst = 0, largest = 0;
    const Matrix3<Wide> back = R * diagonal(cast<Wide>(frame.moments)) * transposed(R);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const Wide entry = tensor[i][j], off = entry - back[i][j] / (norm * norm);
            worst = std::max(worst, off < 0 ? Wide(-off) : off);
            largest = std::max(largest, entry < 0 ? Wide(-entry) : entry);
        }
    return double(worst / largest);
}

void check(const Matrix3<double>& tensor) {
    const PrincipalFrame frame = principal_frame(cast<Wide>(tensor));
    // moments and quaternion are rounded once each: one ulp per entry
    RC_ASSERT(misfit(tensor, frame) < 1e-15);
    RC_ASSERT(std::abs(squared_norm(frame.q_BP) - 1) < 1e-15);
    const Vector3<double>& I = frame.moments;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        RC_ASSERT(I[i] > 0);
        RC_ASSERT(std::abs(frame.inverse_moments[i] * I[i] - 1) < 4e-16);
        // formed before the moments were rounded: the quotient contains one relative rounding error of each moment
        RC_ASSERT(std::abs(frame.gyroscopic[i] - (I[j] - I[k]) / I[i]) < 4e-16 * (I[j] + I[k]) / I[i]);
    }
}

RC_GTEST_PROP(PrincipalFrame, GivesTheTensorBack, ()) { check(moderate_inertia()); }

Matrix3<double> turned(const Vector3<double>& moments, const Quaternion<double>& q) {
    const Matrix3<double> R = rotation_matrix(q);
    Matrix3<double> I = R * diagonal(moments) * transposed(R);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j) I[i][j] = I[j][i];
    return I;
}

RC_GTEST_PROP(PrincipalFrame, TakesMomentsThatNearlyAgree, ()) {
    const double gap = std::ldexp(1.0, -*rc::gen::inRange(1, 60));
    check(turned({1, 1 + gap, 1 + gap * moderate(0, 1)}, moderate_orientation()));
}

RC_GTEST_PROP(PrincipalFrame, TakesExtremeRatiosAndSizes, ()) {
    // a needle: two nearly equal moments, the third tiny
    const double sliver = std::pow(10, -moderate(0, 12)), size = std::pow(10, moderate(-12, 12));
    check(turned({size, size * (1 + sliver / 4), size * sliver}, moderate_orientation()));
}

RC_GTEST_PROP(PrincipalFrame, TakesTinyProducts, ()) {
    Matrix3<double> I = diagonal(Vector3<double>(1, 2, 2.5));
    I[0][1] = I[1][0] = std::pow(10, -moderate(0.5, 300));
    I[0][2] = I[2][0] = -std::pow(10, -moderate(0.5, 300));
    check(I);
}

RC_GTEST_PROP(PrincipalFrame, LeavesADiagonalTensorAlone, ()) {
    const double a = moderate(0.1, 2), b = moderate(0.1, 2), c = moderate(0.1, 2);
    const Vector3<double> moments(a + b, b + c, c + a);
    const PrincipalFrame frame = principal_frame(cast<Wide>(diagonal(moments)));
    RC_ASSERT(frame.moments == moments);
    RC_ASSERT((frame.q_BP == Quaternion<double>{1, 0, 0, 0}));
}

RC_GTEST_PROP(PrincipalFrame, ShiftsByTheParallelAxisTheorem, ()) {
    const Matrix3<double> I = moderate_inertia();
    const double mass = moderate(0.1, 3);
    const Vector3<double> arm = moderate_vector();
    // the sum is formed in 128 bits, here in binary64: one ulp of its entries
    RC_ASSERT(misfit(I + parallel_axis(mass, arm),
                     principal_frame(cast<Wide>(I) + parallel_axis(Wide(mass), cast<Wide>(arm)))) < 2e-15);
}

/// Shifting the tensor from the centre of mass to a point and back recovers it, up to the rounding of m r^2 <= 36.
RC_GTEST_PROP(ParallelAxis, LeadsThereAndBack, ()) {
    const Matrix3<double> about_center = moderate_inertia();
    const double mass = moderate(0.1, 3);
    const Vector3<double> arm = moderate_vector();
    const Matrix3<double> shift = parallel_axis(mass, arm), there = about_center + shift;
    for (int i = 0; i < 3; ++i) RC_ASSERT(distance(there[i] - shift[i], about_center[i]) < 36 * 4e-16);
    // the shift is even in the arm
    RC_ASSERT(parallel_axis(mass, arm) == parallel_axis(mass, -arm));
}

/// If the moments about the centre of mass satisfy the triangle inequality, those about any other point do too. No
/// moment about the other point is smaller than the smallest about the centre of mass.
RC_GTEST_PROP(ParallelAxis, KeepsTheTriangleInequality, ()) {
    const Matrix3<double> about_center = moderate_inertia();
    const double mass = moderate(0.1, 3), reach = std::pow(10, moderate(-6, 6));
    const Vector3<double> I = principal_frame(cast<Wide>(about_center)).moments;
    const Vector3<double> J =
        principal_frame(cast<Wide>(about_center) + parallel_axis(Wide(mass), cast<Wide>(reach * moderate_vector())))
            .moments;
    const double largest = std::max({J[0], J[1], J[2]});
    for (int i = 0; i < 3; ++i) RC_ASSERT(J[i] <= J[(i + 1) % 3] + J[(i + 2) % 3] + 1e-15 * largest);
    RC_ASSERT(std::min({J[0], J[1], J[2]}) >= std::min({I[0], I[1], I[2]}) - 1e-15 * largest);
}

TEST(PrincipalFrame, FindsTheAxesOfAKnownTensor) {
    // rotated by 30 degrees about z: I_xx = I1 cos^2 + I2 sin^2, I_xy = (I1 - I2) sin cos
    const double c = std::cos(M_PI / 6), s = std::sin(M_PI / 6);
    Matrix3<double> I = diagonal(Vector3<double>(c * c + 2 * s * s, s * s + 2 * c * c, 2.5));
    I[0][1] = I[1][0] = -s * c;
    const PrincipalFrame frame = principal_frame(cast<Wide>(I));
    EXPECT_NEAR(frame.moments[0], 1, 1e-15);
    EXPECT_NEAR(frame.moments[1], 2, 1e-15);
    EXPECT_EQ(frame.moments[2], 2.5);
    const Vector3<double> x = rotate(frame.q_BP, Vector3<double>(1, 0, 0));
    EXPECT_NEAR(std::abs(dot(x, Vector3<double>(c, s, 0))), 1, 1e-15);
}

TEST(Wide, SquareRootIsRightToTheLastBits) {
    for (const Wide x : {Wide(2), Wide(1) / 3, Wide(1e-300) * Wide(1e-300), Wide(1e300) * Wide(1e300), Wide(0x1p-40)}) {
        const Wide root = square_root(x), off = (root * root - x) / x;
        EXPECT_LT(double(off < 0 ? -off : off), 1e-33);
    }
    EXPECT_EQ(double(square_root(Wide(0))), 0);
    EXPECT_EQ(double(square_root(Wide(HUGE_VAL))), HUGE_VAL);
}

}  // namespace
}  // namespace polhode
