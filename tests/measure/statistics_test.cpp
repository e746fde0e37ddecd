#include "measure/statistics.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace polhode {
namespace {

using Points = std::vector<std::pair<double, double>>;

TEST(LeastSquaresLine, IsTheTextbooksOne) {
    // Sum xy = 41, sum x = 6, sum y = 18, sum x^2 = 14: slope (4 41 - 6 18) / (4 14 - 36) = 2.8
    const Line line = least_squares_line(Points{{0, 0}, {1, 4}, {2, 5}, {3, 9}});
    EXPECT_NEAR(line.slope, 2.8, 1e-15);
    EXPECT_EQ(line.x_mean, 1.5);
    EXPECT_EQ(line.y_mean, 4.5);
    EXPECT_NEAR(line.at(0), 0.3, 1e-15);
    EXPECT_TRUE(std::isnan(least_squares_line(Points{{1, 2}, {1, 3}}).slope));
}

RC_GTEST_PROP(LeastSquaresLine, LeavesResidualsAtRightAnglesToWhatItFits, ()) {
    Points points;
    for (int i = 0; i < 9; ++i) points.emplace_back(i, *rc::gen::inRange(-1000, 1000) / 100.0);
    const Line line = least_squares_line(points);
    double sum = 0, moment = 0;
    for (const auto& [x, y] : points) sum += y - line.at(x), moment += x * (y - line.at(x));
    RC_ASSERT(std::abs(sum) < 1e-11);
    RC_ASSERT(std::abs(moment) < 1e-10);
}

TEST(Median, IsTheMiddleOfTheSorted) {
    EXPECT_EQ(median({3}), 3);
    EXPECT_EQ(median({5, 1, 3}), 3);
    EXPECT_EQ(median({4, 1, 3, 2}), 2.5);
}

}  // namespace
}  // namespace polhode
