// Atomic replacement of files: content, modes, links, failures, and files left by killed processes.
#include "text/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>
#include <stdexcept>

namespace polhode {
namespace {

namespace fs = std::filesystem;

class AtomicFile : public ::testing::Test {
  protected:
    AtomicFile() {
        std::string pattern = (fs::temp_directory_path() / "polhode_atomic_XXXXXX").string();
        directory_ = mkdtemp(pattern.data());
    }
    ~AtomicFile() override { fs::remove_all(directory_); }

    std::string path(const std::string& name) const { return (directory_ / name).string(); }

    static std::string content(const std::string& path) {
        std::ostringstream text;
        text << std::ifstream(path, std::ios::binary).rdbuf();
        return text.str();
    }

    std::size_t entries() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(directory_), fs::directory_iterator()));
    }

    static std::string fault(const std::string& path) {
        try {
            write_atomically(path, "new");
        } catch (const std::runtime_error& error) {
            return error.what();
        }
        return "none";
    }

    fs::path directory_;
};

TEST_F(AtomicFile, ReplacesTheWholeFileAndLeavesNothingElse) {
    const std::string binary("a\0b\r\n\xff", 6), longer(3'000'000, 'x');
    for (const std::string& text : {binary, longer, std::string()}) {
        write_atomically(path("f"), text);
        EXPECT_EQ(content(path("f")), text);
        EXPECT_EQ(entries(), 1u);
    }
}

TEST_F(AtomicFile, NamesPathAndReasonOfAMissingDirectory) {
    const std::string target = path("missing/f"), message = fault(target);
    EXPECT_NE(message.find(target), std::string::npos) << message;
    EXPECT_NE(message.find("No such file or directory"), std::string::npos) << message;
    EXPECT_EQ(entries(), 0u);
}

TEST_F(AtomicFile, KeepsADirectoryInItsPlace) {
    fs::create_directory(path("d"));
    std::ofstream(path("d/inside")) << "old";
    const std::string message = fault(path("d"));
    EXPECT_NE(message.find(path("d")), std::string::npos) << message;
    EXPECT_EQ(content(path("d/inside")), "old");
    EXPECT_EQ(entries(), 1u);  // the temporary file is gone
}

TEST_F(AtomicFile, KeepsTheOldFileWhenTheNewOneDoesNotFit) {
    write_atomically(path("f"), "old");
    // a file size limit simulates a full disk; unlike file permissions it also applies to root
    const auto old_action = std::signal(SIGXFSZ, SIG_IGN);
    rlimit old_limit{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old_limit), 0);
    const rlimit small{1000, old_limit.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    std::string message = "none";
    try {
        write_atomically(path("f"), std::string(5000, 'x'));
    } catch (const std::runtime_error& error) {
        message = error.what();
    }
    setrlimit(RLIMIT_FSIZE, &old_limit);
    std::signal(SIGXFSZ, old_action);
    EXPECT_NE(message.find("File too large"), std::string::npos) << message;
    EXPECT_EQ(content(path("f")), "old");
    EXPECT_EQ(entries(), 1u);
}

TEST_F(AtomicFile, GivesNewFilesTheUsualModeAndKeepsThatOfOldOnes) {
    const mode_t mask = umask(027);
    write_atomically(path("f"), "first");
    umask(mask);
    EXPECT_EQ(fs::status(path("f")).permissions(), fs::perms(0640));
    fs::permissions(path("f"), fs::perms(0604));
    write_atomically(path("f"), "second");
    EXPECT_EQ(fs::status(path("f")).permissions(), fs::perms(0604));
}

TEST_F(AtomicFile, FollowsALink) {
    write_atomically(path("target"), "old");
    fs::create_symlink(path("target"), path("link"));
    write_atomically(path("link"), "new");
    EXPECT_TRUE(fs::is_symlink(path("link")));
    EXPECT_EQ(content(path("target")), "new");
}

TEST_F(AtomicFile, WritesWhatIsNoRegularFileDirectly) {
    EXPECT_EQ(fault("/dev/null"), "none");
    EXPECT_EQ(fault("/dev/full"), "/dev/full: cannot be written: No space left on device");
    EXPECT_FALSE(fs::is_regular_file("/dev/null"));
}

