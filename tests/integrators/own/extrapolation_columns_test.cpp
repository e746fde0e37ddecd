// The weights of the columns against the terms that they must cancel, and the observed order of each row.
#include "integrators/own/extrapolation_columns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "integrators/own/midpoint_columns.h"
#include "integrators/scenes.h"
#include "motion/systems.h"

namespace polhode {
namespace {

using namespace polhode::testing;

/// sum of w_j / n_j^(2k), and the sum of the magnitudes of its terms.
struct Moment {
    double sum = 0, size = 0;
};
Moment moment(const ExtrapolationRow& row, const std::array<double, max_columns>& weights, int k) {
    Moment m;
    for (int j = 0; j < row.columns; ++j) {
        const double term = weights[j] * std::pow(row.substeps[j], -2 * k);
        m.sum += term, m.size += std::abs(term);
    }
    return m;
}

TEST(ExtrapolationRows, CancelTheEvenPowersOfTheStep) {
    for (int number = min_columns; number < table_rows; ++number) {
        const ExtrapolationRow& row = extrapolation_rows[number];
        for (int k = 0; k < row.columns; ++k) {
            const Moment value = moment(row, row.weights.value, k);
            EXPECT_NEAR(value.sum, k == 0 ? 1 : 0, 1e-15 * value.size) << number << ' ' << k;
            // error estimates: differences of values that cancel one and two powers fewer
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

/// The value at zero of the polynomial through (x_j, z_j), first <= j < last, by Neville's algorithm.
double at_zero(const std::vector<double>& x, std::vector<double> z, std::size_t first, std::size_t last) {
    for (std::size_t width = 1; width < last - first; ++width)
        for (std::size_t j = first; j + width < last; ++j)
            z[j] = (x[j + width] * z[j] - x[j] * z[j + 1]) / (x[j + width] - x[j]);
    return z[first];
}

/// A row computed at run time, and the same row computed at compile time.
struct MadeRow {
    ExtrapolationRow (*make)();
    const ExtrapolationRow& compiled;
};

TEST(ExtrapolationRows, AreThePolynomialsThroughTheirColumns) {
    const MadeRow rows[] = {{extrapolation_row<2>, extrapolation_rows[2]},
                            {extrapolation_row<3>, extrapolation_rows[3]},
                            {extrapolation_row<4>, extrapolation_rows[4]},
                            {extrapolation_row<5>, extrapolation_rows[5]},
                            {extrapolation_row<6>, extrapolation_rows[6]},
                            {extrapolation_row<7>, extrapolation_rows[7]},
                            {extrapolation_row<8>, extrapolation_rows[8]},
                            {extrapolation_row<9>, extrapolation_rows[9]},
                            {extrapolation_row<compensated_row>, extrapolation_rows[compensated_row]},
                            {make_lane_row<2>, lane_rows[2]},
                            {make_lane_row<3>, lane_rows[3]},
                            {make_lane_row<4>, lane_rows[4]},
                            {make_lane_row<5>, lane_rows[5]},
                            {make_lane_row<6>, lane_rows[6]},
                            {make_lane_row<7>, lane_rows[7]},
                            {make_lane_row<8>, lane_rows[8]}};
    std::mt19937 random(3);
    std::uniform_real_distribution<double> even(-1, 1);
    for (const MadeRow& made : rows) {
        const ExtrapolationRow row = made.make();
        const auto K = static_cast<std::size_t>(row.columns);
        SCOPED_TRACE(K);
        EXPECT_EQ(row.substeps, made.compiled.substeps);
        EXPECT_EQ(row.work, made.compiled.work);
        std::vector<double> x, z;
        int evaluations = 1;
        for (std::size_t j = 0; j < K; ++j) {
            const int n = row.substeps[j];
            x.push_back(1.0 / (n * n)), z.push_back(even(random));
            evaluations += n - 1;
            EXPECT_EQ(row.odd_multiple % (n / (n & -n)), 0) << n;
            EXPECT_EQ(row.weights.value[j], made.compiled.weights.value[j]);
            EXPECT_EQ(row.weights.error[j], made.compiled.weights.error[j]);
            EXPECT_EQ(row.weights.error_before[j], made.compiled.weights.error_before[j]);
        }
        EXPECT_EQ(row.evaluations, evaluations);
        double value = 0, error = 0, before = 0, amplification = 0;
        for (std::size_t j = 0; j < K; ++j) {
            value += row.weights.value[j] * z[j], error += row.weights.error[j] * z[j];
            before += row.weights.error_before[j] * z[j], amplification += std::abs(row.weights.value[j]);
        }
        EXPECT_NEAR(row.amplification, amplification, 1e-14 * amplification);
        const double rounding = 1e-13 * amplification;
        EXPECT_NEAR(value, at_zero(x, z, 0, K), rounding);
        EXPECT_NEAR(error, at_zero(x, z, 0, K) - at_zero(x, z, 1, K), rounding);
        EXPECT_NEAR(before, at_zero(x, z, 0, K - 1) - (K > 2 ? at_zero(x, z, 1, K - 1) : 0), rounding);
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
    // with five columns and more, rounding hides the asymptotic slope; the moments above test these rows
    for (int row = 2; row <= 4; ++row) {
        const int steps = row == 2 ? 64 : row == 3 ? 24 : 12;
        EXPECT_NEAR(std::log2(error(row, steps) / error(row, 2 * steps)), 2 * row, 0.35) << row;
    }
}

template <int row>
void expect_every_column_once(int chains_expected) {
    ColumnChains<column_count<row>> (*const make)() = column_chains<row>;
    const auto chains = make();
    constexpr auto n = substeps<row>();
    constexpr int K = column_count<row>;
    SCOPED_TRACE(row);
    int evaluations = 1;
    std::set<int> ends{0};
    for (int j = 0; j < K; ++j) {
        EXPECT_EQ(chains.last[j] - chains.first[j], n[j] - 1);
        evaluations += chains.last[j] - chains.first[j];
        ends.insert(chains.last[j]);
        for (int i = 0; i < j; ++i)
            if (chains.chain[i] == chains.chain[j]) {
                EXPECT_TRUE(chains.last[i] <= chains.first[j] || chains.last[j] <= chains.first[i]);
            }
        EXPECT_LE(chains.last[j], n[K - 1] - 1);
    }
    EXPECT_EQ(evaluations, extrapolation_rows[row].evaluations);
    EXPECT_EQ(chains.chains, chains_expected);
    // a piece ends at the end of a column
    ASSERT_EQ(static_cast<std::size_t>(chains.pieces) + 1, ends.size());
    EXPECT_TRUE(std::equal(ends.begin(), ends.end(), chains.ends.begin()));
}

// The number of chains by first fit, counted by hand: for 4, 6, 8, 12 substeps they have 11, 7 + 3 and 5 evaluations.
TEST(ColumnChains, HoldEveryColumnOnce) {
    expect_every_column_once<2>(2);
    expect_every_column_once<3>(3);
    expect_every_column_once<4>(3);
    expect_every_column_once<5>(4);
    expect_every_column_once<6>(4);
    expect_every_column_once<7>(4);
    expect_every_column_once<8>(4);
    expect_every_column_once<9>(4);
    expect_every_column_once<compensated_row>(3);
}

}  // namespace
}  // namespace polhode
