// The spectral norm of a matrix.
#pragma once

#include "integrators/series/linear_algebra.h"

namespace polhode {

/// The largest singular value of M, from the eigenvalues of the smaller of M M^T and M^T M. Accurate to a few units in
/// the last place, also near overflow. Infinite if an entry is not finite.
double spectral_norm(const Eigen::MatrixXd& matrix);

}  // namespace polhode
