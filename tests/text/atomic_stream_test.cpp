#include "text/atomic_stream.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace polhode {
namespace {

namespace fs = std::filesystem;

class AtomicStreams : public ::testing::Test {
  protected:
    AtomicStreams() {
        std::string pattern = (fs::temp_directory_path() / "polhode_stream_XXXXXX").string();
        directory_ = mkdtemp(pattern.data());
    }
    ~AtomicStreams() override { fs::remove_all(directory_); }

    std::string path(const std::string& name) const { return (directory_ / name).string(); }
    static std::string content(const std::string& path) {
        std::ostringstream text;
        text << std::ifstream(path, std::ios::binary).rdbuf();
        return text.str();
    }
    std::size_t entries() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(directory_), fs::directory_iterator()));
    }

    fs::path directory_;
};

TEST_F(AtomicStreams, IsThereWholeOrNotAtAll) {
    std::ofstream(path("f")) << "old";
    ::chmod(path("f").c_str(), 0640);
    const std::string piece(10'000'000, 'x');
    {
        AtomicStream given_up(path("f"));
        given_up.write(piece);
        EXPECT_EQ(content(path("f")), "old");
        EXPECT_EQ(entries(), 2u);
    }
    EXPECT_EQ(entries(), 1u);
    {
        AtomicStream stream(path("f"));
        EXPECT_TRUE(stream.is_regular());
        stream.write("12345");
        for (int i = 0; i < 4; ++i) stream.write(piece);
        stream.write_over_beginning("abc");
        EXPECT_THROW(stream.write_over_beginning(std::string(50'000'000, 'x')), std::logic_error);
        stream.write("end");
        EXPECT_EQ(content(path("f")), "old");
        stream.commit();
        EXPECT_EQ(content(path("f")), "abc45" + piece + piece + piece + piece + "end");
    }
    EXPECT_EQ(entries(), 1u);
    struct stat status {};
    ::stat(path("f").c_str(), &status);
    EXPECT_EQ(status.st_mode & 0777u, 0640u);
}

TEST_F(AtomicStreams, FollowsALink) {
    std::ofstream(path("f")) << "old";
    fs::create_symlink("f", path("link"));
    AtomicStream stream(path("link"));
    stream.write("new");
    stream.commit();
    EXPECT_TRUE(fs::is_symlink(path("link")));
    EXPECT_EQ(content(path("f")), "new");
    EXPECT_EQ(entries(), 2u);
}

TEST_F(AtomicStreams, NamesPathAndReason) {
    const auto fault = [](const std::string& path) -> std::string {
        try {
            AtomicStream stream(path);
            stream.write(std::string(1 << 20, 'x'));
            stream.commit();
        } catch (const std::runtime_error& error) {
            return error.what();
        }
        return "none";
    };
    EXPECT_EQ(fault(path("none/f")), path("none/f") + ": cannot be created: No such file or directory");
    EXPECT_EQ(fault(directory_.string()), directory_.string() + ": cannot be written: Is a directory");
    EXPECT_EQ(fault("/dev/full"), "/dev/full: cannot be written: No space left on device");
    EXPECT_EQ(fault("/dev/null"), "none");
    EXPECT_EQ(entries(), 0u);
    // limit on the file size
    rlimit old{};
    ::getrlimit(RLIMIT_FSIZE, &old);
    const rlimit small{1 << 16, old.rlim_max};
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    ::setrlimit(RLIMIT_FSIZE, &small);
    EXPECT_EQ(fault(path("f")), path("f") + ": cannot be written: File too large");
    ::setrlimit(RLIMIT_FSIZE, &old);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(entries(), 0u);
}

}  // namespace
}  // namespace polhode
