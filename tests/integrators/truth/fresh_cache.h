// A private truth cache, empty at the start and removed at the end.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace polhode {

class FreshCache {
  public:
    FreshCache() {
        std::string path = (std::filesystem::temp_directory_path() / "polhode-cache-XXXXXX").string();
        directory_ = ::mkdtemp(path.data());
        if (const char* before = std::getenv("POLHODE_CACHE")) before_ = before;
        ::setenv("POLHODE_CACHE", directory_.c_str(), 1);
    }
    ~FreshCache() {
        before_.empty() ? ::unsetenv("POLHODE_CACHE") : ::setenv("POLHODE_CACHE", before_.c_str(), 1);
        std::filesystem::remove_all(directory_);
    }
    FreshCache(const FreshCache&) = delete;
    FreshCache& operator=(const FreshCache&) = delete;

    const std::string& directory() const { return directory_; }

  private:
    std::string directory_, before_;
};

}  // namespace polhode
