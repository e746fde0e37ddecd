// Linear complementarity problems by Lemke's method.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace polhode::contact_stepping {

/// Solves w = M z + q, w >= 0, z >= 0, w . z = 0 for a copositive M by Lemke's method with a lexicographic ratio test,
/// which cannot cycle (C. E. Lemke 1965; R. W. Cottle, J.-S. Pang & R. E. Stone 1992, section 4.4). The memory of the
/// tableau is kept between calls.
template <class S>
class LemkeSolver {
  public:
    /// M has n rows of n entries. Entries and q should be of order 1. If rounding leads to a wrong solution, as it can
    /// where many ratios are equal, q is perturbed by a few roundings. Returns false if no solution is found.
    bool solve(std::size_t n, const std::vector<S>& M, const std::vector<S>& q, std::vector<S>& z) {
        if (pivot_to_end(n, M, q, z) && is_solution(n, M, q, z)) return true;
        S size = perturbation;
        for (int attempt = 0; attempt < 4; ++attempt) {
            perturbed_ = q;
            for (std::size_t i = 0; i < n; ++i) perturbed_[i] += size * static_cast<S>(1 + (7 * i) % 13);
            if (pivot_to_end(n, M, perturbed_, z) && is_solution(n, M, q, z)) return true;
            size *= S(8);
        }
        return false;
    }

  private:
    static constexpr S tolerance = S(sizeof(S) == sizeof(float) ? 1e-5 : 1e-11);  // entries below it count as zero

    static constexpr S perturbation = S(sizeof(S) == sizeof(float) ? 1e-7 : 1e-14);

    // w >= 0 and w z = 0, with z of the perturbed problem, up to rounding and the perturbation
    static bool is_solution(std::size_t n, const std::vector<S>& M, const std::vector<S>& q, const std::vector<S>& z) {
        S size = S(1);
        for (const S& entry : z) size = std::max(size, entry);
        const S accuracy = S(sizeof(S) == sizeof(float) ? 1e-3 : 1e-9) * size;
        for (std::size_t i = 0; i < n; ++i) {
            S w = q[i];
            for (std::size_t k = 0; k < n; ++k) w += M[i * n + k] * z[k];
            if (!(w > -accuracy) || !(w * z[i] < accuracy * size)) return false;
        }
        return true;
    }
    bool pivot_to_end(std::size_t n, const std::vector<S>& M, const std::vector<S>& q, std::vector<S>& z) {
        z.assign(n, S(0));
        std::size_t row = n;
        S least = S(0);
        // the last of equal ones, so that all rows are lexicographically positive after the pivot
        for (std::size_t i = 0; i < n; ++i)
            if (q[i] < S(0) && q[i] < least + tolerance) least = std::min(least, q[i]), row = i;
        if (row == n) return true;
        fill(n, M, q);
        // the covering variable z0 enters and the most negative w leaves
        std::size_t entering = 2 * n;
        for (std::size_t pivots = 0; pivots < 50 * n + 50; ++pivots) {
            const std::size_t leaving = basis_[row];
            pivot(row, entering);
            if (leaving == 2 * n) {
                for (std::size_t i = 0; i < n; ++i)
                    if (basis_[i] >= n && basis_[i] < 2 * n) z[basis_[i] - n] = std::max(S(0), at(i, 2 * n + 1));
                return true;
            }
            entering = leaving < n ? leaving + n : leaving - n;
            row = leaving_row(entering);
            if (row == n) return false;
        }
        return false;
    }

    S& at(std::size_t i, std::size_t k) { return tableau_[i * columns_ + k]; }

    // columns: w (0..n-1), z (n..2n-1), z0, right-hand side;  w - M z - z0 = q
    void fill(std::size_t n, const std::vector<S>& M, const std::vector<S>& q) {
        n_ = n, columns_ = 2 * n + 2;
        tableau_.assign(n * columns_, S(0));
        basis_.resize(n);
        for (std::size_t i = 0; i < n; ++i) {
            at(i, i) = S(1);
            for (std::size_t k = 0; k < n; ++k) at(i, n + k) = -M[i * n + k];
            at(i, 2 * n) = S(-1);
            at(i, 2 * n + 1) = q[i];
            basis_[i] = i;
        }
    }
    void pivot(std::size_t row, std::size_t column) {
        const S inverse = S(1) / at(row, column);
        for (std::size_t k = 0; k < columns_; ++k) at(row, k) *= inverse;
        at(row, column) = S(1);
        for (std::size_t i = 0; i < n_; ++i) {
            const S factor = at(i, column);
            if (i == row || factor == S(0)) continue;
            for (std::size_t k = 0; k < columns_; ++k) at(i, k) -= factor * at(row, k);
            at(i, column) = S(0);
        }
        basis_[row] = column;
    }
    // The row of the lexicographically smallest (rhs, w columns) / pivot among positive pivots; z0 leaves if it can.
    std::size_t leaving_row(std::size_t column) {
        std::size_t best = n_;
        for (std::size_t i = 0; i < n_; ++i) {
            if (!(at(i, column) > tolerance)) continue;
            if (best == n_ || precedes(i, best, column)) best = i;
        }
        return best;
    }
    bool precedes(std::size_t i, std::size_t other, std::size_t column) {
        const S a = at(i, column), b = at(other, column);
        const S difference = at(i, 2 * n_ + 1) / a - at(other, 2 * n_ + 1) / b;
        if (std::abs(difference) > tolerance) return difference < S(0);
        if (basis_[i] == 2 * n_ || basis_[other] == 2 * n_) return basis_[i] == 2 * n_;
        for (std::size_t k = 0; k < n_; ++k) {
            const S d = at(i, k) / a - at(other, k) / b;
            if (std::abs(d) > tolerance) return d < S(0);
        }
        return false;
    }

    std::size_t n_ = 0, columns_ = 0;
    std::vector<S> tableau_, perturbed_;
    std::vector<std::size_t> basis_;
};

}  // namespace polhode::contact_stepping
