// Radix-2^58 numbers against MPFR with more digits.
#include "integrators/series/limb_real.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <vector>

#include "integrators/series/series.h"
#include "tests/integrators/series/random_system.h"

namespace polhode::truth {
namespace {

using Exact = Real<250>;

template <unsigned digits>
Exact exact(const Real<digits>& x) {
    Exact result;
    mpfr_set(raw(result), raw(x), MPFR_RNDN);
    return result;
}
// The exact value: repeatedly subtracts the nearest number of the precision and converts the rest.
template <unsigned digits>
Exact exact(LimbReal<digits> x) {
    Exact sum(0);
    for (int part = 0; part < 3; ++part) {
        const auto nearest = static_cast<Real<digits>>(x);
        sum += exact(nearest);
        x -= LimbReal<digits>(nearest);
    }
    return sum;
}

// Random numbers of either sign with all, few or no bits set, of similar and of very different sizes.
template <unsigned digits>
Real<digits> random_real(int most_exponent) {
    const int kind = *rc::gen::inRange(0, 8);
    Real<digits> x(0);
    if (kind == 0) return x;
    if (kind == 1) {
        x = *rc::gen::element(1, -1);
    } else {
        for (int word = 0; word < (kind == 2 ? 1 : 8); ++word)
            x = x * Real<digits>(0x1p-53) +
                Real<digits>(static_cast<double>(*rc::gen::inRange<std::int64_t>(-(1LL << 53), 1LL << 53)));
    }
    mpfr_mul_2si(raw(x), raw(x), *rc::gen::inRange(-most_exponent, most_exponent + 1), MPFR_RNDN);
    return x;
}

// The documented error bound for `terms` products.
template <unsigned digits>
Exact allowed(int terms) {
    Exact unit(terms);
    mpfr_mul_2si(raw(unit), raw(unit), -LimbReal<digits>::radix_bits * (LimbReal<digits>::size - 1) + 2, MPFR_RNDN);
    return unit;
}

template <unsigned digits>
void check_arithmetic(int most_exponent) {
    using T = LimbReal<digits>;
    const Real<digits> x[4] = {random_real<digits>(most_exponent), random_real<digits>(most_exponent),
                               random_real<digits>(most_exponent), random_real<digits>(most_exponent)};
    T t[4], scratch, combined;
    Exact e[4];
    for (int i = 0; i < 4; ++i) {
        t[i] = T(x[i]), e[i] = exact(x[i]);
        RC_ASSERT(exact(t[i]) == e[i]);
        RC_ASSERT(static_cast<Real<digits>>(t[i]) == x[i]);
        RC_ASSERT(exact(-t[i]) == -e[i]);
        if (x[i] == 0)
            RC_ASSERT(t[i].is_zero());
        else
            RC_ASSERT(std::abs(log2_magnitude(t[i]) - log2_magnitude(x[i])) < 1e-12 * (1 + most_exponent));
    }
    const auto near = [&](const T& got, const Exact& want, const Exact& size, int terms) {
        RC_ASSERT(abs(Exact(exact(got) - want)) <= allowed<digits>(terms) * abs(size));
    };
    near(t[0] * t[1], e[0] * e[1], e[0] * e[1], 1);
    const Exact size = abs(e[0]) > abs(e[1]) ? e[0] : e[1];
    near(t[0] + t[1], e[0] + e[1], size, 1);
    near(t[0] - t[1], e[0] - e[1], size, 1);
    combine(combined, t[0], t[1], t[2], t[3], scratch);
    const Exact first = e[0] * e[1], second = e[2] * e[3];
    near(combined, first + second, abs(first) > abs(second) ? first : second, 2);
    const auto divisor = static_cast<unsigned long>(*rc::gen::inRange(1, 1000));
    T quotient = t[0];
    divide(quotient, divisor);
    near(quotient, e[0] / divisor, e[0] / divisor, 1);
}

RC_GTEST_PROP(LimbReal, HasThePrecisionThatItStates, ()) {
    check_arithmetic<50>(80);
    check_arithmetic<50>(2000);
    check_arithmetic<100>(300);
}

// Half of a power of the radix is a digit 1/2 or half the radix, depending on the power.
TEST(LimbReal, HalvesKeepThePrecision) {
    using T = LimbReal<50>;
    for (const int power : {-117, -59, -1, 57, 115})
        for (const int sign : {-1, 1}) {
            Real<50> half(sign), third = Real<50>(4) / 3;
            mpfr_mul_2si(raw(half), raw(half), power, MPFR_RNDN);
            EXPECT_EQ(exact(T(half)), exact(half));
            const Exact product = exact(half) * exact(third);
            EXPECT_LE(abs(Exact(exact(T(half) * T(third)) - product)), allowed<50>(1) * abs(product)) << power;
        }
}

template <unsigned digits>
void check_convolution(int most_exponent) {
    using T = LimbReal<digits>;
    const int k = *rc::gen::inRange(0, 80);
    std::vector<T> a, b;
    std::vector<Exact> x, y;
    for (int j = 0; j <= k; ++j) {
        const Real<digits> first = random_real<digits>(most_exponent), second = random_real<digits>(most_exponent);
        a.emplace_back(first), b.emplace_back(second), x.push_back(exact(first)), y.push_back(exact(second));
    }
    const auto check = [&](const std::vector<T>& c, const std::vector<Exact>& z) {
        T result, scratch;
        convolve(result, a.data(), c.data(), k, scratch);
        Exact sum(0), largest(0);
        for (int j = 0; j <= k; ++j) {
            const Exact product = x[j] * z[k - j];
            sum += product, largest = std::max(largest, Exact(abs(product)));
        }
        RC_ASSERT(abs(Exact(exact(result) - sum)) <= allowed<digits>(k + 1) * largest);
    };
    check(b, y);
    check(a, x);
}

RC_GTEST_PROP(LimbReal, SumsProductsToThePrecisionOfTheLargest, ()) {
    check_convolution<50>(10);
    check_convolution<50>(400);
    check_convolution<100>(200);
}

// The columns do not overflow with all digits at their maximum and as many products as the longest series has.
TEST(LimbReal, ColumnsHoldTheLongestSumOfTheLargestDigits) {
    using T = LimbReal<100>;
    Real<100> x(1);
    mpfr_mul_2si(raw(x), raw(x), 57, MPFR_RNDN);
    Real<100> digit = x, sum(0);
    for (int i = 0; i < T::size; ++i, mpfr_mul_2si(raw(digit), raw(digit), -58, MPFR_RNDN)) sum += digit - 1;
    const std::vector<T> row(512, T(sum));
    const std::vector<T> other(512, T(sum));
    T result, scratch;
    convolve(result, row.data(), other.data(), 511, scratch);
    const Exact want = 512 * exact(sum) * exact(sum);
    EXPECT_LE(abs(Exact(exact(result) - want)), allowed<100>(512) * want);
}

TEST(LimbReal, WhatIsNotFiniteIsNotANumberAndStaysSo) {
    using T = LimbReal<50>;
    const T one(1), zero(0), none{Real<50>(std::numeric_limits<double>::infinity())};
    EXPECT_TRUE(none.is_nan());
    T quotient = one / zero, root = sqrt(T(-1)), combined, scratch;
    EXPECT_TRUE(quotient.is_nan());
    EXPECT_TRUE(root.is_nan());
    EXPECT_TRUE((none * zero).is_nan());
    EXPECT_TRUE((none + one).is_nan());
    EXPECT_TRUE((zero - none).is_nan());
    combine(combined, one, one, zero, none, scratch);
    EXPECT_TRUE(combined.is_nan());
    const T row[2] = {zero, none}, zeros[2] = {zero, zero};
    convolve(combined, row, zeros, 1, scratch);
    EXPECT_TRUE(combined.is_nan());
    EXPECT_TRUE(mpfr_nan_p(raw(static_cast<Real<50>>(combined))));
    EXPECT_TRUE(std::isnan(log2_magnitude(none)));
    divide(quotient, 3);
    EXPECT_TRUE(quotient.is_nan());
    // beyond the exponent range
    T large{Real<50>(2)};
    for (int i = 0; i < 60; ++i) large = large * large;
    EXPECT_TRUE(large.is_nan());
}

// The Taylor coefficients of a random system agree with those from MPFR.
RC_GTEST_PROP(LimbReal, GivesTheTaylorCoefficientsOfMpfr, ()) {
    const testing::RandomSystem system = testing::random_system(30);
    const int n = static_cast<int>(system.variables), order = 24;
    using P = Real<50>;
    const Recording<P> recording = record<P>(system, n);
    Series<P> reference(recording, order);
    Series<LimbReal<50>> series(cast_recording<LimbReal<50>>(recording), order);
    std::vector<P> start, end(n), other(n);
    for (const double y : system.start) start.emplace_back(y);
    reference.expand(start.data());
    series.expand(start.data());
    for (int i = 0; i < n; ++i)
        for (int k = 0; k <= order; ++k) {
            const P want = reference.coefficient(i, k), off = abs(P(P(series.coefficient(i, k)) - want));
            // rounding relative to the largest coefficient so far
            P largest(1);
            for (int j = 0; j <= k; ++j) largest = std::max(largest, P(abs(reference.coefficient(i, j))));
            RC_ASSERT(off <= P(1e-40) * largest);
        }
    reference.evaluate(P(0x1p-9), end.data());
    series.evaluate(P(0x1p-9), other.data());
    for (int i = 0; i < n; ++i) RC_ASSERT(abs(P(end[i] - other[i])) <= P(1e-44));
}

// x' = x, t' = 1, q' = t^3
struct GrowthAndPower {
    template <class S>
    void derivative(const S* y, S* dy) const {
        dy[0] = y[0];
        dy[1] = S(1);
        dy[2] = y[1] * y[1] * y[1];
    }
};

// A short step does not need the highest terms, but a variable may start with a high power.
TEST(LimbReal, EvaluatesShortSteps) {
    using R = Real<50>;
    Series<LimbReal<50>> series(cast_recording<LimbReal<50>>(record<R>(GrowthAndPower{}, 3)), 40);
    const std::vector<R> start{R(1), R(0), R(0)};
    series.expand(start.data());
    for (const double size : {0.5, 1e-3, 1e-20, 1e-60}) {
        const R h(size);
        std::vector<R> end(3);
        series.evaluate(h, end.data());
        EXPECT_LE(abs(R(end[0] - exp(h))), R(1e-49)) << size;
        EXPECT_LE(abs(R(end[2] / (h * h * h * h) - R(0.25))), R(1e-49)) << size;
    }
    EXPECT_EQ(series.last_term(0, 2.0), 40);
    EXPECT_LE(series.last_term(0, std::log2(1e-20)), 3);
}

}  // namespace
}  // namespace polhode::truth
