// Locks between processes that share a result directory or a machine.
#pragma once

#include <atomic>
#include <string>

namespace polhode {

/// An advisory lock on a file (flock), released by the destructor and when the process ends. If the file cannot be
/// opened or the file system has no locks, one line on standard error reports this and the work continues unlocked.
class FileLock {
  public:
    enum class Kind { shared, exclusive };

    /// Waits until the lock is granted or `stop` is set.
    FileLock(const std::string& path, Kind kind, const std::atomic<bool>& stop);
    ~FileLock();
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;

  private:
    int descriptor_ = -1;
};

/// The lock file of all runs of this user on this machine. Computations hold it shared, timings exclusively, so that
/// no computation disturbs a timing. It is in TMPDIR, or in /tmp if TMPDIR is not a directory.
std::string machine_lock_file();

/// The lock file of a result directory: one process at a time writes its tables.
std::string report_lock_file(const std::string& directory);

/// The file in which processes claim the cases, searches and studies of a directory by their keys (text/claims.h).
std::string claims_file(const std::string& directory);

/// Removes temporary files of killed runs from the directory and its .cases; see remove_abandoned().
void remove_abandoned_files(const std::string& directory);

}  // namespace polhode
