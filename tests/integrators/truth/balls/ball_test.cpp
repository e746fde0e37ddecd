// Balls: equality holds only for provably equal numbers, and decimals contain the number they were made from.
#include "integrators/truth/balls/ball.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <string>

#include "integrators/series/real.h"
#include "integrators/truth/balls/ball_decimal.h"
#include "motion/traced.h"

namespace polhode::truth {
namespace {

TEST(Ball, IsEqualOnlyWhereBothAreExact) {
    const WorkingPrecision precision(100);
    const Ball third = Ball(1) / Ball(3);
    EXPECT_FALSE(third.is_exact());
    EXPECT_FALSE(third == third);
    EXPECT_FALSE(third - third == 0);
    EXPECT_TRUE((third - third).contains_zero());
    EXPECT_TRUE(Ball(0.375) == Ball(3) / Ball(8));
    EXPECT_TRUE(Ball(0.375) - Ball(0.375) == 0);
}

TEST(Ball, WorkingPrecisionIsGivenBack) {
    const long before = Ball::precision();
    {
        const WorkingPrecision outer(300);
        const WorkingPrecision inner(70);
        EXPECT_EQ(Ball::precision(), 70);
    }
    EXPECT_EQ(Ball::precision(), before);
}

TEST(Ball, TracedFoldsWhatIsExactlyZeroAndNothingElse) {
    const WorkingPrecision precision(80);
    using Kind = TapeNode<Ball>::Kind;
    Tape<Ball> tape;
    tape.nodes.push_back({Kind::state, 0, 0, Ball(0), Ball(0)});
    tape.nodes.push_back({Kind::state, 1, 0, Ball(0), Ball(0)});
    using T = Traced<Ball>;
    const T x(Ball(1), 0, &tape), y(Ball(1), 1, &tape);
    const Ball third = Ball(1) / Ball(3), unknown = third - third;
    EXPECT_EQ((Ball(0) * x).node, T::constant);
    EXPECT_EQ((x - x).node, T::constant);
    // possibly zero but not provably, so the term stays
    EXPECT_EQ((unknown * x).node, x.node);
    EXPECT_EQ((third * x - third * x).node, x.node);
    // x / 3 + y twice: two balls for 1/3 need not be the same number, so there are two nodes
    const T a = third * x + y, b = third * x + y;
    EXPECT_NE(a.node, b.node);
    EXPECT_EQ((Ball(0.5) * x + y).node, (Ball(0.5) * x + y).node);
}

TEST(Bound, IsRoundedUpward) {
    Bound sum;
    for (int i = 0; i < 1000; ++i) sum += Bound(0.1);
    EXPECT_GE(sum.near(), 100);
    EXPECT_LT(sum.near(), 100.001);
    EXPECT_GE(exponential(Ball(-1)).near(), std::exp(-1.0));
    EXPECT_LT(exponential(Ball(-1)).near(), std::exp(-1.0) * (1 + 1e-8));
    EXPECT_TRUE(Bound(2.0) < Bound(3.0));
}

TEST(BallDecimal, BoundsAreRoundedUpward) {
    EXPECT_EQ(decimal_above(Bound()), "0");
    using R = Real<50>;
    for (const double x : {1.0, 0.1, 3.14159, 9.949e-31, 9.99e7, 1e-300, 2.5e-35}) {
        const std::string text = decimal_above(Bound(x));
        EXPECT_GE(R(text), R(x)) << text;
        EXPECT_LE(R(text), R(x) * R("1.11")) << text;
    }
}

RC_GTEST_PROP(BallDecimal, HoldsTheBall, (std::int32_t mantissa, std::int8_t exponent)) {
    const WorkingPrecision precision(200);
    using R = Real<100>;
    const double number = std::ldexp(static_cast<double>(mantissa), exponent);
    for (const double radius : {0.0, 1e-20}) {
        const Ball ball = widened(Ball(number), Bound(radius));
        Bound error;
        const std::string text = decimal_near(ball, -18, error);
        const R distance = abs(R(R(text) - R(number)));
        RC_ASSERT(distance + R(radius) <= R(decimal_above(error)));
        // half a unit in the last place, plus the radius
        RC_ASSERT(R(decimal_above(error)) <= R("0.56e-18") + R(radius) * 2);
    }
}

TEST(Ball, IsWidenedByWhatIsSaid) {
    const Ball wide = widened(Ball(1), Bound(0.25));
    EXPECT_TRUE((wide - Ball(1.25)).contains_zero());
    EXPECT_TRUE((wide - Ball(0.75)).contains_zero());
    EXPECT_FALSE((wide - Ball(1.26)).contains_zero());
}

TEST(Bound, WhatIsLeastIsRoundedDownward) {
    const Ball wide = widened(Ball(-1), Bound(0.25));
    EXPECT_LE(Bound::least_of(wide).near(), 0.75);
    EXPECT_GT(Bound::least_of(wide).near(), 0.75 * (1 - 1e-8));
    EXPECT_GE(Bound(wide).near(), 1.25);
    EXPECT_EQ(Bound::least_of(widened(Ball(1), Bound(2.0))).near(), 0);
    // 1 - 2^-40 with thirty bits: rounded down, but close to 1
    const double less = least_difference(Bound::least_of(Ball(1)), Bound(0x1p-40)).near();
    EXPECT_LE(less, 1 - 0x1p-40);
    EXPECT_GT(less, 1 - 1e-8);
    EXPECT_TRUE(least_difference(Bound(1.0), Bound(2.0)).is_zero());
}

}  // namespace
}  // namespace polhode::truth
