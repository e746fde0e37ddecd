#include "integrators/own/four_systems.h"

#include <gtest/gtest.h>

#include <complex>
#include <random>

#include "integrators/scenes.h"
#include "integrators/series/linear_algebra.h"
#include "motion/dual.h"
#include "motion/systems.h"

namespace polhode {
namespace {

/// Compares with Eigen's factorisation with full pivoting at random states, eigenvalues and right-hand sides. No
/// eigenvalue is much smaller than the rates, because a step is at most one rotation.
template <class SystemType>
void expect_solved(const Scene& scene, Formulation formulation) {
    constexpr int N = SystemType::dimension;
    using Matrix = Eigen::Matrix<std::complex<double>, N, N>;
    using Column = Eigen::Matrix<std::complex<double>, N, 1>;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1, 1), exponent(0.5, 6);
    const Problem problem = pose(scene, formulation);
    ASSERT_EQ(problem.needs.dimension, N);
    for (int trial = 0; trial < 200; ++trial) {
        const SystemType system = SystemType(problem, problem.segments.back());
        double y[N], J[N * N];
        for (double& value : y) value = 5 * uniform(random);
        jacobian(system, 0, y, J);
        Complex4 mu, x[N];
        for (int l = 0; l < 4; ++l) {
            const double size = std::pow(10, exponent(random));
            mu.re[l] = size * (1.3 + uniform(random)), mu.im[l] = l == 3 ? 0 : 2 * size * uniform(random);
            for (Complex4& component : x) component.re[l] = uniform(random), component.im[l] = uniform(random);
        }
        FourSystems<N, SystemType::rates> systems;
        systems.factor(mu, J);
        Complex4 solution[N];
        std::copy(x, x + N, solution);
        systems.solve(solution);
        for (int l = 0; l < 4; ++l) {
            Matrix matrix;
            Column right, found;
            for (int i = 0; i < N; ++i) {
                for (int j = 0; j < N; ++j) matrix(i, j) = -J[i * N + j];
                matrix(i, i) += std::complex<double>(mu.re[l], mu.im[l]);
                right[i] = {x[i].re[l], x[i].im[l]};
                found[i] = {solution[i].re[l], solution[i].im[l]};
            }
            const Column expected = matrix.fullPivLu().solve(right);
            const double condition = matrix.norm() * matrix.inverse().norm();
            EXPECT_LT((found - expected).norm(), 2e-15 * N * condition * expected.norm()) << "trial " << trial;
        }
    }
}

TEST(FourSystems, AreThoseOfEverySystem) {
    Scene spin;
    spin.name = "spin", spin.duration = 1;
    spin.body.inertia_B = diagonal(Vector3<double>(1, 2, 3));
    spin.initial.angular_velocity = {0, 0, 1};
    spin.loads = {Drag{{0.5, 0.5, 0.5}, 0, {}}};
    expect_solved<PrincipalAxisRotation>(spin, Formulation::reduced);
    expect_solved<FreeRotation>(testing::free_body(1), Formulation::reduced);
    expect_solved<LoadedRotation>(testing::heavy_top(1), Formulation::reduced);
    expect_solved<LoadedMotion>(testing::everything(1), Formulation::reduced);
    expect_solved<FullMotion>(testing::everything(1), Formulation::full);
    expect_solved<FullMotion>(testing::heavy_top(1), Formulation::full);
}

}  // namespace
}  // namespace polhode
