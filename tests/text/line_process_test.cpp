#include "text/line_process.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace polhode {
namespace {

using namespace std::chrono_literals;

std::vector<std::string> script(const std::string& text) { return {"sh", "-c", text}; }

TEST(LineProcess, AnswersLineByLine) {
    LineProcess echo(script("echo hello >&3; while read -r line; do echo \"<$line>\" >&3; done"));
    EXPECT_EQ(echo.next(10s).line, "hello");
    EXPECT_EQ(echo.ask("one", 10s).line, "<one>");
    EXPECT_EQ(echo.ask("{\"two\": [1, 2]}", 10s).line, "<{\"two\": [1, 2]}>");
    EXPECT_TRUE(echo.is_alive());
}

// Output of the program on stdout and stderr is not taken for an answer.
TEST(LineProcess, ChatterIsNoAnswer) {
    LineProcess chatty(script("while read -r line; do echo chatter; echo noise >&2; echo answer >&3; done"));
    for (int i = 0; i < 3; ++i) EXPECT_EQ(chatty.ask("question", 10s).line, "answer");
}

TEST(LineProcess, LongLinesGoBothWays) {
    LineProcess echo(script("while read -r line; do echo \"$line\" >&3; done"));
    const std::string longer(1'000'000, 'x');
    EXPECT_EQ(echo.ask(longer, 60s).line, longer);
    EXPECT_EQ(echo.ask(longer, 60s).line.size(), longer.size());
}

TEST(LineProcess, ReportsHowItEnded) {
    const auto fault = [](const std::string& text) {
        LineProcess process(script(text));
        const LineAnswer answer = process.ask("question", 10s);
        EXPECT_FALSE(process.is_alive());
        EXPECT_EQ(process.ask("again", 10s).fault, answer.fault);
        return answer.fault;
    };
    EXPECT_EQ(fault("read -r line; echo out of order >&2; exit 3"), "sh exited with code 3: out of order");
    EXPECT_EQ(fault("read -r line; kill -9 $$"), "sh was terminated by signal 9");
    EXPECT_EQ(fault("read -r line; exit 0"), "sh exited without an answer");
}

TEST(LineProcess, StopsAHangAtItsTimeLimit) {
    const auto begin = std::chrono::steady_clock::now();
    LineProcess hanging(script("read -r line; sleep 600"));
    const LineAnswer answer = hanging.ask("question", 200ms);
    EXPECT_TRUE(answer.timed_out);
    EXPECT_EQ(answer.fault, "sh was stopped: it did not answer within 0.2 s");
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 20s);
}

TEST(LineProcess, ReportsAMissingProgram) {
    LineProcess none({"/no/such/program"});
    const LineAnswer answer = none.next(1s);
    EXPECT_TRUE(answer.not_found);
    EXPECT_EQ(answer.fault, "/no/such/program was not found");
    EXPECT_EQ(LineProcess({}).next(1s).fault, "no program is given");
}

// Descriptors are closed, also those of processes that failed.
TEST(LineProcess, LeavesNothingOpen) {
    const auto open = [] {
        return std::distance(std::filesystem::directory_iterator("/proc/self/fd"),
                             std::filesystem::directory_iterator());
    };
    const auto before = open();
    for (int i = 0; i < 20; ++i) {
        LineProcess process(script("read -r line; echo answer >&3"));
        EXPECT_EQ(process.ask("question", 10s).line, "answer");
        LineProcess none({"/no/such/program"});
    }
    EXPECT_EQ(open(), before);
}

}  // namespace
}  // namespace polhode
