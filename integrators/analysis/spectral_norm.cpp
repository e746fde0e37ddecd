#include "integrators/analysis/spectral_norm.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "integrators/series/linear_algebra.h"

namespace polhode {

template <int rows, int columns>
double spectral_norm(const Eigen::Matrix<double, rows, columns>& matrix) {
    if (!matrix.allFinite()) return std::numeric_limits<double>::infinity();
    const double size = matrix.cwiseAbs().maxCoeff();
    if (size == 0) return 0;
    const Eigen::Matrix<double, rows, columns> scaled = matrix / size;
    const Eigen::Matrix<double, rows, rows> product = scaled * scaled.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, rows, rows>> eigen(product, Eigen::EigenvaluesOnly);
    return size * std::sqrt(std::max(0.0, eigen.eigenvalues().maxCoeff()));
}

template double spectral_norm(const Eigen::Matrix<double, 2, 2>&);
template double spectral_norm(const Eigen::Matrix<double, 3, 6>&);
template double spectral_norm(const Eigen::Matrix<double, 6, 6>&);
template double spectral_norm(const Eigen::Matrix<double, 3, 12>&);
template double spectral_norm(const Eigen::Matrix<double, 12, 12>&);

}  // namespace polhode
