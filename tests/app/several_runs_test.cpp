// Several runs in one directory, also with file systems without locks and with clocks that run backwards.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "app/program_fixture.h"
#include "build_kind.h"
#include "places.h"
#include "table/table.h"
#include "text/claims.h"

namespace polhode {
namespace {

constexpr const char* shared_experiment = R"({
    "name": "shared", "scenes": ["free_asymmetric", "symmetric"], "methods": ["odeint_rk4", "cvode_adams"],
    "settings": {"steps": [0.1, 0.05], "tolerances": [1e-3, 1e-6]},
    "vary": {"/duration": [0.5, 1]}, "samples": 5, "repeats": 1
})";
constexpr long shared_cases = 16;

class SeveralRuns : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        std::ofstream(directory / "shared.json") << shared_experiment;
    }

    // Starts `polhode run` with standard error redirected to `log`.
    pid_t start(const std::string& output, const std::string& log,
                const std::vector<std::pair<std::string, std::string>>& environment = {}) const {
        const std::string path = (directory / log).string();
        const pid_t child = ::fork();
        if (child != 0) return child;
        if (::chdir(directory.c_str()) != 0) ::_exit(99);
        const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        ::dup2(file, 1), ::dup2(file, 2);
        ::setenv("TMPDIR", directory.c_str(), 1);
        ::setenv("POLHODE_CACHE", (directory / "cache").c_str(), 1);
        for (const auto& [name, value] : environment) ::setenv(name.c_str(), value.c_str(), 1);
        ::execl(program_path().c_str(), "polhode", "run", "shared.json", "--output", output.c_str(), nullptr);
        ::_exit(98);
    }
    static int code_of(pid_t child) {
        int status = 0;
        ::waitpid(child, &status, 0);
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    std::string log(const std::string& name) const { return read(directory / name); }

    // "16 rows in results, 9 run now": 9
    long run_now(const std::string& name) const {
        const std::string text = log(name);
        const std::size_t end = text.find(" run now"), begin = text.rfind(' ', end - 1);
        EXPECT_NE(end, text.npos) << text;
        return end == text.npos ? -1 : std::atol(text.c_str() + begin);
    }
    // the table of a directory without columns of times
    std::string rows(const std::string& output) const {
        const Table table = parse_csv(read(directory / output / "shared.csv"));
        std::vector<ColumnChoice> kept;
        for (const std::string& column : table.columns)
            if (!column.starts_with("seconds")) kept.push_back({column, column});
        return csv(select(table, kept));
    }
    long temporaries() const {
        long count = 0;
        for (const auto& entry : fs::recursive_directory_iterator(directory))
            count += entry.path().extension() == ".new" ? 1 : 0;
        return count;
    }
};

TEST_F(SeveralRuns, InOneFolderShareTheCases) {
    ASSERT_EQ(code_of(start("alone", "log")), 0) << log("log");
    EXPECT_EQ(run_now("log"), shared_cases);
    for (int round = 0; round < (optimised_build ? 3 : 1); ++round) {
        fs::remove_all(directory / "results"), fs::remove_all(directory / "cache");
        std::vector<pid_t> processes;
        for (const char* name : {"log1", "log2", "log3"}) processes.push_back(start("results", name));
        for (const pid_t process : processes) EXPECT_EQ(code_of(process), 0);
        EXPECT_EQ(run_now("log1") + run_now("log2") + run_now("log3"), shared_cases);
        EXPECT_EQ(rows("results"), rows("alone"));
        EXPECT_EQ(temporaries(), 0);
    }
}

TEST_F(SeveralRuns, WhatADeadOneHadClaimedAnotherTakes) {
    const pid_t first = start("results", "log1");
    const auto killed_by = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    // wait until it works on its cases
    while (!fs::exists(directory / "results/.cases/claims") && std::chrono::steady_clock::now() < killed_by)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::kill(first, SIGSTOP);
    const pid_t second = start("results", "log2");
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    ::kill(first, SIGKILL);
    code_of(first);
    EXPECT_EQ(code_of(second), 0) << log("log2");
    EXPECT_EQ(parse_csv(read(directory / "results/shared.csv")).rows.size(), static_cast<std::size_t>(shared_cases));
    // the lock files remain and do not block other runs
    EXPECT_TRUE(fs::exists(directory / "results/.cases/claims"));
    EXPECT_EQ(code_of(start("results", "log3")), 0);
    EXPECT_EQ(run_now("log3"), 0);
    EXPECT_EQ(temporaries(), 0);
}

#ifdef POLHODE_NO_LOCKS
TEST_F(SeveralRuns, GoOnWhereThereAreNoLocks) {
    ASSERT_EQ(code_of(start("alone", "log")), 0);
    const std::vector<std::pair<std::string, std::string>> without{{"LD_PRELOAD", POLHODE_NO_LOCKS}};
    const pid_t first = start("results", "log1", without), second = start("results", "log2", without);
    EXPECT_EQ(code_of(first), 0) << log("log1");
    EXPECT_EQ(code_of(second), 0) << log("log2");
    EXPECT_EQ(rows("results"), rows("alone"));
    for (const char* name : {"log1", "log2"}) {
        const std::string told =
            "results/.cases/claims: cannot be locked: No locks available; continues as if no other";
        const std::size_t at = log(name).find(told);
        EXPECT_NE(at, std::string::npos) << log(name);
        EXPECT_EQ(log(name).find(told, at + 1), std::string::npos) << "reported twice:\n" << log(name);
    }
}

TEST_F(SeveralRuns, AClockThatGoesBackwardsChangesNothing) {
    ASSERT_EQ(code_of(start("alone", "log")), 0);
    const pid_t first = start("results", "log1", {{"LD_PRELOAD", POLHODE_CLOCK_BACKWARDS}});
    EXPECT_EQ(code_of(first), 0) << log("log1");
    EXPECT_EQ(rows("results"), rows("alone"));
    EXPECT_EQ(code_of(start("results", "log2", {{"LD_PRELOAD", POLHODE_CLOCK_BACKWARDS}})), 0);
    EXPECT_EQ(run_now("log2"), 0);
}
#endif

TEST_F(SeveralRuns, FilesFromTheFutureAreAsGoodAsOthers) {
    ASSERT_EQ(code_of(start("results", "log1")), 0);
    const std::string before = rows("results");
    const auto future = fs::file_time_type::clock::now() + std::chrono::hours(24 * 3650);
    for (const auto& entry : fs::recursive_directory_iterator(directory))
        if (entry.is_regular_file()) fs::last_write_time(entry.path(), future);
    EXPECT_EQ(code_of(start("results", "log2")), 0);
    EXPECT_EQ(run_now("log2"), 0);
    EXPECT_EQ(rows("results"), before);
}

TEST_F(SeveralRuns, AnInvalidTmpdirLeavesNoLockInTheWorkingDirectory) {
    EXPECT_EQ(code_of(start("results", "log1", {{"TMPDIR", "/no/such/folder"}})), 0) << log("log1");
    for (const auto& entry : fs::directory_iterator(directory))
        EXPECT_FALSE(entry.path().filename().string().starts_with("polhode-")) << entry.path();
}

}  // namespace
}  // namespace polhode
