#include "text/decimal.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace polhode {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

RC_GTEST_PROP(Decimal, ReadsBackTheSameBits, (std::uint64_t bits)) {
    const double value = std::bit_cast<double>(bits);
    RC_PRE(std::isfinite(value));
    const std::optional<double> read = parse_decimal(shortest_decimal(value));
    RC_ASSERT(read.has_value());
    RC_ASSERT(std::bit_cast<std::uint64_t>(*read) == bits);
}

TEST(Decimal, BeyondBinary64IsZeroOrInfinite) {
    for (const char* text : {"1e-400", "0.0001e-320", "1e-9223372036854775808", "1e-99999999999999999999", "0e999"}) {
        ASSERT_TRUE(parse_decimal(text)) << text;
        EXPECT_EQ(*parse_decimal(text), 0) << text;
        EXPECT_TRUE(std::signbit(*parse_decimal('-' + std::string(text)))) << text;
    }
    for (const char* text : {"1e400", "10000e305", "1e9223372036854775807", "1e+99999999999999999999", "inf"}) {
        ASSERT_TRUE(parse_decimal(text)) << text;
        EXPECT_EQ(*parse_decimal(text), infinity) << text;
    }
    // many digits combined with a large exponent give an ordinary number
    EXPECT_EQ(parse_decimal('1' + std::string(400, '0') + "e-400"), 1);
    EXPECT_EQ(parse_decimal("0." + std::string(399, '0') + "1e400"), 1);
}

TEST(Decimal, OnePlusMayStandBefore) {
    EXPECT_EQ(parse_decimal("+1.5"), 1.5);
    for (const char* text : {"", "+", "-", "++1", "+-1", "--1", "1.5x", " 1", "1 ", "0x10", "1e", "one"})
        EXPECT_FALSE(parse_decimal(text)) << text;
}

}  // namespace
}  // namespace polhode
