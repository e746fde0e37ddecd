#include "experiment/plan/pattern.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace polhode {
namespace {

TEST(Pattern, MatchesAnywhere) {
    EXPECT_TRUE(Pattern("").matches("anything"));
    EXPECT_TRUE(Pattern("rk4$").matches("free/odeint_rk4"));
    EXPECT_FALSE(Pattern("^rk4").matches("free/odeint_rk4"));
    EXPECT_TRUE(Pattern("dopri(5|853)|[{]x").matches("odeint_dopri853"));
    EXPECT_TRUE(Pattern("duration=[0-9]{1,3}\\.5,").matches("symmetric{/duration=12.5,/body/mass=2}"));
    EXPECT_TRUE(Pattern("^[+*(?]{1,3}$").matches("(+"));
    EXPECT_TRUE(Pattern("[]a].*[[:digit:](]{2}.*x?y*z+$").matches("]_2(z"));
    EXPECT_TRUE(Pattern("x{1000}").matches(std::string(1000, 'x')));
    EXPECT_TRUE(Pattern("\\{/duration=(1|2)\\}").matches("symmetric{/duration=2}"));
}

TEST(Pattern, RefusesWhatIsNoneOrCouldRunAway) {
    const std::string deep(100'000, '(');
    for (const std::string& bad : {std::string("("),
                                   std::string("[a"),
                                   std::string("a{2,1}"),
                                   std::string("*{"),
                                   deep,
                                   std::string(501, 'a'),
                                   std::string(60, '(') + std::string(60, ')'),
                                   std::string("(((a{1,250}){1,250}){1,250}){1,250}"),
                                   std::string("a{32767}"),
                                   "a" + std::string(40, '+'),
                                   ")" + std::string(30, '+') + ")zy)z",
                                   "(a){" + std::string(30, '+'),
                                   std::string("(a{1,40}){30,}"),
                                   std::string("(.*)\\1"),
                                   std::string("a\0b", 3),
                                   std::string("TTt*****{1000}****************H"),
                                   std::string("t*?*?*?*?*?*?*?{350}"),
                                   "a" + std::string(30, '?') + "{1000}",
                                   std::string("((((((((t*)?)*)?)*)?)*)?){300}"),
                                   std::string("(aaaaaaaaaa[[:digit:](]bbbbbbbbbb){100}"),
                                   std::string("[[=a=](]"),
                                   std::string("[[.(.]]")}) {
        try {
            const Pattern pattern(bad);
            ADD_FAILURE() << "accepted: " << bad.substr(0, 60);
        } catch (const std::invalid_argument& error) {
            EXPECT_FALSE(std::string(error.what()).empty());
        }
    }
}

}  // namespace
}  // namespace polhode
