// Consistent singular linear systems against Eigen's complete orthogonal decomposition.
#include "integrators/maximal/redundancy.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <vector>

#include "integrators/maximal/sparse_ldl.h"
#include "integrators/series/linear_algebra.h"

namespace polhode::maximal {
namespace {

// A = B B^T with a random B of small integers, so that A is positive semidefinite
struct Semidefinite {
    Dense<double> A;
    std::vector<double> b;  ///< in the range of A
    Eigen::MatrixXd matrix;
    Eigen::VectorXd right;
    int rank = 0;
};
Semidefinite semidefinite(int n, int columns) {
    Eigen::MatrixXd B(n, columns);
    Eigen::VectorXd x(n);
    for (int i = 0; i < n; ++i) {
        x[i] = *rc::gen::inRange(-9, 10);
        for (int j = 0; j < columns; ++j) B(i, j) = *rc::gen::inRange(-9, 10);
    }
    Semidefinite s;
    s.matrix = B * B.transpose(), s.right = s.matrix * x;
    s.rank = static_cast<int>(B.fullPivLu().rank());
    s.A.assign(n, std::vector<double>(n));
    for (int i = 0; i < n; ++i) {
        s.b.push_back(s.right[i]);
        for (int j = 0; j < n; ++j) s.A[i][j] = s.matrix(i, j);
    }
    return s;
}

RC_GTEST_PROP(Redundancy, TheShortestSolutionIsThePseudoinverses, ()) {
    const int n = *rc::gen::inRange(1, 6);
    const Semidefinite s = semidefinite(n, *rc::gen::inRange(1, n + 1));
    RC_PRE(s.rank > 0);
    const std::vector<double> x = shortest_solution(s.A, s.b, s.rank);
    const Eigen::VectorXd expected = s.matrix.completeOrthogonalDecomposition().solve(s.right);
    // the pivots depend on principal minors, so the error grows with a power of the condition number
    const Eigen::VectorXd values = s.matrix.selfadjointView<Eigen::Lower>().eigenvalues();
    const double condition = values[n - 1] / values[n - s.rank];
    for (int i = 0; i < n; ++i)
        RC_ASSERT(std::abs(x[i] - expected[i]) <=
                  1e-14 * std::pow(condition, std::max(1, s.rank - 1)) * (1 + expected.norm()));
}

RC_GTEST_PROP(Redundancy, AsManyRowsAreTakenAsTheRankAndTheOthersFollow, ()) {
    const int n = *rc::gen::inRange(1, 8);
    const Semidefinite s = semidefinite(n, *rc::gen::inRange(1, n + 1));
    std::vector<double> size;
    for (int i = 0; i < n; ++i) size.push_back(std::max(1.0, s.A[i][i]));
    const RowChoice<double> choice = independent_rows(s.A, size);
    RC_ASSERT(choice.rank == s.rank);
    RC_ASSERT(std::count(choice.taken.begin(), choice.taken.end(), 1) == s.rank);
    for (int j = 0; j < n; ++j) {
        if (choice.taken[j]) continue;
        const Eigen::VectorXd null = Eigen::Map<const Eigen::VectorXd>(choice.null[j].data(), n);
        RC_ASSERT((s.matrix * null).norm() <= 1e-9 * s.matrix.norm() * null.norm());
    }
}

RC_GTEST_PROP(SparseLdl, SolvesWhatADenseDecompositionSolves, ()) {
    const int n = *rc::gen::inRange(1, 12);
    std::vector<std::set<int>> entries(n);
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    for (int k = 0; k < n; ++k)
        for (int i = k + 1; i < n; ++i)
            if (*rc::gen::inRange(0, 4) == 0) {
                entries[k].insert(i);
                A(i, k) = A(k, i) = *rc::gen::inRange(-9, 10);
            }
    for (int i = 0; i < n; ++i) A(i, i) = 1 + A.row(i).cwiseAbs().sum();  // diagonally dominant, so positive definite
    const SparsePattern pattern(entries);
    std::vector<double> values(pattern.entries(), 0), x(n);
    for (int k = 0; k < n; ++k) {
        values[pattern.place(k, k)] = A(k, k);
        for (const int i : entries[k]) values[pattern.place(i, k)] = A(i, k);
        x[k] = *rc::gen::inRange(-9, 10);
    }
    const Eigen::VectorXd expected = A.ldlt().solve(Eigen::Map<const Eigen::VectorXd>(x.data(), n));
    pattern.factorize(values, n);
    pattern.descend(values, x, n);
    pattern.ascend(values, x, n);
    for (int i = 0; i < n; ++i) RC_ASSERT(std::abs(x[i] - expected[i]) <= 1e-12 * (1 + expected.norm()));
}

}  // namespace
}  // namespace polhode::maximal
