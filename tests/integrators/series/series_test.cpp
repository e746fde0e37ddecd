// Components of the truth: recorded right-hand sides, Taylor coefficients, Radau tables, decimal strings.
#include "integrators/series/series.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "body/algebra.h"
#include "integrators/series/radau_nodes.h"
#include "integrators/truth/rounded_decimal.h"
#include "motion/dual.h"
#include "tests/integrators/series/random_system.h"

namespace polhode::truth {
namespace {

using R = Real<50>;

TEST(Traced, FoldsConstantsAndSharesNodes) {
    Tape<double> tape;
    tape.nodes.push_back({TapeNode<double>::Kind::state, 0, 0, 0, 0});
    tape.nodes.push_back({TapeNode<double>::Kind::state, 1, 0, 0, 0});
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
    // the remainder of the series of 1 / (1 - t) is t^13 / (1 - t) = 2.1e-12
    EXPECT_NEAR(end[0], 1 / 0.875, 2.2e-12);
}

// t' = 1 and functions of t as rates: a rate's k-th coefficient is (k + 1) times the next coefficient of the variable.
struct OfTime {
    template <class S>
    void derivative(const S* y, S* dy) const {
        const S &t = y[0], one(1), two(2);
        dy[0] = one;
        sine_cosine(two * t + S(0.5), dy[1], dy[2]);
        dy[3] = one / (one - t);
        dy[4] = (t + one) / (two - t);
        dy[5] = square_root(one + two * t);
        S s(0), c(0);
        sine_cosine(-t, s, c);
        dy[6] = s / c;  // -tan
    }
};

template <class T>
void check_closed_forms(double tolerance) {
    constexpr int order = 24;
    Series<T> series(record<T>(OfTime{}, 7), order);
    const std::vector<T> start(7, T(0));
    series.expand(start.data());
    T s(0), c(0), power(1), root(1), geometric(1);  // 2^k / k!, (1/2 over k) 2^k, 2^-k
    sine_cosine(T(0.5), s, c);
    // tan t = t + t^3 / 3 + 2 t^5 / 15 + 17 t^7 / 315 + 62 t^9 / 2835
    const T tangent[10] = {T(0),         T(1), T(0),           T(1) / T(3), T(0),
                           T(2) / T(15), T(0), T(17) / T(315), T(0),        T(62) / T(2835)};
    for (int k = 0; k < order; ++k) {
        const auto rate = [&](int i) { return T(series.coefficient(i, k + 1) * T(k + 1)); };
        const auto near = [&](const T& value, const T& expected) {
            const T off = value - expected, size = T(1) + (expected < 0 ? T(-expected) : expected);
            EXPECT_LE(static_cast<double>(T(off * off)), tolerance * tolerance * static_cast<double>(T(size * size)))
                << k;
        };
        const bool odd = k % 2 != 0, low = k % 4 >= 2;
        near(rate(1), (odd ? c : s) * power * T(low ? -1 : 1));
        near(rate(2), (odd ? s : c) * power * T(odd == low ? 1 : -1));
        near(rate(3), T(1));
        near(rate(4), k == 0 ? T(0.5) : T(1.5) * geometric);
        near(rate(5), root);
        if (k < 10) near(rate(6), -tangent[k]);
        power = power * T(2) / T(k + 1), geometric = geometric / T(2);
        root = root * (T(1) - T(2 * k)) / T(k + 1);
    }
}

TEST(Series, SinesQuotientsAndRootsHaveTheirClosedForms) {
    check_closed_forms<double>(1e-14);
    check_closed_forms<long double>(1e-14);
    check_closed_forms<R>(1e-47);
}

// t' = 1 and the first rate of a random system with the variables c_i t + start_i, so a function of t only
struct AlongALine {
    const testing::RandomSystem& system;
    template <class S>
    S value(const S& t) const {
        std::vector<S> y, dy(system.variables, S(0));
        for (std::size_t i = 0; i < system.variables; ++i)
            y.push_back(S(1.0 - 0.5 * static_cast<double>(i)) * t + S(system.start[i]));
        system.derivative(y.data(), dy.data());
        return dy[0];
    }
    template <class S>
    void derivative(const S* y, S* dy) const {
        dy[0] = S(1), dy[1] = value(y[0]);
    }
};

// The remainder beyond order N is (h / r)^N relative to the size, where r is the radius of convergence. A dozen
// smooth operations on numbers of order 1 keep r above 1/16: 8^-24 and 32^-40 are below the tolerances.
template <class T>
void check_polynomial(const testing::RandomSystem& system, int order, double step, double tolerance) {
    const AlongALine line{system};
    Series<T> series(record<T>(line, 2), order);
    const T start[2] = {T(0), T(0)}, h(step);
    series.expand(start);
    T sum(0);
    for (int k = order - 1; k >= 0; --k) sum = sum * h + series.coefficient(1, k + 1) * T(k + 1);
    const T off = sum - line.value(h);
    RC_ASSERT(static_cast<double>(T(off * off)) <= tolerance * tolerance);
}

RC_GTEST_PROP(Series, OfRandomFunctionsSumToThem, ()) {
    const testing::RandomSystem system = testing::random_system(12);
    check_polynomial<double>(system, 24, 0x1p-7, 1e-13);
    check_polynomial<R>(system, 40, 0x1p-9, 1e-40);
}

// The Jacobian from dual numbers satisfies y'' = J f, with y'' from the second Taylor coefficients.
RC_GTEST_PROP(Dual, HasTheJacobianThatTheSecondCoefficientsSay, ()) {
    const testing::RandomSystem system = testing::random_system(40);
    const int n = static_cast<int>(system.variables);
    Series<double> series(record<double>(system, n), 2);
    series.expand(system.start.data());
    using Dual = polhode::Dual<4>;
    std::vector<Dual> y, dy(4);
    double size = 1;
    for (int i = 0; i < n; ++i) y.emplace_back(system.start[i]), y[i].slope[i] = 1;
    system.derivative(y.data(), dy.data());
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) size = std::max(size, std::abs(dy[i].slope[j]));
    for (int i = 0; i < n; ++i) {
        double second = 0;
        for (int j = 0; j < n; ++j) second += dy[i].slope[j] * dy[j].value;
        RC_ASSERT(std::abs(dy[i].value - series.coefficient(i, 1)) <= 1e-13);
        RC_ASSERT(std::abs(second - 2 * series.coefficient(i, 2)) <= 1e-12 * size);
    }
}

TEST(Dual, DividesByAndIntoNumbers) {
    using Dual = polhode::Dual<2>;
    Dual x(4.0);
    x.slope = {1, -2};
    const Dual half = x / 2.0, inverse = 2.0 / x;
    EXPECT_EQ(half.value, 2);
    EXPECT_EQ(half.slope[1], -1);
    EXPECT_EQ(inverse.value, 0.5);
    EXPECT_EQ(inverse.slope[0], -0.125);
    Dual sine = x, cosine;
    sine_cosine(sine, sine, cosine);
    EXPECT_EQ(sine.slope[1], -2 * std::cos(4.0));
    EXPECT_EQ(cosine.slope[1], 2 * std::sin(4.0));
    EXPECT_EQ(square_root(x).slope[1], -0.5);
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
    // quadrature exact up to degree 2 s - 2, each stage up to degree s - 1; 24 stages lose a few of 50 digits
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
    // the last coefficient of the shifted P_s is 1, and so is the last but one of P_{s-1}
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
