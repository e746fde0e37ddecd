// The order conditions of DOP853, one per rooted tree (Butcher; Hairer, Norsett & Wanner 1993, II.2).
#include "integrators/own/dormand_prince.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace polhode {
namespace {

/// Phi_i(t) at each stage, the sums of magnitudes for the rounding error, and gamma(t).
struct Tree {
    int order = 1;
    double gamma = 1;
    std::array<double, dop853_stages> phi, size;
};

Tree leaf() {
    Tree t;
    t.phi.fill(1), t.size.fill(1);
    return t;
}
/// The tree with another branch at its root; the caller completes `gamma`.
Tree grown(Tree t, const Tree& branch) {
    t.order += branch.order, t.gamma *= branch.gamma;
    for (int i = 0; i < dop853_stages; ++i) {
        double sum = 0, size = 0;
        for (int j = 0; j < dop853_stages; ++j)
            sum += dop853.a[i][j] * branch.phi[j], size += std::abs(dop853.a[i][j]) * branch.size[j];
        t.phi[i] *= sum, t.size[i] *= size;
    }
    return t;
}

/// All rooted trees with at most `most` vertices, by order. Branches have a fixed order, so no tree occurs twice.
std::vector<Tree> rooted_trees(int most) {
    std::vector<Tree> trees{leaf()};
    for (int order = 2; order <= most; ++order) {
        const std::vector<Tree> smaller = trees;
        const auto grow = [&](const auto& self, const Tree& root, std::size_t last) -> void {
            if (root.order == order) {
                trees.push_back(root);
                trees.back().gamma *= order;
                return;
            }
            for (std::size_t i = 0; i <= last; ++i)
                if (root.order + smaller[i].order <= order) self(self, grown(root, smaller[i]), i);
        };
        grow(grow, leaf(), smaller.size() - 1);
    }
    return trees;
}

/// The number of conditions of this order that the weights violate.
int missed(const std::vector<Tree>& trees, const double* weights, int order, bool against_zero) {
    int count = 0;
    for (const Tree& t : trees) {
        if (t.order != order) continue;
        double sum = 0, size = 0;
        for (int i = 0; i < dop853_stages; ++i) sum += weights[i] * t.phi[i], size += std::abs(weights[i]) * t.size[i];
        if (std::abs(sum - (against_zero ? 0 : 1 / t.gamma)) > 1e-15 * (size + 1)) ++count;
    }
    return count;
}

TEST(Dop853, HoldsEveryOrderCondition) {
    const std::vector<Tree> trees = rooted_trees(9);
    std::array<int, 10> count{};
    for (const Tree& t : trees) ++count[t.order];
    EXPECT_EQ(count, (std::array<int, 10>{0, 1, 1, 2, 4, 9, 20, 48, 115, 286}));  // Cayley's numbers
    for (int order = 1; order <= 8; ++order) EXPECT_EQ(missed(trees, dop853.b, order, false), 0) << order;
    EXPECT_GT(missed(trees, dop853.b, 9, false), 0);
    for (int order = 1; order <= 5; ++order) EXPECT_EQ(missed(trees, dop853.fifth_error, order, true), 0) << order;
    EXPECT_GT(missed(trees, dop853.fifth_error, 6, true), 0);
    for (int order = 1; order <= 3; ++order) EXPECT_EQ(missed(trees, dop853.third, order, false), 0) << order;
    EXPECT_GT(missed(trees, dop853.third, 4, false), 0);
}

TEST(Dop853, StagesAreAtTheSumsOfTheirRows) {
    for (int i = 0; i < dop853_stages; ++i) {
        double sum = 0, size = 1;
        for (int j = 0; j < dop853_stages; ++j) sum += dop853.a[i][j], size += std::abs(dop853.a[i][j]);
        EXPECT_NEAR(sum, dop853.c[i], 1e-16 * size * dop853_stages);
    }
}

}  // namespace
}  // namespace polhode
