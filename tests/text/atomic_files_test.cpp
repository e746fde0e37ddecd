#include "text/atomic_files.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>

namespace polhode {
namespace {

namespace fs = std::filesystem;

class AtomicFilesTest : public ::testing::Test {
  protected:
    AtomicFilesTest() {
        std::string pattern = (fs::temp_directory_path() / "polhode_files_XXXXXX").string();
        folder_ = mkdtemp(pattern.data());
    }
    ~AtomicFilesTest() override { fs::remove_all(folder_); }

    std::string content(const std::string& name) const {
        std::ostringstream text;
        text << std::ifstream(folder_ / name, std::ios::binary).rdbuf();
        return text.str();
    }
    std::set<std::string> names() const {
        std::set<std::string> found;
        for (const auto& entry : fs::directory_iterator(folder_)) found.insert(entry.path().filename());
        return found;
    }

    fs::path folder_;
};

TEST_F(AtomicFilesTest, CommitCreatesExactlyTheFiles) {
    // more than the 1024 files synced at once; one of them exists already with a mode other than the default
    std::ofstream(folder_ / "7") << "old";
    fs::permissions(folder_ / "7", fs::perms::owner_read | fs::perms::owner_write);
    AtomicFiles files(folder_);
    std::set<std::string> wanted;
    for (int i = 0; i < 1100; ++i) {
        const std::string name = std::to_string(i);
        files.add(name, "file " + name + std::string(static_cast<std::size_t>(i), '.'));
        wanted.insert(name);
    }
    files.commit();
    EXPECT_EQ(names(), wanted);
    for (int i = 0; i < 1100; ++i)
        EXPECT_EQ(content(std::to_string(i)),
                  "file " + std::to_string(i) + std::string(static_cast<std::size_t>(i), '.'));
    struct stat properties {};
    ASSERT_EQ(::stat((folder_ / "7").c_str(), &properties), 0);
    EXPECT_EQ(properties.st_mode & 07777, 0600U);
}

TEST_F(AtomicFilesTest, WithoutCommitNothingIsThere) {
    std::ofstream(folder_ / "old") << "old";
    {
        AtomicFiles files(folder_);
        files.add("old", "new");
        files.add("another", "new");
    }
    EXPECT_EQ(names(), std::set<std::string>{"old"});
    EXPECT_EQ(content("old"), "old");
}

TEST_F(AtomicFilesTest, ReportsFailedWritesAndLeavesNoTemporary) {
    fs::create_directory(folder_ / "folder");
    AtomicFiles files(folder_);
    files.add("a", "text");
    EXPECT_THROW(files.add("folder", "text"), std::runtime_error);
    AtomicFiles nowhere((folder_ / "missing").string());
    try {
        nowhere.add("a", "text");
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_EQ(std::string(error.what()),
                  (folder_ / "missing" / "a").string() + ": cannot be created: No such file or directory");
    }
    files.commit();
    EXPECT_EQ(names(), (std::set<std::string>{"a", "folder"}));
}

}  // namespace
}  // namespace polhode
