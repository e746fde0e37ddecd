#include "integrators/analysis/spectral_norm.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace polhode {

double spectral_norm(const Eigen::MatrixXd& matrix) {
    if (!matrix.allFinite()) return std::numeric_limits<double>::infinity();
    const double size = matrix.size() == 0 ? 0 : matrix.cwiseAbs().maxCoeff();
    if (size == 0) return 0;
    const Eigen::MatrixXd scaled = (matrix.rows() <= matrix.cols() ? matrix : matrix.transpose()) / size;
    const Eigen::MatrixXd product = scaled * scaled.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(product, Eigen::EigenvaluesOnly);
    return size * std::sqrt(std::max(0.0, eigen.eigenvalues().maxCoeff()));
}

}  // namespace polhode
