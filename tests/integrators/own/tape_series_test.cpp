// The kernel for long tapes against plain series in 50 digits, on random systems.
#include "integrators/own/tape_series.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "integrators/series/series.h"
#include "tests/integrators/series/random_system.h"

namespace polhode {
namespace {

template <int order>
void check_tape(const testing::RandomSystem& system) {
    using R = truth::Real<50>;
    const int n = static_cast<int>(system.variables);
    const truth::Recording<double> recording = truth::record<double>(system, n);
    TapeSeries<order> series(recording, InstructionSet::plain);
    truth::Series<R> exact(truth::record<R>(system, n), order);
    const std::vector<double> elsewhere(system.variables, 0.3);
    const std::vector<R> start(system.start.begin(), system.start.end());
    // what an expansion leaves behind means nothing to the next
    series.expand(elsewhere.data());
    series.expand(system.start.data());
    exact.expand(start.data());
    double growth = 1;  // of the coefficients, and of what rounding makes of them
    for (int k = 0; k <= order; ++k) {
        for (int i = 0; i < n; ++i)
            growth = std::max(growth, std::abs(exact.coefficient(i, k).template convert_to<double>()));
        for (int i = 0; i < n; ++i) {
            const R off = exact.coefficient(i, k) - series.coefficient(i, k);
            RC_ASSERT(std::abs(off.template convert_to<double>()) <= 1e-12 * (k + 1) * growth);
        }
    }
    for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
        if (set > widest_instruction_set()) continue;
        TapeSeries<order> other(recording, set);
        other.expand(system.start.data());
        for (int k = 0; k <= order; ++k)
            for (int i = 0; i < n; ++i) RC_ASSERT(other.coefficient(i, k) == series.coefficient(i, k));
    }
}

RC_GTEST_PROP(TapeSeries, HasTheCoefficientsOfPlainSeriesByAllInstructions, ()) {
    const testing::RandomSystem system = testing::random_system(60);
    check_tape<12>(system);
    check_tape<16>(system);
    check_tape<20>(system);
    check_tape<30>(system);
}

// (k + 1) y_{k+1} = [k = 0]: a tape without an operation
TEST(TapeSeries, OfConstantRatesIsALine) {
    struct Line {
        void derivative(const truth::Traced<double>*, truth::Traced<double>* dy) const {
            dy[0] = truth::Traced<double>(3), dy[1] = truth::Traced<double>();
        }
    };
    TapeSeries<12> series(truth::record<double>(Line{}, 2));
    const double start[2] = {1, 2};
    series.expand(start);
    EXPECT_EQ(series.coefficient(0, 0), 1);
    EXPECT_EQ(series.coefficient(0, 1), 3);
    EXPECT_EQ(series.coefficient(1, 0), 2);
    for (int k = 2; k <= 12; ++k) EXPECT_EQ(series.coefficient(0, k), 0);
    for (int k = 1; k <= 12; ++k) EXPECT_EQ(series.coefficient(1, k), 0);
}

}  // namespace
}  // namespace polhode
