// Weights of the columns against what they are to cancel, and each row's order measured.
#include "integrators/own/extrapolation_columns.h"

#include <gtest/gtest.h>

#include <cmath>

#include "integrators/own/midpoint_columns.h"
#include "integrators/scenes.h"
#include "motion/systems.h"

namespace polhode {
namespace {

using namespace polhode::testing;

/// sum of w_j / n_j^(2k), and the sum of the terms' magnitudes.
struct Moment {
    double sum = 0, size = 0;
};
Moment moment(const ExtrapolationRow& row, const std::array<double, most_columns>& weights, int k) {
    Moment m;
    for (int j = 0; j < row.columns; ++j) {
        const double term = weights[j] * std::pow(row.substeps[j], -2 * k);
        m.sum += term, m.size += std::abs(term);
    }
    return m;
}

TEST(ExtrapolationRows, CancelTheEvenPowersOfTheStep) {
    for (int number = fewest_columns; number < table_rows; ++number) {
        const ExtrapolationRow& row = extrapolation_rows[number];
        for (int k = 0; k < row.columns; ++k) {
            const Moment value = moment(row, row.weights.value, k);
            EXPECT_NEAR(value.sum, k == 0 ? 1 : 0, 1e-15 * value.size) << number << ' ' << k;
            // differences of values that agree up to one and two powers fewer
            const Moment error = moment(row, row.weights.error, k);
            if (k < row.columns - 1) {
                EXPECT_NEAR(error.sum, 0, 1e-15 * error.size) << number << ' ' << k;
            } else {
                EXPECT_GT(std::abs(error.sum), 1e-3 * error.size) << number;
            }
            const Moment before = moment(row, row.weights.error_before, k);
            if (k < row.columns - 2) {
                EXPECT_NEAR(before.sum, 0, 1e-15 * before.size) << number << ' ' << k;
            }
        }
        EXPECT_LE(row.amplification, 33);
    }
}

TEST(ExtrapolationRows, HaveTheOrderOfTwiceTheirColumns) {
    const double T = 4;
    const Problem problem = pose(symmetric_body(T));
    const auto coefficients = rotation_coefficients(problem.body.principal_inertia, nullptr);
    RotationAllowance allowance;
    for (double& square : allowance.squared_scale) square = 1;
    const auto error = [&](int row, int steps) {
        RotationStep step;
        FreeRotation(problem).initial(step.state.y);
        for (int i = 0; i < steps; ++i) {
            const RotationState from = step.state;
            midpoint_step_plain(*coefficients, allowance, from, T / steps, row, step);
        }
        const double* y = step.state.y;
        return attitude_error({y[3], y[4], y[5], y[6]},
                              symmetric_attitude(problem.scene, T) * problem.body.principal.q_BP);
    };
    // from five columns on, rounding comes before the asymptotic slope: for them the moments above speak
    for (int row = 2; row <= 4; ++row) {
        const int steps = row == 2 ? 64 : row == 3 ? 24 : 12;
        EXPECT_NEAR(std::log2(error(row, steps) / error(row, 2 * steps)), 2 * row, 0.35) << row;
    }
}

TEST(ColumnChains, HoldEveryColumnOnce) {
    constexpr auto chains = column_chains<8>();
    constexpr auto n = substeps<8>();
    int evaluations = 1;
    for (int j = 0; j < 8; ++j) {
        EXPECT_EQ(chains.last[j] - chains.first[j], n[j] - 1);
        evaluations += chains.last[j] - chains.first[j];
        for (int i = 0; i < j; ++i)
            if (chains.chain[i] == chains.chain[j]) {
                EXPECT_TRUE(chains.last[i] <= chains.first[j] || chains.last[j] <= chains.first[i]);
            }
        EXPECT_LE(chains.last[j], n[7] - 1);
    }
    EXPECT_EQ(evaluations, extrapolation_rows[8].evaluations);
    EXPECT_EQ(chains.chains, 4);
}

}  // namespace
}  // namespace polhode
