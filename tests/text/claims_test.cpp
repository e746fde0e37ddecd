#include "text/claims.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <string>

namespace polhode {
namespace {

class ClaimsOfProcesses : public ::testing::Test {
  protected:
    ClaimsOfProcesses() : path_((std::filesystem::path(::testing::TempDir()) / "polhode_claims_test").string()) {}
    ~ClaimsOfProcesses() override { std::filesystem::remove(path_); }

    // Starts a process that takes the claim and keeps it until it is killed. It holds the claim when this returns.
    pid_t holder(const std::string& key) const {
        int ready[2];
        if (::pipe(ready) != 0) return -1;
        const pid_t child = ::fork();
        if (child == 0) {
            const Claims claims(path_);
            const auto claim = claims.take(key);
            const char word = claim ? 'y' : 'n';
            if (::write(ready[1], &word, 1) != 1) ::_exit(1);
            for (;;) ::pause();
        }
        char word = 0;
        EXPECT_EQ(::read(ready[0], &word, 1), 1);
        EXPECT_EQ(word, 'y');
        ::close(ready[0]), ::close(ready[1]);
        return child;
    }

    const std::string path_;
};

TEST_F(ClaimsOfProcesses, OneProcessHoldsAKeyUntilItEnds) {
    const pid_t other = holder("a");
    const Claims claims(path_);
    EXPECT_FALSE(claims.take("a"));
    EXPECT_TRUE(claims.take("b"));
    ::kill(other, SIGKILL);
    ::waitpid(other, nullptr, 0);
    // the file still exists, and no process holds the claim
    EXPECT_TRUE(std::filesystem::exists(path_));
    EXPECT_TRUE(claims.take("a"));
}

TEST_F(ClaimsOfProcesses, AClaimEndsWithItsLife) {
    const Claims claims(path_), others(path_);
    {
        std::optional<Claims::Claim> claim = claims.take("a");
        ASSERT_TRUE(claim);
        EXPECT_FALSE(others.take("a"));
        const std::optional<Claims::Claim> moved = std::move(claim);
        EXPECT_FALSE(others.take("a"));
        EXPECT_TRUE(others.take("b"));
    }
    EXPECT_TRUE(others.take("a"));
}

TEST_F(ClaimsOfProcesses, AFileThatCannotBeIsNoObstacle) {
    const Claims claims("/no/such/folder/claims");
    EXPECT_TRUE(claims.take("a"));
}

}  // namespace
}  // namespace polhode
