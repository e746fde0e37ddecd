// Divides work among processes so that each piece is done by one process at a time.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace polhode {

/// Claims on pieces of work, by key, among the processes that use the same lock file. Each key is an advisory lock on
/// one byte of the file. The lock is released with the claim or when the process ends for any reason. Claims within
/// one process do not exclude each other. If the file system has no locks or the file cannot be opened, every claim
/// is granted; at worst, work is then done twice. Missing locks are reported once per process by one line on standard
/// error.
class Claims {
  public:
    /// The result of take(). It must not outlive the Claims.
    class Claim {
      public:
        Claim(int file, long long byte) : file_(file), byte_(byte) {}
        Claim(Claim&& other) noexcept;
        Claim& operator=(Claim&& other) noexcept;
        ~Claim();

      private:
        int file_;  // -1: nothing to release
        long long byte_;
    };

    /// Creates the file if it does not exist. Its folder must exist.
    explicit Claims(const std::string& path);
    ~Claims();
    Claims(const Claims&) = delete;
    Claims& operator=(const Claims&) = delete;

    /// Returns the claim on this key, or nothing while another process holds it. Does not wait. Thread-safe.
    std::optional<Claim> take(std::string_view key) const;

  private:
    std::string path_;
    int file_;
};

/// Reports on standard error, once per process, that the file cannot be locked and that work continues without locks.
void warn_unlocked(const std::string& path, int error);

}  // namespace polhode
