// Series by machine code and by the interpreter against plain series in 50 digits, on random systems and random tapes.
#include "integrators/tape/tape_series.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "integrators/series/series.h"
#include "tests/integrators/series/random_system.h"
#include "tests/integrators/tape/tape_oracle.h"

namespace polhode {
namespace {

void check_tape(const testing::RandomSystem& system, int order) {
    using R = Real<50>;
    const int n = static_cast<int>(system.variables);
    const Recording<double> recording = record<double>(system, n);
    TapeSeries series(recording, {.order = order});
    Series<R> exact(record<R>(system, n), order);
    const std::vector<R> start(system.start.begin(), system.start.end());
    series.expand(system.start.data());
    exact.expand(start.data());
    double growth = 1;  // growth of the coefficients and of their rounding errors
    for (int k = 0; k <= order; ++k) {
        for (int i = 0; i < n; ++i)
            growth = std::max(growth, std::abs(exact.coefficient(i, k).template convert_to<double>()));
        for (int i = 0; i < n; ++i) {
            const R off = exact.coefficient(i, k) - series.coefficient(i, k);
            RC_ASSERT(std::abs(off.template convert_to<double>()) <= 1e-12 * (k + 1) * growth);
        }
    }
}

RC_GTEST_PROP(TapeSeries, HasTheCoefficientsOfPlainSeriesInEveryWay, ()) {
    const testing::RandomSystem system = testing::random_system(60);
    const Recording<double> recording = record<double>(system, static_cast<int>(system.variables));
    for (const int order : {2, 3, 12, 17, 20, TapeLayout::most_order}) {
        check_tape(system, order);
        testing::compare_ways(recording, order, order % 2 == 0, system.start);
    }
}

// for arbitrary operations, including values that are not finite
RC_GTEST_PROP(TapeSeries, HasTheSameBitsInEveryWayForAnyTape, ()) {
    const auto bytes = *rc::gen::scale(8, rc::gen::arbitrary<std::vector<std::uint8_t>>());
    const testing::TapeOfBytes tape(bytes.data(), bytes.size());
    testing::compare_ways(tape.recording, tape.order, tape.careful, tape.start);
    testing::compare_ways_of_rates(tape.recording, tape.start);
}

RC_GTEST_PROP(TapeRates, AreTheRightHandSideInEveryLane, ()) {
    const testing::RandomSystem system = testing::random_system(60);
    const int n = static_cast<int>(system.variables);
    constexpr int lanes = TapeRates::lanes;
    TapeRates rates(record<double>(system, n));
    testing::LaneNumbers y(system.variables * lanes);
    for (int i = 0; i < n * lanes; ++i) y[i] = system.start[i / lanes] + 0.125 * (i % lanes);
    const testing::LaneNumbers f = testing::rates_of(rates, y);
    for (int lane = 0; lane < lanes; ++lane) {
        std::vector<double> one(system.variables), exact(system.variables);
        for (int i = 0; i < n; ++i) one[i] = y[i * lanes + lane];
        system.derivative(one.data(), exact.data());
        for (int i = 0; i < n; ++i)
            RC_ASSERT(std::abs(f[i * lanes + lane] - exact[i]) <= 1e-13 * (1 + std::abs(exact[i])));
    }
    testing::compare_ways_of_rates(record<double>(system, n), system.start);
}

// angles beyond the range of the vectorised sine, and NaN
TEST(TapeRates, TakeAnyAngle) {
    struct Wave {
        void derivative(const Traced<double>* y, Traced<double>* dy) const {
            Traced<double> c;
            sine_cosine(y[0], dy[0], c);
        }
    };
    TapeRates rates(record<double>(Wave{}, 1));
    const testing::LaneNumbers y{0, 1, -1e5, 1e5 + 1, 1e300, -1e22, 1e-300, HUGE_VAL};
    const testing::LaneNumbers f = testing::rates_of(rates, y);
    for (int i = 0; i < 7; ++i) EXPECT_NEAR(f[i], std::sin(y[i]), 2.3e-16) << y[i];
    EXPECT_TRUE(std::isnan(f[7]));
}

// (k + 1) y_{k+1} = [k = 0]: a tape without operations
TEST(TapeSeries, OfConstantRatesIsALine) {
    struct Line {
        void derivative(const Traced<double>*, Traced<double>* dy) const {
            dy[0] = Traced<double>(3), dy[1] = Traced<double>();
        }
    };
    const double start[2] = {1, 2};
    for (const bool compiled : {false, true}) {
        TapeSeries series(record<double>(Line{}, 2), {.compiled = compiled, .order = 12});
        series.expand(start);
        EXPECT_EQ(series.coefficient(0, 0), 1);
        EXPECT_EQ(series.coefficient(0, 1), 3);
        EXPECT_EQ(series.coefficient(1, 0), 2);
        for (int k = 2; k <= 12; ++k) EXPECT_EQ(series.coefficient(0, k), 0);
        for (int k = 1; k <= 12; ++k) EXPECT_EQ(series.coefficient(1, k), 0);
    }
}

// y'' = -y: each state is the other's rate, read after the other has changed
TEST(TapeSeries, OfTwoStatesThatAreEachOthersRates) {
    struct Circle {
        void derivative(const Traced<double>* y, Traced<double>* dy) const { dy[0] = y[1], dy[1] = -y[0]; }
    };
    const double start[2] = {0, 1};
    for (const bool compiled : {false, true}) {
        TapeSeries series(record<double>(Circle{}, 2), {.compiled = compiled, .careful = true, .order = 20});
        series.expand(start);
        double factorial = 1;
        for (int k = 1; k <= 20; ++k) {
            factorial *= k;
            const double sine = k % 2 == 0 ? 0 : (k % 4 == 1 ? 1 : -1) / factorial;
            EXPECT_NEAR(series.coefficient(0, k) * factorial, sine * factorial, 4e-16 * k) << k;
        }
    }
}

// equal tapes share one prepared program
TEST(TapeSeries, OfEqualTapesSharesWhatIsPrepared) {
    struct Pendulum {
        double g;
        void derivative(const Traced<double>* y, Traced<double>* dy) const {
            Traced<double> s, c;
            sine_cosine(y[0], s, c);
            dy[0] = y[1], dy[1] = -g * s;
        }
    };
    const auto made = [](double g, int order) { return TapeSeries(record<double>(Pendulum{g}, 2), {.order = order}); };
    const TapeSeries one = made(9.81, 12), same = made(9.81, 12), other = made(9.8, 12), longer = made(9.81, 14);
    EXPECT_EQ(&one.tape(), &same.tape());
    EXPECT_NE(&one.tape(), &other.tape());
    EXPECT_NE(&one.tape(), &longer.tape());
    EXPECT_EQ(one.tape().code != nullptr, may_compile() && instruction_set() != InstructionSet::plain);
}

// the cheapest order increases as the tolerance decreases
TEST(TapeSeries, ChoosesHigherOrdersForTighterTolerances) {
    const TapeProgram program(
        record<double>(testing::RandomSystem{2, {{0, 0, 1, 0.5}, {4, 0, 0, 1.0}}, {0.5, 0.25}}, 2));
    int before = 0;
    for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12, 1e-15}) {
        const int order = best_order(program, tolerance);
        EXPECT_GE(order, before);
        EXPECT_GE(order, 6);
        EXPECT_LE(order, TapeLayout::most_order);
        before = order;
    }
    EXPECT_LT(best_order(program, 1e-3), best_order(program, 1e-15));
}

TEST(TapeSeries, OfAnOrderThatIsNoneIsRefused) {
    const auto recording = record<double>(testing::RandomSystem{2, {{0, 0, 1, 0.5}}, {0.5, 0.25}}, 2);
    EXPECT_THROW(TapeSeries(recording, {.order = 1}), std::invalid_argument);
    EXPECT_THROW(TapeSeries(recording, {.order = TapeLayout::most_order + 1}), std::invalid_argument);
}

}  // namespace
}  // namespace polhode
