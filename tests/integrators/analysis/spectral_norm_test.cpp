#include "integrators/analysis/spectral_norm.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "integrators/series/linear_algebra.h"

namespace polhode {
namespace {

// The eigenvalues of M M^T lose small singular values; the largest one keeps its accuracy.
TEST(SpectralNorm, IsTheLargestSingularValue) {
    std::mt19937 dice(1);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 1000; ++i) {
        Eigen::Matrix<double, 3, 6> M;
        for (double& entry : M.reshaped()) entry = normal(dice);
        M.col(i % 6) *= std::exp(10 * normal(dice));
        const double expected = Eigen::MatrixXd(M).jacobiSvd().singularValues()[0];
        EXPECT_NEAR(spectral_norm(M), expected, 1e-14 * expected);
        EXPECT_NEAR(spectral_norm(Eigen::Matrix<double, 3, 6>(M * 1e250)), 1e250 * expected, 1e236 * expected);
    }
}

TEST(SpectralNorm, OfNothingAndOfWhatIsNotFinite) {
    Eigen::Matrix2d M = Eigen::Matrix2d::Zero();
    EXPECT_EQ(spectral_norm(M), 0);
    M(0, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(spectral_norm(M), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace polhode
