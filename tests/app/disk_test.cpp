// Failing writes: one line on stderr, exit code 1, the old file unchanged.
#include <sys/resource.h>

#include <csignal>

#include "app/program_fixture.h"

namespace polhode {
namespace {

class FullDisk : public Program {
  protected:
    // limits the size of files to `bytes`
    static std::function<void()> room_for(rlim_t bytes) {
        return [bytes] {
            const rlimit limit{bytes, bytes};
            ::setrlimit(RLIMIT_FSIZE, &limit);
        };
    }
    void expect_failed(const Outcome& outcome, const std::string& named) const {
        SCOPED_TRACE(outcome.err);
        EXPECT_EQ(outcome.exit_code, 1);
        EXPECT_EQ(lines(outcome.err), 1);
        EXPECT_EQ(outcome.err.find("polhode: "), 0u);
        EXPECT_NE(outcome.err.find(named), std::string::npos);
    }
    std::vector<std::string> names() const {
        std::vector<std::string> found;
        for (const auto& entry : fs::directory_iterator(directory)) found.push_back(entry.path().filename().string());
        return found;
    }
};

TEST_F(FullDisk, LeavesTheOldFileAsItWas) {
    std::ofstream(directory / "old.csv") << "what was there\n";
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"solve", "free_asymmetric"}, std::vector<std::string>{"truth", "nasa_brick"}}) {
        std::vector<std::string> arguments = command;
        arguments.insert(arguments.end(), {"--output", "old.csv"});
        expect_failed(run(arguments, room_for(1000)), "old.csv: cannot be written: File too large");
        EXPECT_EQ(read(directory / "old.csv"), "what was there\n");
        EXPECT_EQ(names(), std::vector<std::string>{"old.csv"}) << "a temporary file remains";
    }
}

TEST_F(FullDisk, LeavesFinishedCasesAndOldTables) {
    ::setenv("POLHODE_CACHE", (directory / "cache").c_str(), 1);
    ::setenv("TMPDIR", directory.c_str(), 1);
    std::ofstream(directory / "e.json") << R"({"name": "e", "scenes": ["symmetric"], "methods": ["odeint_rk4"],
        "settings": {"steps": [0.5, 0.25, 0.125, 0.1, 0.0625, 0.05, 0.04, 0.03125]}, "vary": {"/duration": [1]}, "samples": 2, "repeats": 1})";
    ASSERT_EQ(run({"run", "e.json", "--output", "out", "--quiet"}).exit_code, 0);
    const std::string table = read(directory / "out/e.csv");
    // a case fits within the limit, the table does not
    expect_failed(run({"run", "e.json", "--output", "out", "--quiet"}, room_for(800)),
                  "e.csv: cannot be written: File too large");
    EXPECT_EQ(read(directory / "out/e.csv"), table);
    // no case fits; stderr, a file here, still has room for one line
    fs::remove_all(directory / "out");
    expect_failed(run({"run", "e.json", "--output", "out", "--quiet"}, room_for(200)), "File too large");
    for (const auto& entry : fs::recursive_directory_iterator(directory / "out"))
        EXPECT_NE(entry.path().extension(), ".csv") << entry.path();
    // without the limit the sweep continues
    EXPECT_EQ(run({"run", "e.json", "--output", "out", "--quiet"}).exit_code, 0);
    ::unsetenv("POLHODE_CACHE"), ::unsetenv("TMPDIR");
}

// stdout on a full disk, and closed stdout
TEST_F(FullDisk, IsToldOfStandardOutput) {
    std::ofstream(directory / "run.csv") << "t,qw,qx,qy,qz\n0,1,0,0,0\n";
    std::ofstream(directory / "e.json") << R"({"name": "e", "scenes": ["symmetric"], "methods": ["odeint_rk4"],
        "settings": {"steps": [0.5]}})";
    const auto full = [] { ::dup2(::open("/dev/full", O_WRONLY), 1); };
    const auto closed = [] { ::close(1); };
    const std::vector<std::vector<std::string>> commands{{"solve", "symmetric"},
                                                         {"truth", "symmetric", "--samples", "1"},
                                                         {"check", "symmetric", "run.csv"},
                                                         {"describe", "symmetric"},
                                                         {"describe", "odeint_rk4"},
                                                         {"list", "scenes"},
                                                         {"list", "methods", "--format", "json"},
                                                         {"run", "e.json", "--dry-run", "--quiet"},
                                                         {"--version"},
                                                         {"solve", "--help"}};
    for (const auto& command : commands) {
        const Outcome on_full = run(command, full);
        SCOPED_TRACE(testing::PrintToString(command));
        EXPECT_EQ(on_full.exit_code, 1);
        EXPECT_NE(on_full.err.find("stdout cannot be written: No space left on device"), std::string::npos)
            << on_full.err;
        const Outcome on_closed = run(command, closed);
        EXPECT_EQ(on_closed.exit_code, 1) << on_closed.err;
        EXPECT_NE(on_closed.err.find("stdout cannot be written"), std::string::npos) << on_closed.err;
    }
}

}  // namespace
}  // namespace polhode
