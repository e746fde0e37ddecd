// Redundant constraints of loops: detection, and multipliers where the redundant set depends on the state.
#pragma once

#include <cstddef>
#include <vector>

#include "body/elementary.h"

namespace polhode::maximal {

/// A dense matrix, stored row by row.
template <class S>
using Dense = std::vector<std::vector<S>>;

/// Independent and redundant rows of a positive semidefinite matrix.
template <class P>
struct RowChoice {
    std::vector<char> taken;  ///< marks `rank` independent rows
    /// For each redundant row a null vector of the matrix, with 1 in this row and 0 in the other redundant ones.
    /// Empty for independent rows.
    Dense<P> null;
    int rank = 0;
};

/// Gauss-Jordan elimination with the largest pivot relative to `size` first. Rows with pivots below 1e-11 of their
/// size are redundant.
template <class P>
RowChoice<P> independent_rows(Dense<P> A, const std::vector<P>& size) {
    const std::size_t n = A.size();
    RowChoice<P> choice{std::vector<char>(n, 0), Dense<P>(n), 0};
    for (;; ++choice.rank) {
        std::size_t best = n;
        P largest(1e-11);
        for (std::size_t i = 0; i < n; ++i) {
            if (choice.taken[i]) continue;
            const P share = A[i][i] / size[i];
            if (share > largest) best = i, largest = share;
        }
        if (best == n) break;
        choice.taken[best] = 1;
        const P scale = P(1) / A[best][best];
        for (P& entry : A[best]) entry *= scale;
        for (std::size_t i = 0; i < n; ++i) {
            if (i == best) continue;
            const P multiple = A[i][best];
            for (std::size_t j = 0; j < n; ++j) A[i][j] -= multiple * A[best][j];
        }
    }
    for (std::size_t j = 0; j < n; ++j) {
        if (choice.taken[j]) continue;
        choice.null[j].assign(n, P(0));
        choice.null[j][j] = P(1);
        for (std::size_t i = 0; i < n; ++i)
            if (choice.taken[i]) choice.null[j][i] = -A[i][j];
    }
    return choice;
}

/// Minimum-norm x with A x = b for a symmetric positive semidefinite A of rank r and a b in its range, without
/// branches on values. With the characteristic polynomial x^(n - r) (x^r + c_1 x^(r - 1) + .. + c_r), the
/// Cayley-Hamilton theorem gives A (A^(r-1) + c_1 A^(r-2) + .. + c_(r-1)) = -c_r on the range of A. The c_k come from
/// the Faddeev-LeVerrier algorithm. c_r is, up to sign, the sum of all principal minors of order r and vanishes only
/// where the rank drops.
template <class S>
std::vector<S> shortest_solution(const Dense<S>& A, const std::vector<S>& b, int rank) {
    const std::size_t n = A.size();
    const auto product = [&](const Dense<S>& M, std::size_t i, std::size_t j) {
        S sum = A[i][0] * M[0][j];
        for (std::size_t k = 1; k < n; ++k) sum = sum + A[i][k] * M[k][j];
        return sum;
    };
    const auto coefficient = [&](const Dense<S>& M, int k) {
        S trace = product(M, 0, 0);
        for (std::size_t i = 1; i < n; ++i) trace = trace + product(M, i, i);
        return S(S(-1.0) * trace / S(static_cast<double>(k)));
    };
    Dense<S> M(n, std::vector<S>(n, S(0.0)));
    for (std::size_t i = 0; i < n; ++i) M[i][i] = S(1.0);
    for (int k = 1; k < rank; ++k) {
        const S c = coefficient(M, k);
        Dense<S> next = M;
        // All powers of A are symmetric.
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j <= i; ++j) next[i][j] = next[j][i] = product(M, i, j);
        for (std::size_t i = 0; i < n; ++i) next[i][i] = next[i][i] + c;
        M = std::move(next);
    }
    const S scale = S(-1.0) / coefficient(M, rank);
    std::vector<S> x(n, S(0.0));
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) x[i] = x[i] + M[i][j] * b[j];
        x[i] = scale * x[i];
    }
    return x;
}

}  // namespace polhode::maximal
