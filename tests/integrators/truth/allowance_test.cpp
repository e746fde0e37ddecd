#include "integrators/truth/allowance.h"

#include <gtest/gtest.h>

namespace polhode::truth {
namespace {

TEST(Allowance, OneInsideAnotherGivesNoMoreThanIsLeft) {
    EXPECT_FALSE(Allowance::is_spent());
    {
        const Allowance outer(-1);
        EXPECT_TRUE(Allowance::is_spent());
        const Allowance inner(1000);
        EXPECT_TRUE(Allowance::is_spent());
        EXPECT_LT(Allowance::left(), 0);
    }
    const Allowance outer(1000);
    {
        const Allowance inner(-1);
        EXPECT_TRUE(Allowance::is_spent());
    }
    EXPECT_FALSE(Allowance::is_spent());
    EXPECT_GT(Allowance::left(), 900);
}

}  // namespace
}  // namespace polhode::truth
