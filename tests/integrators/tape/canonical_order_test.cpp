#include "integrators/tape/canonical_order.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <vector>

#include "tests/integrators/series/random_system.h"
#include "tests/integrators/tape/tape_oracle.h"

namespace polhode {
namespace {

// The same right-hand side with its products recorded in either order; compilers choose the order for p + q.
struct EitherOrder {
    bool is_reversed;

    template <class S>
    void derivative(const S* y, S* dy) const {
        std::array<S, 6> products;
        S sine, cosine;
        for (int k = 0; k < 6; ++k) {
            const int i = is_reversed ? 5 - k : k;
            products[i] = y[i % 4] * y[(i + 1 + i / 4) % 4];
        }
        const auto angle = [&] { sine_cosine(y[3], sine, cosine); };
        if (!is_reversed) angle();
        const S root = square_root(S(2) + products[0]);
        if (is_reversed) angle();
        dy[0] = products[0] + products[1];
        dy[1] = is_reversed ? products[3] * S(0.3) + (products[1] + products[2])
                            : (products[2] + products[1]) + S(0.3) * products[3];
        dy[2] = sine * products[4] - cosine;
        dy[3] = products[5] / root;
    }
};

TEST(CanonicalOrder, IsThatOfNoCompiler) {
    const std::vector<double> start{0.7, -0.3, 1.1, 0.4};
    const Recording<double> one = record<double>(EitherOrder{false}, 4);
    const Recording<double> other = record<double>(EitherOrder{true}, 4);
    ASSERT_NE(one.tape.nodes, other.tape.nodes);
    EXPECT_EQ(in_canonical_order(one).tape.nodes, in_canonical_order(other).tape.nodes);
    TapeSeries first(one, {.order = 12}), second(other, {.order = 12});
    first.expand(start.data()), second.expand(start.data());
    for (int k = 0; k <= 12; ++k)
        for (int i = 0; i < 4; ++i) EXPECT_EQ(first.coefficient(i, k), second.coefficient(i, k)) << i << ' ' << k;
}

RC_GTEST_PROP(CanonicalOrder, IsItsOwn, ()) {
    const testing::RandomSystem system = testing::random_system(60);
    const Recording<double> recording = record<double>(system, static_cast<int>(system.variables));
    const Recording<double> once = in_canonical_order(recording), twice = in_canonical_order(once);
    RC_ASSERT(once.tape.nodes.size() == recording.tape.nodes.size());
    RC_ASSERT(twice.tape.nodes == once.tape.nodes);
    for (std::size_t i = 0; i < once.rates.size(); ++i) RC_ASSERT(once.rates[i].node == twice.rates[i].node);
}

// More angles than registers, with consecutive sines.
struct ManyAngles {
    static constexpr int angles = 40;

    template <class S>
    void derivative(const S* y, S* dy) const {
        std::vector<S> sines(angles), cosines(angles);
        for (int i = 0; i < angles; ++i) sine_cosine(y[i], sines[i], cosines[i]);
        for (int i = 0; i < angles; ++i) dy[i] = sines[i] * cosines[(i + 1) % angles];
    }
};

TEST(TapeRates, OfManyAnglesAreTheSameInEveryWay) {
    std::vector<double> start(ManyAngles::angles);
    for (int i = 0; i < ManyAngles::angles; ++i) start[i] = 0.05 * i;
    testing::compare_ways_of_rates(record<double>(ManyAngles{}, ManyAngles::angles), start);
}

}  // namespace
}  // namespace polhode
