#include "text/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>

namespace polhode {
namespace {

[[noreturn]] void fail(const std::string& path, const char* what, int error) {
    throw std::runtime_error(path + ": " + what + ": " + std::strerror(error));
}

// What a symbolic link points at, so that the link stays one.
std::string target_of(const std::string& path) {
    const std::unique_ptr<char, void (*)(void*)> resolved(::realpath(path.c_str(), nullptr), &std::free);
    return resolved ? std::string(resolved.get()) : path;
}

std::string directory_of(const std::string& path) {
    const std::string parent = std::filesystem::path(path).parent_path().string();
    return parent.empty() ? "." : parent;
}

// Returns 0 or the error number.
int write_all(int file, std::string_view text) {
    while (!text.empty()) {
        const ssize_t count = ::write(file, text.data(), text.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) return errno;
        text.remove_prefix(static_cast<std::size_t>(count));
    }
    return 0;
}

// A new file beside `target`, under a name that no other thread or process has; the process's mask gives its mode.
// Returns the descriptor, or -1 with errno set.
int create_beside(const std::string& target, std::string& name) {
    static std::atomic<unsigned> counter{0};
    for (int attempt = 0; attempt < 1000; ++attempt) {
        name = target + "." + std::to_string(::getpid()) + "." + std::to_string(counter++) + ".new";
        const int file = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file >= 0 || errno != EEXIST) return file;
    }
    return -1;
}

}  // namespace

void write_atomically(const std::string& path, std::string_view text) {
    const std::string target = target_of(path);
    struct stat old {};
    const bool exists = ::stat(target.c_str(), &old) == 0;
    if (exists && S_ISDIR(old.st_mode)) fail(path, "cannot be written", EISDIR);
    if (exists && !S_ISREG(old.st_mode)) {
        const int file = ::open(target.c_str(), O_WRONLY | O_CLOEXEC);
        if (file < 0) fail(path, "cannot be opened", errno);
        const int error = write_all(file, text);
        ::close(file);
        if (error != 0) fail(path, "cannot be written", error);
        return;
    }
    std::string temporary;
    const int file = create_beside(target, temporary);
    if (file < 0) fail(path, "cannot be created", errno);
    int error = write_all(file, text);
    if (error == 0 && exists && ::fchmod(file, old.st_mode & 07777) != 0) error = errno;
    if (error == 0 && ::fsync(file) != 0) error = errno;
    if (::close(file) != 0 && error == 0) error = errno;
    if (error == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) error = errno;
    if (error != 0) {
        ::unlink(temporary.c_str());
        fail(path, "cannot be written", error);
    }
    // the new name lasts through a power failure once its directory is on disk; some file systems cannot sync one
    const int directory = ::open(directory_of(target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (directory < 0) return;
    ::fsync(directory);
    ::close(directory);
}

void require_writable(const std::string& path) {
    const std::string target = target_of(path);
    struct stat old {};
    const bool exists = ::stat(target.c_str(), &old) == 0;
    if (exists && S_ISDIR(old.st_mode)) fail(path, "cannot be written", EISDIR);
    const std::string place = exists && !S_ISREG(old.st_mode) ? target : directory_of(target);
    if (::access(place.c_str(), W_OK) != 0) fail(path, "cannot be written", errno);
}

}  // namespace polhode
