#include "measure/growth.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <random>

namespace polhode {
namespace {

std::vector<double> times(int count) {
    std::vector<double> t;
    for (int i = 0; i <= count; ++i) t.push_back(0.5 * i);
    return t;
}

std::vector<double> power(const std::vector<double>& t, double factor, double exponent) {
    std::vector<double> e;
    for (const double x : t) e.push_back(x > 0 ? factor * std::pow(x, exponent) : 0);
    return e;
}

RC_GTEST_PROP(ErrorGrowth, FindsTheExponentOfAPower, ()) {
    const double exponent = *rc::gen::inRange(1, 40) / 10.0, factor = std::pow(10, -*rc::gen::inRange(10, 300));
    const std::vector<double> t = times(2000);
    const auto growth = error_growth(t, power(t, factor, exponent));
    RC_ASSERT(growth.has_value());
    RC_ASSERT(std::abs(growth->exponent - exponent) < 1e-9);
    RC_ASSERT(growth->uncertainty < 1e-9);
    RC_ASSERT(growth->to == t.back());
    RC_ASSERT(std::abs(growth->from - t.back() / 100) <= 1e-9 * t.back());
}

TEST(ErrorGrowth, IsHalfOfARandomWalkAndThreeHalvesOfItsSum) {
    // Brouwer's law, as the mean over random walks with fixed seeds; single exponents vary by a few tenths
    const std::vector<double> t = times(20000);
    double walk_mean = 0, sum_mean = 0;
    constexpr int walks = 50;
    for (unsigned seed = 1; seed <= walks; ++seed) {
        std::mt19937 generator(seed);
        std::vector<double> walk{0}, sum{0};
        for (std::size_t i = 1; i < t.size(); ++i) {
            walk.push_back(walk.back() + (generator() & 1U ? 1e-16 : -1e-16));
            sum.push_back(sum.back() + walk.back());
        }
        walk_mean += error_growth(t, walk)->exponent / walks;
        sum_mean += error_growth(t, sum)->exponent / walks;
    }
    EXPECT_NEAR(walk_mean, 0.5, 0.06);
    EXPECT_NEAR(sum_mean, 1.5, 0.1);
}

TEST(ErrorGrowth, OfABoundedErrorIsNil) {
    const std::vector<double> t = times(2000);
    std::vector<double> e;
    for (const double x : t) e.push_back(1e-9 * std::sin(x));
    EXPECT_NEAR(error_growth(t, e)->exponent, 0, 1e-3);
}

TEST(ErrorGrowth, LooksNoFurtherThanSaturation) {
    const std::vector<double> t = times(2000);
    std::vector<double> e = power(t, 1e-4, 2);  // reaches 1 rad at t = 100 s, then wraps
    for (double& x : e) x = std::abs(std::remainder(x, 2 * M_PI));
    const auto growth = error_growth(t, e, 1);
    ASSERT_TRUE(growth);
    EXPECT_NEAR(growth->exponent, 2, 1e-9);
    EXPECT_NEAR(growth->to, 100, 0.5);
}

TEST(ErrorGrowth, SaysNothingOfTooLittle) {
    EXPECT_FALSE(error_growth({}, {}));
    EXPECT_FALSE(error_growth({0, 1, 2}, {0, 0, 0}));
    EXPECT_FALSE(error_growth({0, 1, 2, 3, 4, 5}, {0, 1, 2, 3, 4, 5}));  // less than a decade
    const std::vector<double> t = times(100);
    EXPECT_FALSE(error_growth(t, std::vector<double>(t.size(), 0.0)));
}

TEST(ErrorEnvelope, NeverFallsAndIsEvenInLogTime) {
    const std::vector<double> t = times(2000);
    std::vector<double> e;
    for (const double x : t) e.push_back(x * std::cos(x));
    const Envelope envelope = error_envelope(t, e);
    ASSERT_GT(envelope.t.size(), 30U);
    ASSERT_LT(envelope.t.size(), 100U);
    for (std::size_t i = 1; i < envelope.t.size(); ++i) {
        EXPECT_GE(envelope.error[i], envelope.error[i - 1]);
        EXPECT_GE(envelope.t[i] / envelope.t[i - 1], std::pow(10, 1 / 20.0) * (1 - 1e-9));
    }
}

TEST(ErrorGrowth, IsThatOfTheSizeOfErrorsBelowZero) {
    const std::vector<double> t = times(2000);
    EXPECT_NEAR(error_growth(t, power(t, -1e-9, 2))->exponent, 2, 1e-9);
}

TEST(ErrorGrowth, TellsHowFarItsHalvesAreApart) {
    // the last two decades are fitted: t up to 100, t^2 / 100 beyond, so each half has its own slope
    const std::vector<double> t = times(2000);
    std::vector<double> e;
    for (const double x : t) e.push_back(1e-9 * (x <= 100 ? x : x * x / 100));
    const auto growth = error_growth(t, e);
    ASSERT_TRUE(growth);
    EXPECT_NEAR(growth->exponent, 1.5, 0.03);
    EXPECT_NEAR(growth->uncertainty, 0.5, 0.01);
}

TEST(ErrorGrowth, AnErrorAtSaturationIsNotBeyondIt) {
    const std::vector<double> t = times(2000);
    const auto growth = error_growth(t, std::vector<double>(t.size(), 1.0), 1);
    ASSERT_TRUE(growth);
    EXPECT_EQ(growth->exponent, 0);
    EXPECT_EQ(growth->to, 1000);
}

TEST(ErrorGrowth, NeedsFourPoints) {
    EXPECT_FALSE(error_growth({1, 8, 20}, {1, 2, 3}));
    EXPECT_TRUE(error_growth({1, 3, 8, 20}, {1, 2, 3, 4}));
}

TEST(ErrorEnvelope, HasNoPointAtTheStart) {
    EXPECT_EQ(error_envelope({0, 1, 2}, {1, 1, 1}).t, (std::vector<double>{1, 2}));
    // evenly spaced up to round-off: a point that misses its place by round-off is included
    const double next = std::pow(10, 1 / 20.0);
    EXPECT_EQ(error_envelope({1, next * (1 - 1e-15)}, {1, 1}).t.size(), 2U);
}

}  // namespace
}  // namespace polhode
