// Which files an input file may refer to, and which kinds of files may be opened.
#include "text/named_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "text/message.h"
#include "text/printable.h"

namespace polhode {
namespace {

class NamedFile : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (std::filesystem::temp_directory_path() / "polhode-XXXXXX").string();
        ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
        top = std::filesystem::canonical(pattern);
        std::filesystem::create_directories(top / "mine/sub"), std::filesystem::create_directory(top / "mine_too");
        std::ofstream(top / "mine/sub/a") << "within";
        std::ofstream(top / "mine_too/b") << "outside";
        std::filesystem::create_symlink(top / "mine_too/b", top / "mine/out");
        std::filesystem::create_symlink("sub/a", top / "mine/in");
        std::filesystem::create_symlink("circle", top / "mine/circle");
        ::mkfifo((top / "mine/fifo").c_str(), 0600);
    }
    void TearDown() override {
        allow_outside_files(false);
        std::filesystem::remove_all(top);
    }
    std::string text(const std::string& name) const { return read_named_text(folder(), name, 10, "a text"); }
    std::string fault(const std::string& name) const {
        try {
            text(name);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    }
    std::string folder() const { return (top / "mine").string(); }
    std::filesystem::path top;
};

TEST_F(NamedFile, ReadsFilesInTheDirectory) {
    for (const char* name : {"sub/a", "./sub/../sub/a", "in", "sub/../in"}) EXPECT_EQ(text(name), "within") << name;
}

// the name of the second folder starts with the name of the first
TEST_F(NamedFile, RefusesPathsOutsideTheDirectory) {
    const std::string absolute = (top / "mine_too/b").string(), own = (top / "mine/sub/a").string();
    for (const std::string& name : {std::string("../mine_too/b"), std::string("sub/../../mine_too/b"),
                                    std::string("out"), absolute, own, std::string("/etc/passwd")})
        EXPECT_NE(fault(name).find("is outside the folder"), std::string::npos) << name << ": " << fault(name);
    allow_outside_files(true);
    for (const std::string& name : {std::string("../mine_too/b"), std::string("out"), absolute})
        EXPECT_EQ(text(name), "outside") << name;
}

TEST_F(NamedFile, IsARegularFileOfBoundedSize) {
    EXPECT_NE(fault("fifo").find("is a FIFO"), std::string::npos);
    EXPECT_NE(fault("circle").find("Too many levels of symbolic links"), std::string::npos);
    EXPECT_NE(fault("sub").find("Is a directory"), std::string::npos);
    EXPECT_NE(fault("missing").find("No such file"), std::string::npos);
    EXPECT_NE(fault(std::string("sub/a\0b", 7)).find("zero byte"), std::string::npos);
    allow_outside_files(true);
    EXPECT_NE(fault("/dev/zero").find("is a device"), std::string::npos);
    EXPECT_NE(fault("/dev/null").find("is a device"), std::string::npos);
    std::ofstream(top / "mine/ten") << "0123456789";
    EXPECT_EQ(text("ten"), "0123456789");
    std::ofstream(top / "mine/ten", std::ios::app) << "x";
    EXPECT_NE(fault("ten").find("larger than 10 bytes"), std::string::npos);
}

TEST(Printable, IsWhatDoesNothingToATerminal) {
    EXPECT_EQ(first_unprintable("a\n\t\r\xc3\xa9\xf0\x9f\x8e\xb2 b"), std::string_view::npos);
    for (const char* text : {"a\x1b", "a\x7f", "a\xc2\x9b", "a\xc2\x85", "a\xe2\x80\xae", "a\xe2\x81\xa6", "a\xd8\x9c",
                             "a\xe2\x80\xa8", "a\xff", "a\xc2", "a\x01"})
        EXPECT_EQ(first_unprintable(text), 1u) << text;
    EXPECT_EQ(first_unprintable(std::string_view("\0", 1)), 0u);
}

}  // namespace
}  // namespace polhode
