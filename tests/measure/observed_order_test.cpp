#include "measure/observed_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace polhode {
namespace {

std::vector<double> halved(double from, int count) {
    std::vector<double> steps;
    for (int i = 0; i < count; ++i) steps.push_back(from / std::pow(2, i));
    return steps;
}

// A typical convergence run from coarse to fine: error = min(saturation, C h^p) + floor.
std::vector<double> errors_of(const std::vector<double>& steps, double order, double saturation, double floor) {
    std::vector<double> errors;
    for (double h : steps) errors.push_back(std::min(saturation, 10 * std::pow(h, order)) + floor);
    return errors;
}

TEST(ObservedOrder, IsThePowerOfTheStep) {
    for (double order : {1.0, 2.0, 4.0, 5.0, 8.0}) {
        const auto steps = halved(0.1, 6);
        const auto fit = observed_order(steps, errors_of(steps, order, 1e9, 0));
        ASSERT_TRUE(fit);
        EXPECT_NEAR(fit->order, order, 1e-10);
        EXPECT_EQ(fit->points, 6);
    }
}

TEST(ObservedOrder, LeavesOutSaturationAndRoundOff) {
    const auto steps = halved(1.6, 14);
    // 10 h^4 exceeds 3 for h > 0.74; at h = 0.0004 the floor is 40 % of the error and the local slope is 3.5
    const auto fit = observed_order(steps, errors_of(steps, 4, 3, 1e-13));
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->order, 4, 0.05);
    EXPECT_LT(fit->to, 0.81);
    EXPECT_GT(fit->from, 5e-4);
}

TEST(ObservedOrder, SaysZeroForAnErrorThatDoesNotFall) {
    const auto steps = halved(0.1, 5);
    const auto fit = observed_order(steps, {2.4, 2.41, 2.4, 2.39, 2.4});
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->order, 0, 0.02);
}

TEST(ObservedOrder, PrefersConvergenceToLongSaturation) {
    std::vector<double> steps = halved(1, 10), errors;
    for (double h : steps) errors.push_back(h > 0.01 ? 3.0 : 3 * std::pow(h / 0.01, 2));
    const auto fit = observed_order(steps, errors);
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->order, 2, 0.2);
}

TEST(ObservedOrder, LeavesOutWhatExceedsTheSaturation) {
    // three coarse points near saturation have order 1 by chance; the finer ones have order 2
    const std::vector<double> steps{0.8, 0.4, 0.2, 0.1, 0.05, 0.025};
    const std::vector<double> errors{4, 2, 1.01, 0.16, 0.04, 0.01};
    const auto fit = observed_order(steps, errors, 1);
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->order, 2, 1e-10);
    // errors near saturation show no convergence
    EXPECT_FALSE(observed_order({0.4, 0.2, 0.1}, {2.4, 2.4, 2.4}, 1));
    EXPECT_FALSE(observed_order({0.4, 0.2, 0.1}, {0.8, 0.4, 0.2}, 1));
    EXPECT_TRUE(observed_order({0.4, 0.2, 0.1}, {0.32, 0.16, 0.08}, 1));
}

// A fast top solved by a first-order update: where the attitude is lost, some errors are below 1 rad by chance.
TEST(ObservedOrder, LeavesOutStepsLongerThanOneThatLosesTheAttitude) {
    const std::vector<double> steps{0.04, 0.02, 0.01, 0.005, 0.0025, 0.00125};
    const auto fit = observed_order(steps, {0.21, 0.35, 0.2, 2.47, 0.5, 0.09}, 1);
    EXPECT_FALSE(fit) << fit->order;
    const auto longer =
        observed_order({0.04, 0.02, 0.01, 0.005, 0.0025, 0.00125}, {0.21, 2.3, 0.16, 0.08, 0.04, 0.02}, 1);
    ASSERT_TRUE(longer);
    EXPECT_NEAR(longer->order, 1, 1e-10);
    EXPECT_EQ(longer->points, 4);
}

TEST(ObservedOrder, NeedsThreeUsablePoints) {
    EXPECT_FALSE(observed_order({0.1, 0.05}, {1e-3, 1e-4}));
    EXPECT_FALSE(observed_order({0.1, 0.05, 0.025}, {1e-3, 0, NAN}));
    EXPECT_FALSE(observed_order({0.1, 0.1, 0.1}, {1e-3, 1e-3, 1e-3}));
    EXPECT_FALSE(observed_order({}, {}));
}

