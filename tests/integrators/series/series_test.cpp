// The parts of the truth: recorded right-hand sides, Taylor coefficients, Radau tables, decimal strings.
#include "integrators/series/series.h"

#include <gtest/gtest.h>

#include <cmath>

#include "body/algebra.h"
#include "integrators/series/radau_nodes.h"
#include "integrators/truth/rounded_decimal.h"

namespace polhode::truth {
namespace {

using R = Real<50>;

TEST(Traced, FoldsConstantsAndSharesNodes) {
    Tape<double> tape;
    tape.nodes.push_back({Node<double>::Kind::state, 0, 0, 0, 0});
    tape.nodes.push_back({Node<double>::Kind::state, 1, 0, 0, 0});
    using T = Traced<double>;
    const T x(1, 0, &tape), y(1, 1, &tape);
    EXPECT_EQ((0.0 * x).node, T::constant);
    EXPECT_EQ((x + T(0)).node, x.node);
    EXPECT_EQ((T(1) * x).node, x.node);
    EXPECT_EQ((3.0 * x + x).factor, 4);
    EXPECT_EQ((x - x).node, T::constant);
    EXPECT_EQ((T(2) * T(3)).factor, 6);
    EXPECT_EQ(tape.nodes.size(), 2u);
    EXPECT_EQ((x * y).node, (5.0 * y * x).node);
    EXPECT_EQ((x + y).node, (y + x).node);
    EXPECT_EQ(tape.nodes.size(), 4u);
}

// x' = x^2, y' = x y - 2 y + 3: x = 1 / (1 - t) from x(0) = 1
struct Riccati {
    template <class S>
    void derivative(const S* y, S* dy) const {
        dy[0] = y[0] * y[0];
        dy[1] = y[0] * y[1] - 2.0 * y[1] + 3.0;
    }
};

TEST(Series, SquareAndProductFollowTheGeometricSeries) {
    Series<double> series(record<double>(Riccati{}, 2), 12);
    const double start[2] = {1, 2};
    series.expand(start);
    double previous = 2;
    for (int k = 0; k <= 12; ++k) EXPECT_NEAR(series.coefficient(0, k), 1, 1e-14);
    // (k + 1) y_{k+1} = sum of y_0..y_k - 2 y_k + 3 [k = 0]
    double sum = 0;
    for (int k = 0; k < 12; ++k) {
        EXPECT_NEAR(series.coefficient(1, k), previous, 1e-13);
        sum += previous;
        previous = (sum - 2 * previous + (k == 0 ? 3 : 0)) / (k + 1);
    }
    double end[2];
    series.evaluate(0.125, end);
    // the remainder of 1 / (1 - t) is t^13 / (1 - t) = 2.1e-12
    EXPECT_NEAR(end[0], 1 / 0.875, 2.2e-12);
}

TEST(Radau, HasTheKnownTables) {
    const RadauNodes<R> two(2);
    const R small(1e-45);
    EXPECT_LT(abs(R(two.c[0] - R(1) / 3)), small);
    EXPECT_LT(abs(R(two.c[1] - 1)), small);
    // Hairer & Wanner, table IV.5.5
    const R a[4] = {R(5) / 12, R(-1) / 12, R(3) / 4, R(1) / 4};
    for (int i = 0; i < 4; ++i) EXPECT_LT(abs(R(two.a[i] - a[i])), small);
    const RadauNodes<R> three(3);
    EXPECT_LT(abs(R(three.c[0] - (4 - sqrt(R(6))) / 10)), small);
    EXPECT_LT(abs(R(three.a[0] - (88 - 7 * sqrt(R(6))) / 360)), small);
}

TEST(Radau, IntegratesPolynomialsExactly) {
    // the quadrature up to degree 2 s - 2, each stage up to degree s - 1; 24 stages lose a few digits of 50
    const int s = 24;
    const RadauNodes<R> table(s);
    const R small(1e-44);
    for (int k = 0; k <= 2 * s - 2; ++k) {
        R sum(0);
        for (int i = 0; i < s; ++i) sum += table.b[i] * pow(table.c[i], k);
        EXPECT_LT(abs(R(sum - R(1) / (k + 1))), small) << k;
    }
    for (int i = 0; i < s; ++i)
        for (const int k : {0, 1, s - 1}) {
            R sum(0);
            for (int j = 0; j < s; ++j) sum += table.a[i * s + j] * pow(table.c[j], k);
            EXPECT_LT(abs(R(sum - pow(table.c[i], k + 1) / (k + 1))), small) << i << ' ' << k;
        }
}

TEST(Radau, LastLegendreCoefficientIsThePolynomials) {
    // of the shifted P_s itself it is 1, and of P_{s-1} the last but one
    const int s = 8;
    const RadauNodes<R> table(s);
    R last(0), last_but_one(0);
    for (int j = 0; j <= s; ++j) {
        const std::vector<R> p = legendre(R(2 * table.nodes[j] - 1), s);
        last += table.last[j] * p[s];
        last_but_one += table.last_but_one[j] * p[s - 1];
    }
    EXPECT_LT(abs(R(last - 1)), R(1e-45));
    EXPECT_LT(abs(R(last_but_one - 1)), R(1e-45));
}

TEST(Decimal, Rounds) {
    EXPECT_EQ(rounded_decimal("1.23456e-03", 3), "1.23e-3");
    EXPECT_EQ(rounded_decimal("-1.23556e+10", 4), "-1.236e10");
    EXPECT_EQ(rounded_decimal("9.9996e+00", 4), "1.000e1");
    EXPECT_EQ(rounded_decimal("1.5", 1), "1.5");
    EXPECT_EQ(rounded_decimal("0", 5), "0");
    EXPECT_EQ(rounded_decimal("4.5e-120", 1), "5e-120");
}

}  // namespace
}  // namespace polhode::truth
