// The vectorised right-hand side against the scalar one, and steps with each instruction set.
#include "integrators/lanes/rotation_lanes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "build_kind.h"
#include "integrators/own/dormand_prince.h"
#include "integrators/own/midpoint_columns.h"
#include "motion/systems.h"

namespace polhode {
namespace {

constexpr int bodies = optimised_build ? 10'000 : 500;

struct RandomRotation {
    PrincipalInertia<double> inertia;
    Forcing<double> forcing;
    RotationState state;
};

/// A body with some of the torques that have coefficients, selected by `kind`.
RandomRotation random_rotation(std::mt19937_64& random, int kind) {
    std::uniform_real_distribution<double> unit(-1, 1);
    const auto number = [&] { return unit(random) * std::exp(3 * unit(random)); };
    const auto vector = [&] { return Vector3<double>(number(), number(), number()); };
    RandomRotation r;
    r.inertia.gyroscopic = vector();
    for (int i = 0; i < 3; ++i) r.inertia.inverse_moments[i] = std::exp(2 * unit(random));
    const auto field = [&](const Vector3<double>& arm, const Vector3<double>& force) {
        r.forcing.body_points.push_back({arm, force});
        r.forcing.field.add(r.forcing.body_points.back());
    };
    if (kind == 1) field({0, 0, number()}, {0, 0, number()});
    if (kind == 2) field(vector(), {0, 0, number()});
    if (kind >= 3) {
        field(vector(), vector());
        field(vector(), vector());
        r.forcing.has_torque = r.forcing.has_world_torque = r.forcing.has_damping = true;
        r.forcing.torque = vector(), r.forcing.torque_W = vector();
        for (int i = 0; i < 3; ++i) r.forcing.damping[i] = vector();
        r.forcing.springs.push_back({number(), {unit(random), unit(random), unit(random), unit(random)}});
        r.forcing.pivoted = true;
        r.forcing.world_points.push_back({vector(), vector(), Frame::body});
        r.forcing.world_points.push_back({vector(), vector(), Frame::world});
    }
    r.forcing.only_field = !r.forcing.any_torque_beside_field();
    for (int i = 0; i < 7; ++i) r.state.y[i] = i < 3 ? number() : unit(random);
    return r;
}

void evaluate(const RotationCoefficients& c, const double* y, double* rate) {
    const auto r = loaded<LaneHalves>(y);
    switch (c.terms) {
        case RotationTerms::none:
            return store(rate, RotationRate<RotationTerms::none, LaneHalves>(c)(r));
        case RotationTerms::axial_field:
            return store(rate, RotationRate<RotationTerms::axial_field, LaneHalves>(c)(r));
        case RotationTerms::quadratic:
            return store(rate, RotationRate<RotationTerms::quadratic, LaneHalves>(c)(r));
    }
}

/// The coefficients without their signs give the sum of the magnitudes of all terms, the scale of rounding errors.
RotationCoefficients magnitudes(RotationCoefficients c) {
    for (int lane = 0; lane < 8; ++lane) {
        for (auto* rows : {c.product, c.damping})
            for (int i = 0; i < 3; ++i) rows[i][lane] = std::abs(rows[i][lane]);
        for (auto& row : c.monomial) row[lane] = std::abs(row[lane]);
        c.constant[lane] = std::abs(c.constant[lane]);
    }
    return c;
}

TEST(RotationRate, RestatesTheOneRightHandSide) {
    std::mt19937_64 random(1);
    constexpr RotationTerms expected[] = {RotationTerms::none, RotationTerms::axial_field, RotationTerms::quadratic,
                                          RotationTerms::quadratic};
    for (int body = 0; body < bodies; ++body) {
        const RandomRotation r = random_rotation(random, body % 4);
        const auto coefficients = rotation_coefficients(r.inertia, &r.forcing);
        ASSERT_TRUE(coefficients.has_value());
        ASSERT_EQ(coefficients->terms, expected[body % 4]);
        alignas(64) double rate[8], scale[8], magnitude[8];
        double one[7];
        for (int i = 0; i < 8; ++i) magnitude[i] = std::abs(r.state.y[i]);
        evaluate(*coefficients, r.state.y, rate);
        evaluate(magnitudes(*coefficients), magnitude, scale);
        LoadedRotation::Equations{r.inertia, &r.forcing}.derivative(0, r.state.y, one);
        for (int i = 0; i < 7; ++i) {
            // the coefficients of the spring and the world points cancel partly before this sum
            const double loads = body % 4 == 3 && i < 3 ? 4 : 1;
            ASSERT_LE(std::abs(rate[i] - one[i]), loads * 4 * 0x1p-53 * scale[i]) << body << ' ' << i;
        }
        ASSERT_EQ(rate[7], 0);
    }
}

TEST(RotationRate, LeavesOtherTorquesToTheGeneralOne) {
    std::mt19937_64 random(2);
    RandomRotation r = random_rotation(random, 3);
    r.forcing.pivoted = false;  // the torque of a force at a world point then depends on the position
    EXPECT_FALSE(rotation_coefficients(r.inertia, &r.forcing).has_value());
    r = random_rotation(random, 2);
    r.forcing.user_torques.push_back([](double, const Quaternion<double>&, const Vector3<double>&,
                                        const Vector3<double>&, const Vector3<double>&) { return Vector3<double>(); });
    EXPECT_FALSE(rotation_coefficients(r.inertia, &r.forcing).has_value());
}

void expect_same(const RotationStep& a, const RotationStep& b) {
    for (int i = 0; i < 8; ++i) {
        ASSERT_EQ(a.state.y[i], b.state.y[i]);
        ASSERT_EQ(a.state.lost[i], b.state.lost[i]);
    }
    ASSERT_EQ(a.squared_error, b.squared_error);
    ASSERT_EQ(a.squared_error_before, b.squared_error_before);
}

TEST(RotationSteps, AreTheSameBitsByEveryInstructionSet) {
    std::mt19937_64 random(3);
    for (int body = 0; body < 40; ++body) {
        const RandomRotation r = random_rotation(random, body % 4);
        const auto coefficients = rotation_coefficients(r.inertia, &r.forcing);
        RotationAllowance allowance;
        for (double& square : allowance.squared_scale) square = 1e-18;
        allowance.rounding = 0x1p-53;
        RotationStep plain, wide;
        for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
            if (set > widest_instruction_set()) continue;
            for (int row = min_columns; row < table_rows; ++row) {
                if (coefficients->terms == RotationTerms::quadratic) break;  // compiled columns are used here
                midpoint_step(InstructionSet::plain)(*coefficients, allowance, r.state, 0.01, row, plain);
                midpoint_step(set)(*coefficients, allowance, r.state, 0.01, row, wide);
                expect_same(plain, wide);
            }
            Dop853RotationStep plain_step, wide_step;
            dop853_step(InstructionSet::plain)(*coefficients, allowance, r.state, 0.01, plain_step);
            dop853_step(set)(*coefficients, allowance, r.state, 0.01, wide_step);
            expect_same(plain_step, wide_step);
            for (int stage = 0; stage < dop853_stages; ++stage)
                for (int i = 0; i < 7; ++i) EXPECT_EQ(plain_step.rates[stage][i], wide_step.rates[stage][i]);
        }
    }
}

}  // namespace
}  // namespace polhode
