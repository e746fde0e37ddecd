// Conversion between decimals and 128-bit numbers, in both directions.
#include "experiment/kinds/published_figures.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <string>

namespace polhode {
namespace {

TEST(PublishedFigures, DecimalsAreReadInAllTheirDigits) {
    EXPECT_EQ(static_cast<double>(parse_wide("-929.47")), -929.47);
    EXPECT_EQ(static_cast<double>(parse_wide("1e-3")), 1e-3);
    EXPECT_EQ(static_cast<double>(parse_wide("+2.5E2")), 250);
    EXPECT_EQ(static_cast<double>(parse_wide("0.0625")), 0.0625);
    // 1/3 to 33 digits: 1 - 3 third equals the truncation error, 1e-33
    const Wide third = parse_wide("0.333333333333333333333333333333333");
    EXPECT_NEAR(static_cast<double>((1 - 3 * third) * 1e33), 1, 0.2);
}

TEST(PublishedFigures, DecimalsAreRoundedAndWrittenByTheirSize) {
    const Wide ninth = Wide(1) / 9;
    EXPECT_EQ(format_wide(ninth, 20), "0.11111111111111111111");
    EXPECT_EQ(format_wide(-ninth, 3), "-0.111");
    EXPECT_EQ(format_wide(Wide(2) / 3, 5), "0.66667");
    EXPECT_EQ(format_wide(0, 5), "0");
    EXPECT_EQ(format_wide(1000, 2), "1000");
    EXPECT_EQ(format_wide(Wide(123456789), 9), "123456789");
    EXPECT_EQ(format_wide(Wide(-1234.5), 6), "-1234.50");
    EXPECT_EQ(format_wide(Wide(999.9996), 4), "1000");
    EXPECT_EQ(format_wide(Wide(0.000125), 2), "0.00013");
    // below 1e-4 and above 1e9: scientific notation
    EXPECT_EQ(parse_wide(format_wide(Wide(0.5e-4), 3)), parse_wide("5e-5"));
    EXPECT_NE(format_wide(Wide(0.5e-4), 3).find('e'), std::string::npos);
    EXPECT_NE(format_wide(Wide(2e9), 3).find('e'), std::string::npos);
    EXPECT_EQ(format_wide(Wide(2e8), 3).find('e'), std::string::npos);
}

RC_GTEST_PROP(PublishedFiguresProperties, WrittenToThirtyDigitsAreReadBack, (int numerator, int exponent)) {
    const Wide value = Wide(numerator) / 7 * Wide(std::pow(10.0, exponent % 12));
    const Wide back = parse_wide(format_wide(value, 30));
    RC_ASSERT(std::abs(static_cast<double>(back - value)) <= 1e-29 * std::abs(static_cast<double>(value)));
}

}  // namespace
}  // namespace polhode
