// Linked to every test program: each run starts with an empty truth cache, whatever its working directory, and reads
// nothing left by an earlier program. A test's own settings take precedence.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace {

class TestCache : public testing::Environment {
  public:
    void SetUp() override {
        std::string pattern = (std::filesystem::temp_directory_path() / "polhode-test-cache-XXXXXX").string();
        ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
        directory_ = pattern;
        ::setenv("XDG_CACHE_HOME", pattern.c_str(), 1);
        ::unsetenv("POLHODE_CACHE");
    }
    void TearDown() override { std::filesystem::remove_all(directory_); }

  private:
    std::filesystem::path directory_;
};

[[maybe_unused]] const testing::Environment* const test_cache = testing::AddGlobalTestEnvironment(new TestCache);

}  // namespace
