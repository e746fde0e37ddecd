#include "integrators/sundials/fixed_dense_solver.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "integrators/sundials/sundials_handles.h"

namespace polhode {
namespace {

template <class T>
class FixedDenseSolverOf : public ::testing::Test {};
using Sizes =
    ::testing::Types<std::integral_constant<int, 3>, std::integral_constant<int, 7>, std::integral_constant<int, 13>>;
TYPED_TEST_SUITE(FixedDenseSolverOf, Sizes);

// Forms 1 - gamma J with the matrix operations and solves it: the residual is round-off.
TYPED_TEST(FixedDenseSolverOf, SolvesANewtonSystem) {
    constexpr int N = TypeParam::value;
    SundialsContext context;
    const auto J = make_owner(FixedMatrix<N>::make(context));
    std::mt19937 bits(7);
    std::uniform_real_distribution<double> number(-1, 1);
    for (int i = 0; i < N; ++i)
        for (int j = 0; j < N; ++j) FixedMatrix<N>::entries(J.get())(i, j) = number(bits);
    const auto A = make_owner(SUNMatClone(J.get()));
    const double gamma = 0.4;
    ASSERT_EQ(SUNMatCopy(J.get(), A.get()), SUNMAT_SUCCESS);
    ASSERT_EQ(SUNMatScaleAddI(-gamma, A.get()), SUNMAT_SUCCESS);

    const auto solver = make_owner(FixedDenseSolver<N>::make(context));
    const auto x = make_owner(FixedVector<N>::make(context)), b = make_owner(FixedVector<N>::make(context));
    for (int i = 0; i < N; ++i) FixedVector<N>::data(b.get())[i] = number(bits);
    ASSERT_EQ(SUNLinSolInitialize(solver.get()), SUNLS_SUCCESS);
    ASSERT_EQ(SUNLinSolSetup(solver.get(), A.get()), SUNLS_SUCCESS);
    ASSERT_EQ(SUNLinSolSolve(solver.get(), A.get(), x.get(), b.get(), 0), SUNLS_SUCCESS);
    const Eigen::Map<const Eigen::Matrix<double, N, 1>> solution(FixedVector<N>::data(x.get()));
    const Eigen::Matrix<double, N, 1> Jx = FixedMatrix<N>::entries(J.get()) * solution;
    // backward stable: |b - A x| <= N^2 u |A| |x| times a growth factor far below 8 (Wilkinson)
    const double bound = 8 * N * N * std::numeric_limits<double>::epsilon() * N * N_VMaxNorm(x.get());
    for (int i = 0; i < N; ++i) {
        const double residual = FixedVector<N>::data(b.get())[i] - solution[i] + gamma * Jx[i];
        EXPECT_NEAR(residual, 0, bound);
    }
}

// A positive return value makes CVODE retry with a smaller step.
TYPED_TEST(FixedDenseSolverOf, AsksForASmallerStepWhereTheMatrixIsSingular) {
    constexpr int N = TypeParam::value;
    SundialsContext context;
    const auto A = make_owner(FixedMatrix<N>::make(context));
    const auto solver = make_owner(FixedDenseSolver<N>::make(context));
    FixedMatrix<N>::entries(A.get()).setOnes();
    EXPECT_GT(SUNLinSolSetup(solver.get(), A.get()), 0);
    FixedMatrix<N>::entries(A.get())(0, 0) = std::nan("");
    EXPECT_GT(SUNLinSolSetup(solver.get(), A.get()), 0);
    SUNMatZero(A.get());
    EXPECT_GT(SUNLinSolSetup(solver.get(), A.get()), 0);
    SUNMatScaleAddI(1, A.get());
    EXPECT_EQ(SUNLinSolSetup(solver.get(), A.get()), SUNLS_SUCCESS);
}

}  // namespace
}  // namespace polhode
