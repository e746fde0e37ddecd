// Logarithmic norms against eigenvalues in closed form and against Jacobians sampled in binary64.
#include "integrators/truth/balls/norm.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "integrators/series/linear_algebra.h"
#include "integrators/truth/euler_form.h"
#include "integrators/truth/loaded_scene.h"

namespace polhode::truth {
namespace {

// y' = A y, A = ((-1, 100), (0, -1))
struct Shear {
    template <class S>
    void derivative(const S* y, S* dy) const {
        using T = decltype(y[0].factor);
        dy[0] = T(100) * y[1] - T(1) * y[0];
        dy[1] = T(-1) * y[1];
    }
};

PiecePlan plan_of(std::vector<double> weights, int n) {
    PiecePlan plan;
    plan.dimension = n, plan.weights = std::move(weights), plan.scales.assign(n, 1);
    return plan;
}

TEST(WeightedNorm, LogarithmicNormOfAShear) {
    const Recording<Ball> recording = record<Ball>(Shear{}, 2);
    const std::vector<Ball> box(2);
    // eigenvalues of the symmetric part: -1 +- 50; with the second variable weighted by 100, -1 +- 1/2
    EXPECT_NEAR(WeightedNorm(plan_of({1, 0, 0, 1}, 2)).logarithmic_norm(recording, box).near(), 49, 1e-9);
    EXPECT_NEAR(WeightedNorm(plan_of({1, 0, 0, 100}, 2)).logarithmic_norm(recording, box).near(), -0.5, 1e-9);
}

TEST(WeightedNorm, LengthsAndComponents) {
    const WeightedNorm norm(plan_of({2, 0, 0, 0.5}, 2));
    // |(2 * 3, 0.5 * 16)| = 10
    EXPECT_NEAR(norm.length({Bound(3.0), Bound(16.0)}).near(), 10, 1e-6);
    EXPECT_GE(norm.length({Bound(3.0), Bound(16.0)}).near(), 10);
    const std::vector<Bound> components = norm.components(Bound(10.0));
    EXPECT_NEAR(components[0].near(), 5, 1e-6);
    EXPECT_NEAR(components[1].near(), 20, 1e-6);
    // a singular matrix gives no bound
    EXPECT_FALSE(WeightedNorm(plan_of({1, 1, 1, 1}, 2)).components(Bound(1.0))[0].is_finite());
}

// For any state in the box the largest eigenvalue in binary64 is below the bound, and the bound is close.
RC_GTEST_PROP(WeightedNorm, HoldsOverTheWholeBox, ()) {
    const auto seed = *rc::gen::inRange(0u, 1000u);
    const Scene scene = loaded_scene(seed, seed % 2 == 0);
    EulerForm<Ball> form(scene);
    EulerForm<double> in_double(scene);
    const int n = form.dimension();
    std::vector<Ball> box(n);
    std::vector<double> y(n);
    form.initial(box.data()), in_double.initial(y.data());
    form.enter(0.5, box.data()), in_double.enter(0.5, y.data());
    PiecePlan plan;
    plan.dimension = n, plan.weights.assign(n * n, 0), plan.scales.assign(n, 1);
    for (int i = 0; i < n; ++i) plan.weights[i * n + i] = i < 3 ? 0.5 : i < 7 ? 2 : 1;
    constexpr double width = 1e-3;
    for (Ball& component : box) component = widened(std::move(component), Bound(width));
    const double bound = WeightedNorm(plan).logarithmic_norm(record<Ball>(form, n), box).near();

    Dice dice(seed);
    const Recording<double> recording = record<double>(in_double, n);
    double largest = -1e300;
    for (int trial = 0; trial < 5; ++trial) {
        std::vector<double> inside(y);
        for (double& component : inside) component += 0.99 * width * dice.number();
        const std::vector<double> J = jacobian_of(recording, inside.data());
        Eigen::MatrixXd B(n, n);
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) B(i, j) = plan.weights[i * n + i] * J[i * n + j] / plan.weights[j * n + j];
        const Eigen::MatrixXd symmetric = (B + B.transpose()) / 2;
        largest = std::max(largest, Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric).eigenvalues().maxCoeff());
    }
    RC_ASSERT(largest <= bound + 1e-9 * std::abs(bound));
    RC_ASSERT(bound <= largest + 0.1 * (1 + std::abs(largest)) + 1);
}

TEST(PlanPieces, WeightsMakeAnOverdampedPendulumLoseLittle) {
    // |dtau/dq| = 2 m g l = 10 and |d(dq/dt)/dw| = 1/2. For weights in the ratio s the logarithmic norm is at most
    // about (s/2 + 10/s)^2 / (4 c) = 0.005/s at s = sqrt(20). Row sums of |J| would allow e^(1/2) per second.
    Scene scene;
    scene.name = "overdamped";
    scene.duration = 10;
    scene.body.center_of_mass = {0.5, 0, 0};
    scene.pivot = Vector3<double>();
    scene.initial.orientation = {0.8, 0.6, 0, 0};
    scene.loads.push_back(Gravity{{0, 0, -10}, {}});
    scene.loads.push_back(Drag{{1000, 1000, 1000}, 0, {}});
    const std::vector<PiecePlan> plans = plan_pieces(pose(scene));
    ASSERT_EQ(plans.size(), 1u);
    EXPECT_LT(plans[0].growth_bits + plans[0].spread_bits, 8);
}

}  // namespace
}  // namespace polhode::truth
