// Small systems of linear equations with a positive definite matrix.
#pragma once

#include <cstddef>
#include <vector>

namespace polhode::contact {

/// Gaussian elimination of a positive definite matrix (m by m, row by row). x is the right side, then the solution.
template <class P>
void solve_definite(std::vector<P>& B, std::vector<P>& x) {
    const std::size_t m = x.size();
    for (std::size_t c = 0; c < m; ++c)
        for (std::size_t r = c + 1; r < m; ++r) {
            const P factor = B[r * m + c] / B[c * m + c];
            for (std::size_t k = c; k < m; ++k) B[r * m + k] = B[r * m + k] - factor * B[c * m + k];
            x[r] = x[r] - factor * x[c];
        }
    for (std::size_t r = m; r-- > 0;) {
        for (std::size_t c = r + 1; c < m; ++c) x[r] = x[r] - B[r * m + c] * x[c];
        x[r] = x[r] / B[r * m + r];
    }
}

}  // namespace polhode::contact
