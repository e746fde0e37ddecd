// Compiled series of modes against interpreted ones.
#include "integrators/contact/mode_series.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "integrators/contact/mode_step.h"

namespace polhode::contact {
namespace {

// x' = v, v' = (1 + x v) / sqrt(1 + x^2) - sin(x), and the integral of v^2
struct Equations {
    template <class S>
    void derivative(const S* y, S* dy) const {
        S sine, cosine;
        sine_cosine(y[0], sine, cosine);
        dy[0] = y[1];
        dy[1] = (S(1.0) + y[0] * y[1]) / square_root(S(S(1.0) + y[0] * y[0])) - sine;
        dy[2] = y[1] * y[1];
    }
};

// The two sum products in different orders, and the compiled one without intermediate roundings.
TEST(ModeSeries, CompiledAndInterpretedCoefficientsAgree) {
    constexpr int order = 20;
    const std::vector<double> start{0.3, -0.7, 0};
    const Recording<double> recording = record<double>(Equations{}, 3);
    BinarySeries compiled(recording, order);
    Series<double> interpreted(recording, order);
    compiled.expand(start.data()), interpreted.expand(start.data());
    ASSERT_EQ(compiled.order(), order);
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k <= order; ++k) {
            const double expected = interpreted.coefficient(i, k);
            EXPECT_NEAR(compiled.coefficient(i, k), expected, 1e-13 * (std::abs(expected) + 1)) << i << " " << k;
        }
    std::vector<double> ends(3), expected(3);
    compiled.evaluate(0.25, ends.data()), interpreted.evaluate(0.25, expected.data());
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(ends[i], expected[i], 1e-15);
}

// Steps of a ten millionth of the possible length need a few orders, until one takes its full length.
TEST(StepOrder, FollowsTheLengthOfSteps) {
    StepOrder<Real<50>> order(48);
    order.note(48, 35, 0.04, 4e-9);
    const int low = order.next();
    EXPECT_GE(low, 12);
    EXPECT_LE(low, 15);
    order.note(low, 35, 1e-3, 0);
    EXPECT_EQ(order.next(), low);
    order.note(low, 35, 1e-3, 0.9e-3);
    EXPECT_EQ(order.next(), 48);
}

}  // namespace
}  // namespace polhode::contact
