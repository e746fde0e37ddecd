#include "integrators/own/radau_coefficients.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace polhode {
namespace {

class Coefficients : public ::testing::TestWithParam<int> {
  protected:
    const int s = GetParam();
    const RadauCoefficients& radau = radau_coefficients(s);
};

// B(2 s - 1): the last row integrates powers up to x^(2 s - 2) exactly. C(s): every row those up to x^(s - 1).
TEST_P(Coefficients, MeetTheOrderConditions) {
    EXPECT_EQ(radau.order(), 2 * s - 1);
    EXPECT_EQ(radau.nodes[s - 1], 1);
    for (int k = 1; k <= 2 * s - 1; ++k)
        for (int i = k <= s ? 0 : s - 1; i < s; ++i) {
            double sum = 0;
            for (int j = 0; j < s; ++j) sum += radau.a[j][i] * std::pow(radau.nodes[j], k - 1);
            EXPECT_NEAR(sum, std::pow(radau.nodes[i], k) / k, 4e-16) << "row " << i << ", power " << k;
        }
}

TEST_P(Coefficients, LeaveLanesBeyondTheStagesZero) {
    for (int i = s; i < 8; ++i) {
        EXPECT_EQ(radau.nodes[i], 0);
        for (int j = 0; j < 8; ++j) {
            EXPECT_EQ(radau.a[j][i], 0);
            EXPECT_EQ(radau.from_eigenbasis[j][i], 0);
        }
    }
}

// T Lambda T^-1 is A^-1: A T (Lambda T^-1 x) = x.
TEST_P(Coefficients, TransformToTheInverse) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(-1, 1);
    Lanes8 x{}, transformed{}, inverse{}, back{};
    for (int i = 0; i < s; ++i) x[i] = uniform(random);
    for (int j = 0; j < s; ++j) transformed += x[j] * radau.to_eigenbasis[j];
    for (int k = 0; k < 8; ++k) inverse += transformed[k] * radau.from_eigenbasis[k];
    for (int j = 0; j < s; ++j) back += inverse[j] * radau.a[j];
    for (int i = 0; i < s; ++i) EXPECT_NEAR(back[i], x[i], 1e-13);
}

// The product of the eigenvalues of A^-1 is 1 / det A and their sum is the trace. Complex ones are conjugate pairs.
TEST_P(Coefficients, HaveTheEigenvaluesOfTheInverse) {
    double sum = radau.eigenvalue.re[3], product = sum;
    for (int l = 0; l < (s - 1) / 2; ++l) {
        const double re = radau.eigenvalue.re[l], im = radau.eigenvalue.im[l];
        EXPECT_GT(re, 0);
        EXPECT_GT(im, 0);
        sum += 2 * re, product *= re * re + im * im;
    }
    EXPECT_EQ(radau.eigenvalue.im[3], 0);
    // denominator of the Pade approximant (s - 1, s) of e^z, Hairer & Wanner 1996, IV.3:
    // 1 - s/(2 s - 1) z + .. +- (s - 1)! / (2 s - 1)! z^s
    double last = 1;
    for (int k = s; k <= 2 * s - 1; ++k) last *= k;
    EXPECT_NEAR(product / last, 1, 1e-14);
    double reciprocals = 1 / radau.eigenvalue.re[3];
    for (int l = 0; l < (s - 1) / 2; ++l) {
        const double re = radau.eigenvalue.re[l], im = radau.eigenvalue.im[l];
        reciprocals += 2 * re / (re * re + im * im);
    }
    EXPECT_NEAR(reciprocals, static_cast<double>(s) / (2 * s - 1), 1e-15);
}

// For p(x) = x + 2 x^3 and Z_j = p(c_j).
TEST_P(Coefficients, GiveThePolynomialThroughTheStages) {
    const auto p = [](double x) { return x + 2 * x * x * x; };
    Lanes8 coefficients{};
    double slope = 0;
    for (int j = 0; j < s; ++j) {
        coefficients += p(radau.nodes[j]) * radau.power[j];
        slope += p(radau.nodes[j]) * radau.slope_at_0[j];
    }
    EXPECT_NEAR(slope, 1, 1e-13);
    for (const double x : {-1.0, 0.3, 1.0}) {
        double sum = 0;
        for (int k = s; k-- > 0;) sum = (sum + coefficients[k]) * x;
        EXPECT_NEAR(sum, p(1 + x) - p(1), 1e-11);
    }
}

INSTANTIATE_TEST_SUITE_P(Stages, Coefficients, ::testing::Values(3, 5, 7));

// Hairer & Wanner 1996, IV.8, and their code RADAU5.
TEST(RadauCoefficients, ArePublishedOnesForThreeStages) {
    const RadauCoefficients& radau = radau_coefficients(3);
    EXPECT_NEAR(radau.nodes[0], (4 - std::sqrt(6)) / 10, 1e-16);
    EXPECT_NEAR(radau.a[1][2], (16 + std::sqrt(6)) / 36, 1e-15);
    EXPECT_NEAR(radau.eigenvalue.re[3], 3.6378342527444957, 1e-14);
    EXPECT_NEAR(radau.eigenvalue.re[0], 2.6810828736277521, 1e-14);
    EXPECT_NEAR(radau.eigenvalue.im[0], 3.0504301992474105, 1e-14);
}

}  // namespace
}  // namespace polhode
