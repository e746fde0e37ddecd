#include "figure/axis.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace polhode {
namespace {

std::vector<std::string> labels(const Axis& axis) {
    std::vector<std::string> texts;
    for (const Tic& tic : axis.tics) {
        if (!tic.label.empty()) texts.push_back(tic.label);
    }
    return texts;
}

using Labels = std::vector<std::string>;

TEST(Axis, LabelsDecades) {
    EXPECT_EQ(labels(make_axis(true, 2e-3, 50, 8, 0)), (Labels{"10^{−2}", "10^{−1}", "10^{0}", "10^{1}"}));
    // fifteen decades: every third has a label, the others only a tic
    const Axis wide = make_axis(true, 2e-15, 0.5, 7, 0);
    EXPECT_EQ(labels(wide), (Labels{"10^{−12}", "10^{−9}", "10^{−6}", "10^{−3}"}));
    EXPECT_EQ(wide.tics.size(), 14u);
}

TEST(Axis, LabelsDigitsWithinADecade) {
    EXPECT_EQ(labels(make_axis(true, 0.15, 0.8, 8, 0)), (Labels{"0.2", "0.3", "0.5", "0.7"}));
    EXPECT_EQ(labels(make_axis(true, 1.5e-9, 8e-9, 8, 0)),
              (Labels{"2×10^{−9}", "3×10^{−9}", "5×10^{−9}", "7×10^{−9}"}));
}

TEST(Axis, LabelsRoundValues) {
    EXPECT_EQ(labels(make_axis(false, 0, 10, 6, 0)), (Labels{"0", "2", "4", "6", "8", "10"}));
    EXPECT_EQ(labels(make_axis(false, -0.3, 0.3, 7, 0)), (Labels{"−0.3", "−0.2", "−0.1", "0", "0.1", "0.2", "0.3"}));
    const Axis small = make_axis(false, 0, 4e-9, 5, 0);
    EXPECT_EQ(labels(small), (Labels{"0", "1", "2", "3", "4"}));
    EXPECT_EQ(small.factor_exponent, -9);
    EXPECT_EQ(small.tics.back().position, "4e-9");
}

TEST(Axis, OfOneValueHasARangeAboutIt) {
    for (const bool logarithmic : {true, false}) {
        const Axis axis = make_axis(logarithmic, 3, 3, 7, 0.05);
        EXPECT_LT(axis.low, 3);
        EXPECT_GT(axis.high, 3);
        EXPECT_GE(labels(axis).size(), 2u);
    }
    EXPECT_GE(labels(make_axis(false, 0, 0, 7, 0)).size(), 2u);
}

TEST(Axis, KnowsWhatCanBeDrawn) {
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_TRUE(drawable(0, false));
    EXPECT_TRUE(drawable(1e-300, true));
    for (const double value : {0.0, -1.0, 5e-324, 1e301, infinity, std::nan("")}) EXPECT_FALSE(drawable(value, true));
    for (const double value : {-1e301, -infinity, infinity, std::nan("")}) EXPECT_FALSE(drawable(value, false));
}

TEST(Axis, StaysWithinBinary64) {
    const Axis axis = make_axis(true, 1e-300, 1e300, 8, 0.08);
    EXPECT_GT(axis.low, 0);
    EXPECT_TRUE(std::isfinite(axis.high));
    EXPECT_TRUE(std::isfinite(make_axis(false, -1e300, 1e300, 8, 0.08).high));
}

// For any finite data: the range is finite and contains them, two labels or more, and the tics rise within the range.
RC_GTEST_PROP(Axis, HoldsItsDataAndItsTics, (bool logarithmic)) {
    const auto value = [&] {
        const double mantissa = *rc::gen::inRange(1000, 10000) / 1000.0;
        const double magnitude = mantissa * std::pow(10.0, *rc::gen::inRange(-300, 300));
        return logarithmic || *rc::gen::arbitrary<bool>() ? magnitude : -magnitude;
    };
    const double a = value(), b = value();
    const int most = *rc::gen::inRange(4, 12);
    const double padding = *rc::gen::element(0.0, 0.08);
    const Axis axis = make_axis(logarithmic, std::min(a, b), std::max(a, b), most, padding);
    RC_ASSERT(std::isfinite(axis.low) && std::isfinite(axis.high) && axis.low < axis.high);
    // pow(log10(x)) has the rounding error of an exponent of up to 300: 4 times 300 ln(10) 2^-53
    const double slack = 3e-13;
    for (const double x : {a, b}) {
        RC_ASSERT(fraction(axis, x) > -slack);
        RC_ASSERT(fraction(axis, x) < 1 + slack);
    }
    RC_ASSERT(labels(axis).size() >= 2u);
    RC_ASSERT(static_cast<int>(labels(axis).size()) <= std::max(most + 1, 10));
    double before = -std::numeric_limits<double>::infinity();
    for (const Tic& tic : axis.tics) {
        const double position = std::strtod(tic.position.c_str(), nullptr);
        RC_ASSERT(std::isfinite(position) && position > before);
        RC_ASSERT(fraction(axis, position) >= -1e-8);
        RC_ASSERT(fraction(axis, position) <= 1 + 1e-8);
        before = position;
    }
}

}  // namespace
}  // namespace polhode
