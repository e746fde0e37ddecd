#include "experiment/run/locks.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <thread>

namespace polhode {

FileLock::FileLock(const std::string& path, Kind kind, const std::atomic<bool>& stop)
    : descriptor_(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600)) {
    if (descriptor_ < 0) return;
    // polled, so that an interrupt is heard while another process is at work
    const int operation = (kind == Kind::shared ? LOCK_SH : LOCK_EX) | LOCK_NB;
    while (flock(descriptor_, operation) != 0 && errno == EWOULDBLOCK && !stop)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

FileLock::~FileLock() {
    if (descriptor_ >= 0) close(descriptor_);
}

std::string machine_lock_file() {
    std::error_code none;
    const std::filesystem::path directory = std::filesystem::temp_directory_path(none);
    return (directory / fmt::format("polhode-{}.lock", getuid())).string();
}

std::string report_lock_file(const std::string& directory) {
    const std::filesystem::path cases = std::filesystem::path(directory) / ".cases";
    std::error_code none;
    std::filesystem::create_directories(cases, none);
    return (cases / "report.lock").string();
}

}  // namespace polhode
