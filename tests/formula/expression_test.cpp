#include "formula/expression.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

#include "formula/formula_values.h"
#include "motion/dual.h"
#include "motion/traced.h"

namespace polhode {
namespace {

using test::FormulaFixture;

// formulas with every operation, defined for x in (0.1, 0.9), y and z in (1, 2)
constexpr const char* smooth_formulas[] = {
    "sin(x*y) + cos(z/x)*exp(-y)",
    "log(x)*atan2(y, z)",
    "asin(x) - acos(x*x) + tanh(y*x)",
    "sinh(x)*cosh(y) - cbrt(z)",
    "z^(x*y)",
    "y^1.7/(x + z)^2.5",
    "hypot(x, y)^3/sqrt(z)",
    "tan(x)/(1 + x^5)",
    "norm(r)^-3*dot(r, [1, 2, z])",
    "to_body(r).x*to_world(r).z",
    "dot(r, inertia(r))/2",
    "-(x - 2)*-y",
};

std::vector<double> random_inputs() {
    const auto unit = [] { return *rc::gen::inRange(0, 1'000'000) / 1e6; };
    return {0.1 + 0.8 * unit(), 1 + unit(), 1 + unit(), unit(), unit(), unit(), unit() + 0.1};
}

RC_GTEST_PROP(Expression, DifferentiatesLikeDualNumbersAndDifferences, ()) {
    FormulaFixture fixture;
    const std::string text =
        *rc::gen::elementOf(std::vector<std::string>(std::begin(smooth_formulas), std::end(smooth_formulas)));
    const int value = fixture.parse(text).component[0];
    const std::vector<int> slopes = fixture.expression.differentiate(value, {0, 1, 2, 3, 4, 5, 6});
    const std::vector<double> at = random_inputs();
    const std::vector<double> reverse = fixture.values<double>(slopes, at);
    std::vector<Dual<7>> dual;
    for (std::size_t i = 0; i < 7; ++i) dual.emplace_back(at[i]), dual.back().slope[i] = 1;
    const Dual<7> forward = fixture.values<Dual<7>>({value}, dual)[0];
    RC_ASSERT(std::abs(forward.value - fixture.values<double>({value}, at)[0]) <= 1e-14 * std::abs(forward.value));
    for (std::size_t i = 0; i < 7; ++i) {
        const double scale = 1 + std::abs(reverse[i]);
        RC_ASSERT(std::abs(reverse[i] - forward.slope[i]) <= 1e-11 * scale);
        const double h = 1e-6;
        std::vector<double> ahead = at, behind = at;
        ahead[i] += h, behind[i] -= h;
        const double difference =
            (fixture.values<double>({value}, ahead)[0] - fixture.values<double>({value}, behind)[0]) / (2 * h);
        RC_ASSERT(std::abs(reverse[i] - difference) <= 1e-5 * scale);
    }
}

// The rate of each auxiliary, from rules of +, -, *, / and square roots alone, is its derivative along the motion.
RC_GTEST_PROP(Expression, GivesTranscendentalNodesTheirRates, ()) {
    FormulaFixture fixture;
    const std::string text =
        *rc::gen::elementOf(std::vector<std::string>(std::begin(smooth_formulas), std::end(smooth_formulas)));
    const int value = fixture.parse(text).component[0];
    const std::vector<double> at = random_inputs(), rate = random_inputs();
    const std::vector<double> uniform =
        formula::compute_uniform_values<double>(fixture.expression, {2, 0.5, 0, 0.5, 3, 0, 0, 0, 4});
    const std::vector<char> needed = formula::find_needed(fixture.expression, {value});
    formula::Evaluation<double, double> values(fixture.expression, uniform, needed, nullptr);
    values.compute(at.data());
    const double found = values.compute_rates(rate.data())[static_cast<std::size_t>(value)];
    double expected = 0;
    const std::vector<double> slopes =
        fixture.values<double>(fixture.expression.differentiate(value, {0, 1, 2, 3, 4, 5, 6}), at);
    double scale = 1;
    for (std::size_t i = 0; i < 7; ++i) expected += slopes[i] * rate[i], scale += std::abs(slopes[i] * rate[i]);
    RC_ASSERT(std::abs(found - expected) <= 1e-11 * scale);
}

TEST(Expression, FoldsNumbersOnlyIfTheResultIsExact) {
    formula::Expression e;
    const auto is_number = [&](int node) {
        return e.nodes()[static_cast<std::size_t>(node)].operation == formula::Operation::number;
    };
    EXPECT_TRUE(is_number(e.add(e.number(1), e.number(2))));
    EXPECT_TRUE(is_number(e.multiply(e.number(0.1), e.number(4))));
    EXPECT_TRUE(is_number(e.divide(e.number(3), e.number(8))));
    EXPECT_TRUE(is_number(e.square_root(e.number(2.25))));
    EXPECT_FALSE(is_number(e.add(e.number(0.1), e.number(0.2))));
    EXPECT_FALSE(is_number(e.multiply(e.number(0.1), e.number(0.1))));
    EXPECT_FALSE(is_number(e.divide(e.number(1), e.number(3))));
    EXPECT_FALSE(is_number(e.square_root(e.number(2))));
    EXPECT_FALSE(is_number(e.multiply(e.number(1e-200), e.number(1e-200))));
    EXPECT_FALSE(is_number(e.multiply(e.number(1e200), e.number(1e200))));
}

// 1/3 + 1/7 in 113 bits differs from the sum of binary64 quotients.
TEST(Expression, EvaluatesConstantsInTheirScalar) {
    FormulaFixture fixture;
    const int value = fixture.parse("1/3 + exp(1)*pi").component[0];
    const std::vector<Wide> uniform =
        formula::compute_uniform_values<Wide>(fixture.expression, std::vector<Wide>(9, Wide(1)));
    const Wide found = uniform[static_cast<std::size_t>(value)];
    // e pi = 8.53973422267356706546355086954657449503488853576511
    const Wide expected = Wide(1) / 3 + (Wide(8.5) + Wide(39734222673567) * Wide(1) / Wide(1e15)) +
                          Wide(65463550869546) / Wide(1e15) / Wide(1e15);
    EXPECT_LT(std::abs(static_cast<double>(found - expected)), 1e-27);
}

TEST(Expression, ChoosesBranchesByGivenSigns) {
    FormulaFixture fixture;
    const int value = fixture.parse("if(x > 0, exp(y), sqrt(z))").component[0];
    const signed char positive[] = {1}, negative[] = {-1};
    const auto count = [&](const signed char* signs) {
        long found = 0;
        for (const char one : formula::find_needed(fixture.expression, {value}, signs)) found += one;
        return found;
    };
    // choose, switch argument, and a function of one input
    EXPECT_EQ(count(positive), 4);
    EXPECT_EQ(count(negative), 4);
    EXPECT_EQ(count(nullptr), 6);
}

}  // namespace
}  // namespace polhode
