// FourSystems for a Jacobian whose size is known only at run time.
#pragma once

#include <array>

#include "integrators/own/four_systems.h"
#include "integrators/series/linear_algebra.h"

namespace polhode {

/// Four complex linear systems (mu_l - J) x_l = r_l with one real n x n matrix J. Each is solved by an LU
/// factorisation with partial pivoting.
class DenseSystems {
  public:
    explicit DenseSystems(int n) : n_(n) {}

    /// J is stored row by row.
    [[gnu::noinline]] void factor(const Complex4& mu, const double* J) {
        const auto given = Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(J, n_, n_);
        for (int l = 0; l < 4; ++l) {
            Eigen::MatrixXcd matrix = -given.cast<std::complex<double>>();
            matrix.diagonal().array() += std::complex<double>(mu.re[l], mu.im[l]);
            factors_[l].compute(matrix);
        }
    }

    /// Solves in place: r in, x out.
    [[gnu::noinline]] void solve(Complex4* x) const {
        Eigen::VectorXcd right(n_);
        for (int l = 0; l < 4; ++l) {
            for (int i = 0; i < n_; ++i) right[i] = {x[i].re[l], x[i].im[l]};
            const Eigen::VectorXcd found = factors_[l].solve(right);
            for (int i = 0; i < n_; ++i) x[i].re[l] = found[i].real(), x[i].im[l] = found[i].imag();
        }
    }

  private:
    int n_;
    std::array<Eigen::PartialPivLU<Eigen::MatrixXcd>, 4> factors_;
};

}  // namespace polhode
