// The spectral norm of a small matrix.
#pragma once

#include "integrators/series/linear_algebra.h"

namespace polhode {

/// The largest singular value of M, by the eigenvalues of M M^T: right to a few units in the last place. M may be near
/// overflow; where it is not finite neither is the norm. Compiled for the sizes that stand in spectral_norm.cpp.
template <int rows, int columns>
double spectral_norm(const Eigen::Matrix<double, rows, columns>& matrix);

}  // namespace polhode