TEST(ObservedOrder, DoesNotMindTheOrderOfThePoints) {
    const auto fit = observed_order({0.05, 0.2, 0.1, 0.025}, {0.05 * 0.05, 0.2 * 0.2, 0.1 * 0.1, 0.025 * 0.025});
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->order, 2, 1e-12);
}

TEST(ObservedOrder, LeavesOutWhatIsNoPoint) {
    const double infinite = std::numeric_limits<double>::infinity();
    for (const double step : {-0.4, 0.0, infinite, 0.4}) {
        const auto fit = observed_order({step, 0.2, 0.1, 0.05}, {step == 0.4 ? infinite : 0.16, 0.04, 0.01, 0.0025});
        ASSERT_TRUE(fit) << step;
        EXPECT_NEAR(fit->order, 2, 1e-12) << step;
        EXPECT_EQ(fit->points, 3) << step;
    }
    for (const double step : {-0.4, 0.0, infinite, 0.4})
        EXPECT_FALSE(observed_order({step, 0.2, 0.1}, {step == 0.4 ? infinite : 0.16, 0.04, 0.01})) << step;
    // a step that was run twice counts once
    const auto fit = observed_order({0.2, 0.1, 0.1, 0.05}, {0.04, 0.01, 0.01, 0.0025});
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->order, 2, 1e-12);
    EXPECT_EQ(fit->points, 3);
}

TEST(ObservedOrder, LeavesOutSaturation) {
    // error 4 h^2; the coarsest point is beyond the saturation of 1, the next is at it
    const auto fit = observed_order({1, 0.5, 0.25, 0.125}, {4, 1, 0.25, 0.0625}, 1);
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->order, 2, 1e-12);
    EXPECT_EQ(fit->points, 3);
    EXPECT_NEAR(fit->from, 0.125, 1e-15);
    EXPECT_NEAR(fit->to, 0.5, 1e-15);
    // two points are too few for an order
    EXPECT_FALSE(observed_order({1, 0.5, 0.125}, {4, 1, 0.0625}, 1));
}

TEST(ObservedOrder, TakesWhatAgreesWithinThreePercent) {
    // local slopes of 2 and 2.04 agree; 2.2 does not agree with them
    std::vector<double> steps{1}, errors{1};
    for (const double slope : {2.2, 2.04, 2.0}) {
        steps.push_back(steps.back() / 2);
        errors.push_back(errors.back() / std::exp2(slope));
    }
    const auto fit = observed_order(steps, errors);
    ASSERT_TRUE(fit);
    EXPECT_EQ(fit->points, 3);
    EXPECT_NEAR(fit->order, 2.02, 1e-12);
    EXPECT_EQ(fit->to, 0.5);
    // slopes of 1, 1.2 and 3 do not agree: the three points with the steadiest slopes are fitted
    const auto rough =
        observed_order({1, 0.5, 0.25, 0.125}, {1, 1 / 8.0, 1 / 8.0 / std::exp2(1.2), 1 / 16.0 / std::exp2(1.2)});
    ASSERT_TRUE(rough);
    EXPECT_EQ(rough->points, 3);
    EXPECT_NEAR(rough->order, 1.1, 1e-12);
}

// The fit to errors with these local slopes, from the finest step to the coarsest.
std::optional<ObservedOrder> order_of_slopes(const std::vector<double>& slopes) {
    std::vector<double> steps{0x1p-10}, errors{1e-6};
    for (const double slope : slopes) {
        steps.push_back(2 * steps.back());
        errors.push_back(std::exp2(slope) * errors.back());
    }
    return observed_order(steps, errors);
}

TEST(ObservedOrder, ComparesTheSlopesBetweenNeighbours) {
    EXPECT_EQ(order_of_slopes({2, 2.04, 2})->points, 4);
    // slopes that differ by 5 % do not agree: the other three points are fitted
    EXPECT_EQ(order_of_slopes({2, 2.1, 2.1})->points, 3);
    EXPECT_NEAR(order_of_slopes({2, 2.1, 2.1})->order, 2.1, 1e-12);
    // drifting slopes agree only with their neighbours
    EXPECT_EQ(order_of_slopes({2, 2.05, 2.1, 2.15})->points, 3);
    EXPECT_NEAR(order_of_slopes({2, 2.05, 2.1, 2.15})->order, 2.125, 1e-12);
}

}  // namespace
}  // namespace polhode
