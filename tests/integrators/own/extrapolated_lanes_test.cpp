#include "integrators/own/extrapolated_lanes.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace polhode {
namespace {

using Traced = Traced<double>;

// x' = v, v' = -k x, with a different k in each lane
struct Oscillator {
    void derivative(const Traced* y, Traced* dy) const { dy[0] = y[1], dy[1] = -(y[2] * y[0]), dy[2] = Traced(); }
};
// y' = k y^2 diverges at 1/(k y_0)
struct Pole {
    void derivative(const Traced* y, Traced* dy) const { dy[0] = y[1] * (y[0] * y[0]), dy[1] = Traced(); }
};

struct Many {
    std::vector<double> y, sizes;
    std::vector<LaneMotion> motions;
    Many(std::vector<double> y_, std::size_t n) : y(std::move(y_)), sizes(y.size(), 1), motions(y.size() / n) {
        for (std::size_t k = 0; k < motions.size(); ++k) motions[k].y = &y[n * k], motions[k].sizes = &sizes[n * k];
    }
};

// more oscillators than lanes, from slow to fast, in two spans
TEST(ExtrapolatedLanes, OscillatorsAreIndependent) {
    constexpr std::size_t count = 37;
    for (const double tolerance : {1e-4, 1e-7, 1e-10, 1e-13}) {
        std::vector<double> y;
        for (std::size_t i = 0; i < count; ++i) {
            const double w = 0.25 * static_cast<double>(i);
            y.insert(y.end(), {1, 0, w * w});
        }
        Many many(y, 3);
        ExtrapolatedLanes lanes(record<double>(Oscillator{}, 3), {0, 1, 2}, tolerance, 100'000);
        lanes.advance(many.motions, 2), lanes.advance(many.motions, 1);
        for (std::size_t i = 0; i < count; ++i) {
            const double w = 0.25 * static_cast<double>(i);
            EXPECT_EQ(many.motions[i].end, LaneMotion::End::reached);
            EXPECT_NEAR(many.y[3 * i], std::cos(3 * w), 300 * tolerance + 3e-14) << w << ' ' << tolerance;
            EXPECT_EQ(many.y[3 * i + 2], w * w);
        }
        EXPECT_GT(many.motions.back().steps, many.motions[4].steps);
    }
}

TEST(ExtrapolatedLanes, ReportWhereTheyEnd) {
    Many many({1, 0.5, 1, 2, 0, 1, 1, std::numeric_limits<double>::quiet_NaN()}, 2);
    ExtrapolatedLanes lanes(record<double>(Pole{}, 2), {0, 1}, 1e-9, 10'000);
    lanes.advance(many.motions, 1);
    EXPECT_EQ(many.motions[0].end, LaneMotion::End::reached);
    EXPECT_NEAR(many.y[0], 2, 1e-7);
    EXPECT_NE(many.motions[1].end, LaneMotion::End::reached);
    EXPECT_NEAR(many.motions[1].reached, 0.5, 1e-3);
    EXPECT_EQ(many.motions[2].end, LaneMotion::End::reached);
    EXPECT_EQ(many.y[4], 0);
    EXPECT_EQ(many.motions[3].end, LaneMotion::End::not_finite);
    EXPECT_EQ(many.motions[3].reached, 0);
    Many slow({1, 0, 1e6}, 3);
    ExtrapolatedLanes few(record<double>(Oscillator{}, 3), {0, 1, 2}, 1e-9, 20);
    few.advance(slow.motions, 1);
    EXPECT_EQ(slow.motions[0].end, LaneMotion::End::too_many_steps);
    EXPECT_GT(slow.motions[0].reached, 0);
    EXPECT_LT(slow.motions[0].reached, 1);
}

}  // namespace
}  // namespace polhode
