#include "text/terminal.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>

namespace polhode {
namespace {

// replaces the standard streams by a pseudo-terminal and a file
class Terminal : public ::testing::Test {
  protected:
    void SetUp() override {
        master_ = ::posix_openpt(O_RDWR | O_NOCTTY);
        ASSERT_GE(master_, 0);
        ASSERT_EQ(::grantpt(master_) | ::unlockpt(master_), 0);
        terminal = ::open(::ptsname(master_), O_RDWR | O_NOCTTY);
        file = ::open("/dev/null", O_WRONLY);
        ASSERT_GE(terminal, 0);
        ::unsetenv("NO_COLOR");
        ::setenv("TERM", "xterm", 1);
    }
    void TearDown() override { ::close(terminal), ::close(file), ::close(master_); }

    int terminal = -1, file = -1;

  private:
    int master_ = -1;
};

TEST_F(Terminal, HasColorsUnlessTheyAreRefused) {
    EXPECT_TRUE(wants_color(terminal));
    EXPECT_FALSE(wants_color(file));
    ::setenv("NO_COLOR", "", 1);
    EXPECT_TRUE(wants_color(terminal)) << "an empty value refuses nothing";
    ::setenv("NO_COLOR", "1", 1);
    EXPECT_FALSE(wants_color(terminal));
    ::unsetenv("NO_COLOR");
    ::setenv("TERM", "dumb", 1);
    EXPECT_FALSE(wants_color(terminal));
    ::unsetenv("TERM");
    EXPECT_FALSE(wants_color(terminal));
}

TEST_F(Terminal, ReportsItsWidth) {
    winsize size{};
    size.ws_row = 30, size.ws_col = 77;
    ASSERT_EQ(::ioctl(terminal, TIOCSWINSZ, &size), 0);
    EXPECT_EQ(terminal_width(terminal, 100), 77);
    EXPECT_EQ(terminal_width(file, 100), 100);
    size.ws_col = 0;
    ASSERT_EQ(::ioctl(terminal, TIOCSWINSZ, &size), 0);
    EXPECT_EQ(terminal_width(terminal, 100), 100);
}

}  // namespace
}  // namespace polhode
