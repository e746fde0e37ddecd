// The spectral norm of a small matrix.
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace polhode {

/// The largest singular value of M, by the eigenvalues of M M^T: right to a few units in the last place. M may be near
/// overflow; where it is not finite neither is the norm.
template <class M>
double spectral_norm(const M& matrix) {
    if (!matrix.allFinite()) return std::numeric_limits<double>::infinity();
    const double size = matrix.cwiseAbs().maxCoeff();
    if (size == 0) return 0;
    const M scaled = matrix / size;
    using Square = Eigen::Matrix<double, M::RowsAtCompileTime, M::RowsAtCompileTime>;
    const Square product = scaled * scaled.transpose();
    const Eigen::SelfAdjointEigenSolver<Square> eigen(product, Eigen::EigenvaluesOnly);
    return size * std::sqrt(std::max(0.0, eigen.eigenvalues().maxCoeff()));
}

}  // namespace polhode
