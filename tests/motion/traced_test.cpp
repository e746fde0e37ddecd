// The tape: constant folding, sharing of common subexpressions, and removal of unused nodes.
#include "motion/traced.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <vector>

namespace polhode::truth {
namespace {

using Number = Traced<double>;
using Kind = TapeNode<double>::Kind;

/// A tape of two state variables.
struct TwoVariables {
    Tape<double> tape;
    Number x, y;

    TwoVariables() {
        for (int i = 0; i < 2; ++i) tape.nodes.push_back({Kind::state, i, 0, 0, 0});
        x = Number(1, 0, &tape), y = Number(1, 1, &tape);
    }
};

TEST(Traced, QuotientsFold) {
    TwoVariables v;
    const Number half = v.x / 2.0;
    EXPECT_EQ(half.node, v.x.node);
    EXPECT_EQ(half.factor, 0.5);
    EXPECT_EQ((0.0 / v.x).node, Number::constant);
    EXPECT_EQ((0.0 / v.x).factor, 0);
    EXPECT_EQ((3.0 * v.x / (-2.0 * v.x)).node, Number::constant);
    EXPECT_EQ((3.0 * v.x / (-2.0 * v.x)).factor, -1.5);
    EXPECT_EQ((Number(3) / Number(2)).factor, 1.5);
    EXPECT_EQ(v.tape.nodes.size(), 2u);
    const Number q = 6.0 * v.x / (2.0 * v.y), r = v.x / v.y, one_over = 5.0 / (2.0 * v.y);
    EXPECT_EQ(q.node, r.node);
    EXPECT_EQ(q.factor, 3);
    EXPECT_EQ(one_over.factor, 2.5);
    EXPECT_LT(v.tape.nodes[one_over.node].a, 0);
    EXPECT_NE((v.y / v.x).node, r.node);
    EXPECT_EQ(v.tape.nodes.size(), 5u);
}

TEST(Traced, SinesComeWithTheirCosinesAndSignsStayOutside) {
    TwoVariables v;
    Number s, c, minus_s, also_c;
    sine_cosine(v.x, s, c);
    sine_cosine(-v.x, minus_s, also_c);
    EXPECT_EQ(v.tape.nodes.size(), 4u);
    EXPECT_EQ(minus_s.node, s.node);
    EXPECT_EQ(minus_s.factor, -1);
    EXPECT_EQ(also_c.node, c.node);
    EXPECT_EQ(also_c.factor, 1);
    EXPECT_EQ(v.tape.nodes[s.node].b, c.node);
    EXPECT_EQ(v.tape.nodes[c.node].b, s.node);
    // the argument 2 x: sign factors out, and the argument is a node for 2 x
    Number twice = -2.0 * v.x;
    sine_cosine(twice, twice, c);
    EXPECT_EQ(twice.factor, -1);
    const TapeNode<double>& argument = v.tape.nodes[v.tape.nodes[twice.node].a];
    EXPECT_EQ(argument.kind, Kind::combination);
    EXPECT_EQ(argument.factor_a, 2);
    EXPECT_EQ(argument.a, v.x.node);
    sine_cosine(Number(0.5), s, c);
    EXPECT_EQ(s.node, Number::constant);
    EXPECT_EQ(s.factor, std::sin(0.5));
    EXPECT_EQ(c.factor, std::cos(0.5));
}

TEST(Traced, RootsAreOfNodes) {
    TwoVariables v;
    EXPECT_EQ(square_root(Number(9)).factor, 3);
    const Number r = square_root(v.x), again = square_root(v.x), of_four = square_root(4.0 * v.x);
    EXPECT_EQ(r.node, again.node);
    EXPECT_NE(of_four.node, r.node);
    EXPECT_EQ(v.tape.nodes[v.tape.nodes[of_four.node].a].factor_a, 4);
}

/// Computes more than it uses: an unused product, and two sine-cosine pairs of which one value each is used.
struct Wasteful {
    template <class S>
    void derivative(const S* y, S* dy) const {
        const S unused = y[0] * y[1] / (y[0] + S(3));
        S s, c, s2, c2;
        sine_cosine(S(2) * y[1], s, c);
        sine_cosine(y[0], s2, c2);
        dy[0] = s / square_root(y[0] + S(2));
        dy[1] = c2 + S(0) * unused;
    }
};

TEST(Record, KeepsWhatRatesDependOnAndPairsWhole) {
    const Recording<double> recording = record<double>(Wasteful{}, 2);
    const std::vector<TapeNode<double>>& nodes = recording.tape.nodes;
    // 2 state variables, 2 y1, its sine and cosine, those of y0, y0 + 2, the root, the quotient
    ASSERT_EQ(nodes.size(), 10u);
    for (int i = 0; i < 10; ++i) {
        const TapeNode<double>& node = nodes[i];
        if (node.kind == Kind::state) continue;
        EXPECT_LT(node.a, i);
        if (node.kind == Kind::sine) {
            ASSERT_EQ(node.b, i + 1);
            EXPECT_EQ(nodes[i + 1].kind, Kind::cosine);
            EXPECT_EQ(nodes[i + 1].a, node.a);
            EXPECT_EQ(nodes[i + 1].b, i);
        } else {
            EXPECT_LT(node.b, i);
        }
    }
    const TapeNode<double>& quotient = nodes[recording.rates[0].node];
    EXPECT_EQ(quotient.kind, Kind::quotient);
    EXPECT_EQ(nodes[quotient.a].kind, Kind::sine);
    EXPECT_EQ(nodes[quotient.b].kind, Kind::root);
    EXPECT_EQ(nodes[recording.rates[1].node].kind, Kind::cosine);
    EXPECT_EQ(nodes[nodes[recording.rates[1].node].a].kind, Kind::state);
    EXPECT_FALSE(is_polynomial(recording));
}

TEST(Tape, OfAHundredThousandNodesIsQuicklyMadeInOrder) {
    const auto begin = std::chrono::steady_clock::now();
    TwoVariables v;
    std::vector<Number> all{v.x, v.y};
    // each number is recorded twice; the second time the existing node is found
    for (int pass = 0; pass < 2; ++pass)
        for (int i = 0; i < 50'000; ++i) {
            const Number product = all[i] * all[i + 1], sum = product + 1.0;
            if (pass == 0) {
                ASSERT_EQ(product.node, static_cast<int>(v.tape.nodes.size()) - 2);
                all.push_back(sum);
            } else {
                ASSERT_EQ(sum.node, all[i + 2].node);
            }
        }
    EXPECT_EQ(v.tape.nodes.size(), 100'002u);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
    EXPECT_LT(taken.count(), 10) << "a search through all nodes compares 10^10 of them";
}

}  // namespace
}  // namespace polhode::truth
