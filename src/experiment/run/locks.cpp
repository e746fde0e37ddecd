#include "experiment/run/locks.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <thread>

#include "text/atomic_file.h"
#include "text/claims.h"

namespace polhode {

FileLock::FileLock(const std::string& path, Kind kind, const std::atomic<bool>& stop)
    : descriptor_(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666)) {
    if (descriptor_ < 0) {
        if (errno != ENOENT) warn_unlocked(path, errno);
        return;
    }
    // poll, so that an interrupt is noticed while another process holds the lock
    const int operation = (kind == Kind::shared ? LOCK_SH : LOCK_EX) | LOCK_NB;
    while (flock(descriptor_, operation) != 0) {
        if (errno == EINTR) continue;
        if (errno != EWOULDBLOCK) {
            warn_unlocked(path, errno);
            return;
        }
        if (stop) return;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

FileLock::~FileLock() {
    if (descriptor_ >= 0) close(descriptor_);
}

std::string machine_lock_file() {
    std::error_code fault;
    std::filesystem::path directory = std::filesystem::temp_directory_path(fault);
    // if TMPDIR is not a directory, all runs still need one common place, so not the working directory
    if (fault) directory = "/tmp";
    return (directory / fmt::format("polhode-{}.lock", getuid())).string();
}

namespace {

std::string file_of_cases(const std::string& directory, const char* name) {
    const std::filesystem::path cases = std::filesystem::path(directory) / ".cases";
    std::error_code none;
    std::filesystem::create_directories(cases, none);
    return (cases / name).string();
}

}  // namespace

std::string report_lock_file(const std::string& directory) { return file_of_cases(directory, "report.lock"); }

std::string claims_file(const std::string& directory) { return file_of_cases(directory, "claims"); }

void remove_abandoned_files(const std::string& directory) {
    remove_abandoned(directory);
    remove_abandoned((std::filesystem::path(directory) / ".cases").string());
}

}  // namespace polhode
