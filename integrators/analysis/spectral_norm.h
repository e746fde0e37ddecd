// The spectral norm of a matrix.
#pragma once

#include "integrators/series/linear_algebra.h"

namespace polhode {

/// The largest singular value of M, by the eigenvalues of M M^T or M^T M, whichever is smaller: right to a few units in
/// the last place. M may be near overflow; where it is not finite neither is the norm.
double spectral_norm(const Eigen::MatrixXd& matrix);

}  // namespace polhode
