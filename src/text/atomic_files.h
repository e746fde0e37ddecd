// Many files of one folder, each there whole or not at all.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace polhode {

/// What write_atomically() (text/atomic_file.h) does for each of many files, in a fraction of the time: the disk is
/// waited for once for a batch of them. Files that were added are there, each of them whole, when commit() has
/// returned; before that any of them may be. All members throw std::runtime_error (one line, with the path and the
/// system's reason); what was not written by then is as it was, and no temporary is left.
class AtomicFiles {
  public:
    /// Of an existing folder.
    explicit AtomicFiles(std::string folder);
    ~AtomicFiles();
    AtomicFiles(const AtomicFiles&) = delete;
    AtomicFiles& operator=(const AtomicFiles&) = delete;

    /// Adds a file of this name, or replaces one; what is no regular file is refused.
    void add(const std::string& name, std::string_view text);
    /// Puts all that was added into its place.
    void commit();

  private:
    struct Written {
        std::string path, temporary;
    };
    void drop();

    std::string folder_;
    std::vector<Written> batch_;
};

}  // namespace polhode
