// Runs the program in a temporary directory and returns its exit code and output.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "places.h"

namespace polhode {

namespace fs = std::filesystem;

struct Outcome {
    int exit_code;  ///< -1 if a signal ended it
    std::string out, err;
    double seconds;  ///< processor time, which does not depend on other processes
};

inline std::string read(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
}

// Removes from stderr the notice that `check` prints if the reference takes more than 2 s.
inline std::string without_notice(std::string err) {
    const std::string notice = "polhode: computing the reference; it is cached, and the next check is faster\n";
    if (const auto place = err.find(notice); place != std::string::npos) err.erase(place, notice.size());
    return err;
}

inline long lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

class Program : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "polhode-XXXXXX").string();
        ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
        directory = pattern;
    }
    void TearDown() override { fs::remove_all(directory); }

    // Runs the program in `directory`. Its output goes to files next to it, so that it cannot block. `prepare` is
    // called first in the new process.
    Outcome run(std::vector<std::string> arguments, const std::function<void()>& prepare = {}) const {
        const std::string out = directory.string() + ".out", err = directory.string() + ".err";
        arguments.insert(arguments.begin(), "polhode");
        std::vector<char*> argv;
        for (std::string& argument : arguments) argv.push_back(argument.data());
        argv.push_back(nullptr);
        const pid_t child = ::fork();
        if (child == 0) {
            const int o = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
            const int e = ::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
            if (::chdir(directory.c_str()) != 0) ::_exit(99);
            ::dup2(o, 1), ::dup2(e, 2);
            if (prepare) prepare();
            ::execv(program_path().c_str(), argv.data());
            ::_exit(98);
        }
        int status = 0;
        rusage used{};
        ::wait4(child, &status, 0, &used);
        const double seconds = static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
                               1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
        Outcome outcome{WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(out), read(err), seconds};
        fs::remove(out), fs::remove(err);
        return outcome;
    }

    void expect_refused(const std::vector<std::string>& arguments, const std::string& named) const {
        const Outcome outcome = run(arguments);
        SCOPED_TRACE(testing::PrintToString(arguments) + "\n" + outcome.err);
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_EQ(outcome.out, "");
        EXPECT_EQ(lines(outcome.err), 1);
        EXPECT_EQ(outcome.err.find("polhode: "), 0u);
        EXPECT_NE(outcome.err.find(named), std::string::npos) << "wanted: " << named;
        EXPECT_TRUE(fs::is_empty(directory)) << "a file was written";
    }

    fs::path directory;
};

}  // namespace polhode
