#include "text/sealed.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace polhode {
namespace {

TEST(Sealed, GivesBackWhatWasSealed) {
    for (const std::string& text : std::vector<std::string>{"", "a", "a,b\n1,2\n", {"\0\xff\r\n", 4}, "# checksum x\n"})
        EXPECT_EQ(unseal(seal(text)), text);
    EXPECT_EQ(unseal(seal(seal("twice"))), seal("twice"));
}

TEST(Sealed, KeepsTheTextReadable) {
    EXPECT_EQ(seal("a,b\n1,2\n").substr(0, 19), "a,b\n1,2\n# checksum ");
    EXPECT_EQ(seal("a\n").back(), '\n');
}

TEST(Sealed, DetectsEveryFlippedBit) {
    const std::string whole = seal("method,error\nrk4,1.25e-09\n");
    for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
        std::string damaged = whole;
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
        ASSERT_FALSE(unseal(damaged)) << bit;
    }
}

TEST(Sealed, NoticesMissingAndAddedBytesAndForeignTexts) {
    const std::string whole = seal("method,error\nrk4,1.25e-09\n");
    for (std::size_t length = 0; length < whole.size(); ++length) {
        ASSERT_FALSE(unseal(whole.substr(0, length))) << length;
        ASSERT_FALSE(unseal(whole.substr(whole.size() - length))) << length;
    }
    EXPECT_FALSE(unseal(whole + "\n"));
    EXPECT_FALSE(unseal(std::string(200, '\0')));
    EXPECT_FALSE(unseal("# checksum 00000000000000000000000000000000\n"));
}

TEST(Sealed, ReportsACorruptedFileOnceAndAMissingOneNever) {
    const std::string path = (std::filesystem::path(::testing::TempDir()) / "polhode_sealed_test").string();
    std::ofstream(path, std::ios::binary) << seal("kept\n");
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(read_sealed(path), "kept\n");
    EXPECT_FALSE(read_sealed(path + ".missing"));
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
    std::ofstream(path, std::ios::binary) << seal("kept\n") << "x";
    ::testing::internal::CaptureStderr();
    EXPECT_FALSE(read_sealed(path));
    EXPECT_FALSE(read_sealed(path));
    EXPECT_EQ(
        ::testing::internal::GetCapturedStderr(),
        "polhode: " + path + ": corrupted (wrong checksum); it is treated as missing and recomputed when needed\n");
    std::filesystem::remove(path);
}

}  // namespace
}  // namespace polhode
