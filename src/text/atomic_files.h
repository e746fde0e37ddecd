// Writes many files of one folder, each of them atomically.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace polhode {

/// Writes many files with the guarantees of write_atomically() (text/atomic_file.h) in a fraction of the time,
/// because the disk is synced once per batch. After commit() has returned, every added file is in place and complete;
/// before that, any of them may be. All members throw std::runtime_error (one line with the path and the system's
/// reason). Files not written by then are unchanged, and no temporary file is left.
class AtomicFiles {
  public:
    /// The folder must exist.
    explicit AtomicFiles(std::string folder);
    ~AtomicFiles();
    AtomicFiles(const AtomicFiles&) = delete;
    AtomicFiles& operator=(const AtomicFiles&) = delete;

    /// Adds or replaces the file with this name. Refuses to replace anything but a regular file.
    void add(const std::string& name, std::string_view text);
    /// Puts all added files in place.
    void commit();

  private:
    struct PendingFile {
        std::string path, temporary;
    };
    void drop();

    std::string folder_;
    std::vector<PendingFile> batch_;
};

}  // namespace polhode
