#include "text/child_process.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <string>
#include <thread>

namespace polhode {
namespace {

TEST(ChildProcess, ReadsItsInputAndGivesItsOutput) {
    const std::string text = std::string(300'000, 'x') + '\0' + "end";
    const ChildRun run = run_child({"cat"}, text);
    EXPECT_EQ(run.fault, "");
    EXPECT_EQ(run.output, text);
    EXPECT_GT(run.seconds, 0);
}

TEST(ChildProcess, PassesArgumentsUnchanged) {
    EXPECT_EQ(run_child({"printf", "%s|", "a b", "$HOME", "*", ""}, "").output, "a b|$HOME|*||");
}

// the input exceeds the pipe's capacity and is never read
TEST(ChildProcess, NeedNotReadItsInput) { EXPECT_EQ(run_child({"true"}, std::string(1 << 20, 'x')).fault, ""); }

TEST(ChildProcess, QuotesTheLastLineOfItsOutput) {
    EXPECT_EQ(run_child({"sh", "-c", "echo one >&2; printf 'two\\033\\n\\n' >&2; exit 7"}, "").fault,
              "sh exited with code 7: two\\x1b");
    EXPECT_EQ(run_child({"sh", "-c", "echo all is well >&2"}, "").fault, "");
}

TEST(ChildProcess, ReportsAMissingProgram) {
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{"no-such-program"}, {""}, {}}) {
        const ChildRun run = run_child(arguments, "");
        EXPECT_TRUE(run.not_found);
        EXPECT_NE(run.fault, "");
    }
    EXPECT_EQ(run_child({"/"}, "").fault, "/ could not be started: Permission denied");
}

TEST(ChildProcess, KillsWhatItHasLeftBehind) {
    const ChildRun run = run_child({"sh", "-c", "sleep 60 & echo $!"}, "");
    ASSERT_EQ(run.fault, "");
    const pid_t left = std::stoi(run.output);
    // a killed process remains a zombie until its new parent has waited for it
    const auto is_running = [left] {
        const ChildRun state = run_child({"sh", "-c", "cut -d' ' -f3 /proc/" + std::to_string(left) + "/stat"}, "");
        return !state.output.empty() && state.output[0] != 'Z' && state.output[0] != 'X';
    };
    for (int tries = 0; tries < 100 && is_running(); ++tries)
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_FALSE(is_running());
}

TEST(ChildProcess, EndsAtItsLimits) {
    const ChildRun slow = run_child({"sleep", "60"}, "", {.time = std::chrono::milliseconds(200)});
    EXPECT_TRUE(slow.timed_out);
    EXPECT_EQ(slow.fault, "sleep was stopped after 0.2 s");
    const ChildRun endless = run_child({"yes"}, "", {.output_bytes = 100'000});
    EXPECT_FALSE(endless.timed_out);
    EXPECT_EQ(endless.fault, "yes was stopped: it wrote more than 100000 bytes");
}

// Messages contain no folder names of the machine, since results are published.
TEST(ProgramName, HasNoFolders) {
    EXPECT_EQ(program_name("/usr/bin/engine"), "engine");
    EXPECT_EQ(program_name("./engine"), "engine");
    EXPECT_EQ(program_name("engine"), "engine");
    EXPECT_EQ(program_name("folder/"), "folder/");
    EXPECT_EQ(run_child({"/bin/sh", "-c", "exit 3"}, "").fault, "sh exited with code 3");
}

}  // namespace
}  // namespace polhode
