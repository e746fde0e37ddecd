#include "integrators/truth/rounded_decimal.h"

#include <gtest/gtest.h>

namespace polhode::truth {
namespace {

TEST(RoundedDecimal, RoundsToTheNearest) {
    EXPECT_EQ(rounded_decimal("1.2344e+03", 4), "1.234e3");
    EXPECT_EQ(rounded_decimal("1.2346e-03", 4), "1.235e-3");
    // decided by the first omitted digit alone: half-way and more is rounded away from zero
    EXPECT_EQ(rounded_decimal("1.2345e0", 4), "1.235e0");
    EXPECT_EQ(rounded_decimal("1.234499999e0", 4), "1.234e0");
    EXPECT_EQ(rounded_decimal("-1.2346e0", 4), "-1.235e0");
}

TEST(RoundedDecimal, CarriesOverNines) {
    EXPECT_EQ(rounded_decimal("1.2996e0", 4), "1.300e0");
    EXPECT_EQ(rounded_decimal("-9.9996e-05", 4), "-1.000e-4");
    EXPECT_EQ(rounded_decimal("9.9994e7", 4), "9.999e7");
    EXPECT_EQ(rounded_decimal("9.6e0", 1), "1e1");
}

TEST(RoundedDecimal, LeavesWhatIsShorterAsItIs) {
    EXPECT_EQ(rounded_decimal("1.25e+02", 4), "1.25e2");
    EXPECT_EQ(rounded_decimal("3e0", 4), "3e0");
    EXPECT_EQ(rounded_decimal("0", 4), "0");
    EXPECT_EQ(rounded_decimal("nan", 4), "nan");
}

}  // namespace
}  // namespace polhode::truth
