#include "text/message.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace polhode {
namespace {

TEST(OneLine, EscapesWhatWouldBreakATerminalsLine) {
    EXPECT_EQ(one_line("plain é 語 😀", 100), "plain é 語 😀");
    EXPECT_EQ(one_line("a\nb\tc\rd", 100), "a\\nb\\tc\\rd");
    EXPECT_EQ(one_line(std::string("\0\x1b\x7f", 3), 100), "\\x00\\x1b\\x7f");
    EXPECT_EQ(one_line("\xc2\x85 \xe2\x80\xa8 \xe2\x80\xae", 100), "\\u0085 \\u2028 \\u202e");
    EXPECT_EQ(one_line("\xff\xc3", 100), "\\xff\\xc3");
}

TEST(OneLine, ShortensTheMiddleBetweenCharacters) {
    EXPECT_EQ(one_line("0123456789abcdef", 9), "0123...ef");
    EXPECT_EQ(one_line("ééééééééé", 9), "éé...é");
}

RC_GTEST_PROP(OneLine, IsOneShortLineOfUtf8WhateverTheBytes, (const std::string& bytes)) {
    const std::string line = one_line(bytes, 40);
    RC_ASSERT(line.size() <= 40u);
    RC_ASSERT(first_invalid_utf8(line) == std::string::npos);
    for (const char c : line) RC_ASSERT(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f);
}

// the limits of RFC 3629's table of well-formed sequences and their invalid neighbours
TEST(Utf8, FindsTheFirstInvalidByte) {
    for (const char* valid : {"", "a", "\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf", "\xee\x80\x80",
                              "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"})
        EXPECT_EQ(first_invalid_utf8(valid), std::string::npos);
    for (const char* invalid : {"\x80", "\xc0\xaf", "\xc1\xbf", "\xc2", "\xc2 ", "\xe0\x9f\xbf", "\xed\xa0\x80",
                                "\xe2\x82", "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xff"})
        EXPECT_EQ(first_invalid_utf8(std::string("ab") + invalid), 2u);
}

TEST(NearMisses, FindsTypingErrors) {
    const std::vector<std::string> names{"cvode_adams", "cvode_bdf", "odeint_rk4", "odeint_dopri5", "exact"};
    EXPECT_EQ(near_misses("cvode_adam", names), std::vector<std::string>{"cvode_adams"});
    EXPECT_EQ(near_misses("odeint_rk", names), std::vector<std::string>{"odeint_rk4"});
    EXPECT_EQ(near_misses("rk4", names), std::vector<std::string>{"odeint_rk4"});
    EXPECT_TRUE(near_misses("zzz", names).empty());
    EXPECT_TRUE(near_misses("", names).empty());
    EXPECT_EQ(did_you_mean("exatc", names), "did you mean exact?");
}

}  // namespace
}  // namespace polhode
