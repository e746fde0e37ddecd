// Small systems of linear equations.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "body/elementary.h"

namespace polhode::contact {

/// Subtracts row c of B (m by m, row by row) and x from the rows below, so that column c is zero there.
template <class P>
void eliminate_column(std::vector<P>& B, std::vector<P>& x, std::size_t c) {
    const std::size_t m = x.size();
    for (std::size_t r = c + 1; r < m; ++r) {
        const P factor = B[r * m + c] / B[c * m + c];
        for (std::size_t k = c; k < m; ++k) B[r * m + k] = B[r * m + k] - factor * B[c * m + k];
        x[r] = x[r] - factor * x[c];
    }
}
/// Solves B x = x with an upper triangular B.
template <class P>
void substitute_back(const std::vector<P>& B, std::vector<P>& x) {
    const std::size_t m = x.size();
    for (std::size_t r = m; r-- > 0;) {
        for (std::size_t c = r + 1; c < m; ++c) x[r] = x[r] - B[r * m + c] * x[c];
        x[r] = x[r] / B[r * m + r];
    }
}

/// Gaussian elimination of a positive definite matrix (m by m, row by row). x is the right side, then the solution.
template <class P>
void solve_definite(std::vector<P>& B, std::vector<P>& x) {
    for (std::size_t c = 0; c < x.size(); ++c) eliminate_column(B, x, c);
    substitute_back(B, x);
}
/// As solve_definite() for any matrix, with partial pivoting. Returns false if the matrix is singular: a pivot does not
/// exceed `least`.
template <class P>
bool solve_pivoted(std::vector<P>& B, std::vector<P>& x, const P& least = P(0)) {
    const std::size_t m = x.size();
    for (std::size_t c = 0; c < m; ++c) {
        std::size_t pivot = c;
        for (std::size_t r = c + 1; r < m; ++r)
            if (Elementary<P>::magnitude(B[r * m + c]) > Elementary<P>::magnitude(B[pivot * m + c])) pivot = r;
        if (!(Elementary<P>::magnitude(B[pivot * m + c]) > least)) return false;
        for (std::size_t k = 0; k < m; ++k) std::swap(B[c * m + k], B[pivot * m + k]);
        std::swap(x[c], x[pivot]);
        eliminate_column(B, x, c);
    }
    substitute_back(B, x);
    return true;
}

}  // namespace polhode::contact