TEST_F(AtomicFile, ReportsUnwritablePathsBeforehand) {
    EXPECT_THROW(require_writable(path("missing/f")), std::runtime_error);
    EXPECT_THROW(require_writable(directory_.string()), std::runtime_error);
    EXPECT_NO_THROW(require_writable(path("f")));
    EXPECT_NO_THROW(require_writable("/dev/null"));
}

// name of the temporary file left behind by a process that was killed while writing
std::string left_by_a_killed_process(const fs::path& directory, const std::string& target) {
    std::set<std::string> before, after;
    const auto names = [&] {
        std::set<std::string> found;
        for (const auto& entry : fs::directory_iterator(directory)) found.insert(entry.path().filename().string());
        return found;
    };
    before = names();
    const std::string text(64 << 20, 'x');
    for (unsigned attempt = 0; attempt < 200; ++attempt) {
        const pid_t child = fork();
        if (child == 0)
            for (;;) write_atomically(target, text);
        usleep(5000 + 100 * attempt);
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        after = names();
        for (const std::string& name : after)
            if (!before.contains(name) && name.ends_with(".new")) return name;
    }
    return "";
}

TEST_F(AtomicFile, WhatDeadProcessesLeftIsRemovedAndNothingElse) {
    const std::string left = left_by_a_killed_process(directory_, path("f.csv"));
    ASSERT_TRUE(left.starts_with("f.csv.")) << left;
    // the name of a temporary file ends in HOST.PROCESS.START.NUMBER
    const std::string start = std::to_string(std::numeric_limits<int>::max());
    const std::size_t host_end = left.find('.', 6);
    const std::string host = left.substr(6, host_end - 6), own = std::to_string(getpid());
    std::ifstream stat("/proc/self/stat");
    std::string word;
    for (int i = 0; i < 22; ++i) stat >> word;  // the process name contains no space
    const std::string living = "g." + host + "." + own + "." + word + ".0.new";
    const std::string reused = "g." + host + "." + own + ".1.0.new";
    const std::string of_another = "g.elsewhere-1." + own + "." + start + ".0.new";
    const std::string old_of_another = "h.elsewhere-1." + own + "." + start + ".0.new";
    const std::string future_of_another = "i.elsewhere-1." + own + "." + start + ".0.new";
    for (const std::string& name : {living, reused, of_another, old_of_another, future_of_another,
                                    std::string("notes.new"), std::string("a.1.2.new"), std::string(".new")})
        std::ofstream(path(name)) << "x";
    const auto now = fs::file_time_type::clock::now();
    fs::last_write_time(path(old_of_another), now - std::chrono::hours(25));
    fs::last_write_time(path(future_of_another), now + std::chrono::hours(1000));
    fs::create_directory(path("within." + host + ".999999999.1.0.new"));
    remove_abandoned(directory_.string());
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(directory_)) names.insert(entry.path().filename().string());
    names.erase("f.csv");
    EXPECT_EQ(names, (std::set<std::string>{living, of_another, future_of_another, "notes.new", "a.1.2.new", ".new",
                                            "within." + host + ".999999999.1.0.new"}));
    remove_abandoned(path("missing"));
}

TEST_F(AtomicFile, WritesUnderTheLongestNames) {
    const std::string name(255, 'n');
    write_atomically(path(name), "text");
    EXPECT_EQ(content(path(name)), "text");
    EXPECT_EQ(entries(), 1u);
}

// after SIGKILL at a random moment the file is either the complete old one or the complete new one
TEST_F(AtomicFile, IsNeverTorn) {
    const std::size_t size = 1 << 20;
    write_atomically(path("f"), std::string(size, 'a'));
    for (unsigned round = 0; round < 20; ++round) {
        const pid_t child = fork();
        ASSERT_GE(child, 0);
        if (child == 0)
            for (char letter = 'b';; letter = letter == 'z' ? 'a' : static_cast<char>(letter + 1))
                write_atomically(path("f"), std::string(size, letter));
        usleep(2000 + 731 * round);
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        const std::string text = content(path("f"));
        ASSERT_EQ(text.size(), size);
        ASSERT_EQ(text, std::string(size, text[0]));
    }
}

}  // namespace
}  // namespace polhode
