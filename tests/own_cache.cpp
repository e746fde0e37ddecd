// Linked to every test program: each run of one finds the truth's cache empty, wherever it is started from, and trusts
// nothing that an earlier program left behind. What a test sets itself goes before it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace {

class OwnCache : public testing::Environment {
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

[[maybe_unused]] const testing::Environment* const own_cache = testing::AddGlobalTestEnvironment(new OwnCache);

}  // namespace
