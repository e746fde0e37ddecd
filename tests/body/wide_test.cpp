#include "body/wide.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace polhode {
namespace {

TEST(WideSquareRoot, IsRightToTheLastBits) {
    for (const double x : {2.0, 3.0, 1e-300, 1e300, 0x1p-1074, 0x1p1023}) {
        const Wide root = square_root(Wide(x)), off = root * root / Wide(x) - 1;
        EXPECT_LT(std::abs(static_cast<double>(off)), 0x1p-110) << x;
    }
    // beyond the range of binary64
    const Wide large = Wide(1e300) * Wide(1e300) * Wide(1e300);
    EXPECT_LT(std::abs(static_cast<double>(square_root(large) / Wide(1e300) / square_root(Wide(1e300)) - 1)), 0x1p-110);
}

TEST(WideSquareRoot, OfWhatIsNoPositiveNumber) {
    const double infinite = std::numeric_limits<double>::infinity();
    EXPECT_EQ(static_cast<double>(square_root(Wide(0))), 0);
    EXPECT_EQ(static_cast<double>(square_root(Wide(-1e-30))), 0);
    EXPECT_EQ(static_cast<double>(square_root(Wide(infinite))), infinite);
    EXPECT_TRUE(std::isnan(static_cast<double>(square_root(Wide(std::numeric_limits<double>::quiet_NaN())))));
}

}  // namespace
}  // namespace polhode
