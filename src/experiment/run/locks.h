// What several processes over one folder, or on one machine, must not do at the same time.
#pragma once

#include <atomic>
#include <string>

namespace polhode {

/// An advisory lock on a file (flock), given back at the end of its life and by the death of the process. Where the
/// file cannot be opened, or the file system has no locks, the work goes on without; one line on standard error tells.
class FileLock {
  public:
    enum class Kind { shared, exclusive };

    /// Waits until it is granted, or until `stop`.
    FileLock(const std::string& path, Kind kind, const std::atomic<bool>& stop);
    ~FileLock();
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;

  private:
    int descriptor_ = -1;
};

/// The file by which all runs of this user on this machine keep other work away from timings: computing holds it
/// shared, timing exclusively. In TMPDIR, or in /tmp where that is no directory.
std::string machine_lock_file();

/// The file by which one process at a time gathers a folder's cases into tables.
std::string report_lock_file(const std::string& directory);

/// The file by which processes over one folder claim its cases, searches and studies by their keys (text/claims.h).
std::string claims_file(const std::string& directory);

/// Removes what killed runs have left in the folder and in its cases: remove_abandoned().
void remove_abandoned_of_runs(const std::string& directory);

}  // namespace polhode
