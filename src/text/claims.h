// Work that several processes could do, each piece of it by one at a time.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace polhode {

/// Claims on pieces of work, by key, among the processes that name the same file: an advisory lock on one byte of it a
/// key, which ends with the claim or with the process, however that ends. Within one process a key is nobody else's.
/// Where the file system has no locks, or the file cannot be opened, every claim is granted: work is then done twice
/// at worst. Of missing locks one line on standard error tells, once in a process.
class Claims {
  public:
    /// What take() gives; it must not outlive the Claims.
    class Claim {
      public:
        Claim(int file, long long byte) : file_(file), byte_(byte) {}
        Claim(Claim&& other) noexcept;
        Claim& operator=(Claim&& other) noexcept;
        ~Claim();

      private:
        int file_;  // -1: nothing to give back
        long long byte_;
    };

    /// Creates the file where there is none, in a folder that is there.
    explicit Claims(const std::string& path);
    ~Claims();
    Claims(const Claims&) = delete;
    Claims& operator=(const Claims&) = delete;

    /// The claim on this key, or nothing while another process has it. Does not wait. For any thread.
    std::optional<Claim> take(std::string_view key) const;

  private:
    std::string path_;
    int file_;
};

/// Says on standard error that the file cannot be locked and that the work goes on without; once in a process.
void tell_unlocked(const std::string& path, int error);

}  // namespace polhode
