// System calls that a signal may cut off.
#pragma once

#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

namespace polhode {

/// A call that returns something negative and sets errno where it fails, again for as long as a signal cuts it off.
template <class Call>
auto uncut(Call&& call) {
    auto result = call();
    while (result < 0 && errno == EINTR) result = call();
    return result;
}

/// Throws std::runtime_error: the path, what became of it, and the system's reason.
[[noreturn]] inline void fail_of_file(const std::string& path, const char* what, int error) {
    throw std::runtime_error(path + ": " + what + ": " + std::strerror(error));
}

/// Writes all of a text. Returns 0 or the error number.
inline int write_all(int file, std::string_view text) {
    while (!text.empty()) {
        const ssize_t count = uncut([&] { return ::write(file, text.data(), text.size()); });
        if (count < 0) return errno;
        if (count == 0) return EIO;  // a file that takes nothing and does not say why
        text.remove_prefix(static_cast<std::size_t>(count));
    }
    return 0;
}

/// Closes a file. Returns 0 or the error number; a signal that comes meanwhile leaves the file closed, too.
inline int close_file(int file) { return ::close(file) != 0 && errno != EINTR ? errno : 0; }

/// Syncs the folder of a file that was given its name, so that the name lasts through a power failure: an open folder's
/// descriptor. Returns 0 or the error number; a file system that cannot sync a folder is no error.
inline int sync_folder(int folder) {
    const bool failed = uncut([&] { return ::fsync(folder); }) != 0;
    return failed && errno != EINVAL && errno != ENOTSUP && errno != EROFS ? errno : 0;
}

}  // namespace polhode
