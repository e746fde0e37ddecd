#include "figure/contour.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace polhode {
namespace {

double length(const ContourLine& line) {
    double sum = 0;
    for (std::size_t i = 1; i < line.x.size(); ++i)
        sum += std::hypot(line.x[i] - line.x[i - 1], line.y[i] - line.y[i - 1]);
    return sum;
}

TEST(Contour, OfACircleIsOneClosedLine) {
    const auto lines = contour([](double x, double y) { return x * x + y * y - 1; }, {-1.5, 1.7}, {-2, 1.4}, 60, 50);
    ASSERT_EQ(lines.size(), 1u);
    const ContourLine& line = lines[0];
    EXPECT_EQ(line.x.front(), line.x.back());
    EXPECT_EQ(line.y.front(), line.y.back());
    for (std::size_t i = 0; i < line.x.size(); ++i) EXPECT_NEAR(std::hypot(line.x[i], line.y[i]), 1, 1e-9);
    EXPECT_NEAR(length(line), 2 * std::numbers::pi, 1e-2);
}

// y^2 = x^2 + d: two branches from edge to edge, opening upward or sideways by the sign of d; some cells have a saddle.
TEST(Contour, PartsTheBranchesOfAHyperbola) {
    for (const double d : {0.003, -0.003}) {
        const auto f = [d](double x, double y) { return y * y - x * x - d; };
        const auto lines = contour(f, {-1, 1.1}, {-1.05, 1}, 11, 12);
        ASSERT_EQ(lines.size(), 2u) << d;
        for (const ContourLine& line : lines) {
            const std::vector<double>& along = d > 0 ? line.y : line.x;
            for (const double v : along) EXPECT_GT(v * along.front(), 0) << d;  // never crosses to the other side
        }
    }
}

TEST(Contour, TakesWhatIsNotANumberForOutside) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(contour([&](double, double) { return nan; }, {0, 1}, {0, 1}, 5, 5).empty());
    const auto half = contour([&](double x, double) { return x < 0.5 ? -1 : nan; }, {0, 1}, {0, 1}, 5, 4);
    ASSERT_EQ(half.size(), 1u);
    ASSERT_EQ(half[0].x.size(), 5u);
    for (const double x : half[0].x) EXPECT_NEAR(x, 0.5, 1e-9);
}

}  // namespace
}  // namespace polhode
