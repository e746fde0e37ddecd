// A sweep killed at random moments, again and again: no torn file, no finished case lost or changed, and in the end the
// table of a sweep that nobody disturbed.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "build_kind.h"
#include "experiment/run/case_store.h"
#include "integrators/truth/cache.h"
#include "table/table.h"

namespace polhode {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr int kills = optimised_build ? 50 : 5;
constexpr int groups = 4;  // 200 kills in all

constexpr const char* experiment = R"({
    "name": "killed", "scenes": ["free_asymmetric", "symmetric"],
    "methods": ["odeint_rk4", "odeint_dopri5", "cvode_adams"],
    "settings": {"steps": [0.1, 0.05, 0.025, 0.0125], "tolerances": [1e-3, 1e-5, 1e-7, 1e-9]},
    "vary": {"/duration": [0.5, 0.75, 1]}, "samples": 5, "repeats": 1
})";
constexpr std::size_t cases = 96;  // 6 scenes; rk4 by step, dopri5 by step and by tolerance, cvode_adams by tolerance

std::string read(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
}

// a result table without its times
std::string lasting(const std::string& text) {
    const Table table = parse_csv(text);
    std::vector<ColumnChoice> kept;
    for (const std::string& column : table.columns)
        if (!column.starts_with("seconds")) kept.push_back({column, column});
    return csv(select(table, kept));
}

class Killed : public ::testing::TestWithParam<int> {
  protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "polhode-kill-XXXXXX").string();
        ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
        directory_ = pattern;
        std::ofstream(directory_ / "killed.json") << experiment;
    }
    void TearDown() override { fs::remove_all(directory_); }

    fs::path results() const { return directory_ / "results"; }

    // Runs the sweep; kills it after `limit`, where one is given. The wait status.
    int run(std::optional<Seconds> limit = {}) const {
        const pid_t child = ::fork();
        if (child == 0) {
            // locks and truths of its own, so that nothing else on the machine is waited for or used
            ::setenv("TMPDIR", directory_.c_str(), 1);
            ::setenv("POLHODE_CACHE", (directory_ / "cache").c_str(), 1);
            if (::chdir(directory_.c_str()) != 0) ::_exit(99);
            const int log = ::open("log", O_WRONLY | O_CREAT | O_TRUNC, 0600);
            ::dup2(log, 1), ::dup2(log, 2);
            ::execl(POLHODE_PROGRAM, "polhode", "run", "killed.json", "--output", "results", "--quiet", nullptr);
            ::_exit(98);
        }
        if (limit) {
            std::this_thread::sleep_for(*limit);
            ::kill(child, SIGKILL);
        }
        int status = 0;
        ::waitpid(child, &status, 0);
        return status;
    }

    // The finished cases by name; every file that is there must be whole.
    std::map<std::string, std::string> finished() const {
        std::map<std::string, std::string> found;
        for (const auto& entry : files(results() / ".cases")) {
            const std::string name = entry.filename().string();
            if (!name.ends_with(".csv")) continue;
            const std::string key = entry.stem().string();
            EXPECT_TRUE(load_case(results().string(), key)) << "torn: " << entry;
            found[key] = read(entry);
        }
        return found;
    }

    void expect_whole_tables() const {
        const std::map<std::string, std::string> last_words{
            {".md", "|\n"}, {".tex", "\\endgroup\n"}, {".svg", "</svg>"}, {".pdf", "%%EOF"}};
        for (const auto& path : files(results())) {
            const std::string ending = path.extension().string(), text = read(path);
            SCOPED_TRACE(path);
            if (ending == ".csv") {
                EXPECT_FALSE(parse_csv(text).rows.empty());
            } else if (ending == ".json") {
                EXPECT_TRUE(nlohmann::json::accept(text));
            } else if (const auto last = last_words.find(ending); last != last_words.end()) {
                EXPECT_NE(text.rfind(last->second), std::string::npos);
            }
        }
        for (const auto& path : files(directory_ / "cache")) {
            if (path.extension() != ".txt") continue;
            const std::string key = path.stem().string().substr(std::string("truth-").size());
            EXPECT_TRUE(truth::decode(key, read(path))) << "torn: " << path;
        }
    }

    static std::vector<fs::path> files(const fs::path& place) {
        std::vector<fs::path> found;
        if (!fs::exists(place)) return found;
        for (const auto& entry : fs::directory_iterator(place))
            if (entry.is_regular_file()) found.push_back(entry.path());
        return found;
    }

    fs::path directory_;
};

TEST_P(Killed, LosesNothing) {
    const auto start = Clock::now();
    ASSERT_EQ(run(), 0) << read(directory_ / "log");
    const double whole_run = Seconds(Clock::now() - start).count();
    const std::string undisturbed = lasting(read(results() / "killed.csv"));
    ASSERT_EQ(finished().size(), cases);
    const auto begin_anew = [&] { fs::remove_all(results()), fs::remove_all(directory_ / "cache"); };
    begin_anew();

    std::mt19937 random(static_cast<unsigned>(GetParam()));
    std::uniform_real_distribution<double> moment(0, 0.25 * whole_run);
    std::map<std::string, std::string> before;
    std::size_t largest_gain = 0, ends = 0;
    // until it was killed at work, not only before: a few kills may all come too early
    for (int killed = 0; killed < kills || (largest_gain == 0 && killed < 20 * kills);) {
        const int status = run(Seconds(moment(random)));
        const bool was_killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
        ASSERT_TRUE(was_killed || status == 0) << status << "\n" << read(directory_ / "log");
        const std::map<std::string, std::string> now = finished();
        for (const auto& [key, text] : before) {
            const auto there = now.find(key);
            ASSERT_TRUE(there != now.end()) << "a finished case is lost: " << key;
            EXPECT_EQ(there->second, text) << "a finished case was run again: " << key;
        }
        expect_whole_tables();
        largest_gain = std::max(largest_gain, now.size() - before.size());
        before = now;
        if (was_killed) {
            ++killed;
        } else {
            ++ends;
            EXPECT_EQ(lasting(read(results() / "killed.csv")), undisturbed);
            begin_anew(), before.clear();
        }
    }
    ASSERT_EQ(run(), 0) << read(directory_ / "log");
    EXPECT_EQ(lasting(read(results() / "killed.csv")), undisturbed);
    // a few kills may all come before the first case is done
    if (optimised_build) {
        EXPECT_GT(largest_gain, 0u);
    }
    RecordProperty("runs_to_the_end", static_cast<int>(ends));
}

INSTANTIATE_TEST_SUITE_P(Sweeps, Killed, ::testing::Range(0, groups));

}  // namespace
}  // namespace polhode
