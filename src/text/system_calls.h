// System calls that a signal may interrupt.
#pragma once

#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

namespace polhode {

/// Repeats a call that returns a negative value and sets errno, as long as a signal interrupts it (EINTR).
template <class Call>
auto retry_if_interrupted(Call&& call) {
    auto result = call();
    while (result < 0 && errno == EINTR) result = call();
    return result;
}

/// Throws std::runtime_error "PATH: WHAT: the system's reason".
[[noreturn]] inline void fail_of_file(const std::string& path, const char* what, int error) {
    throw std::runtime_error(path + ": " + what + ": " + std::strerror(error));
}

/// Writes the whole text. Returns 0 or the error number.
inline int write_all(int file, std::string_view text) {
    while (!text.empty()) {
        const ssize_t count = retry_if_interrupted([&] { return ::write(file, text.data(), text.size()); });
        if (count < 0) return errno;
        if (count == 0) return EIO;  // the file accepted no bytes and gave no reason
        text.remove_prefix(static_cast<std::size_t>(count));
    }
    return 0;
}

/// Closes a file. Returns 0 or the error number. EINTR counts as success, because the file is closed then, too.
inline int close_file(int file) { return ::close(file) != 0 && errno != EINTR ? errno : 0; }

/// Syncs an open folder, so that a name just given in it survives a power failure. Returns 0 or the error number; a
/// file system that cannot sync folders is not an error.
inline int sync_folder(int folder) {
    const bool failed = retry_if_interrupted([&] { return ::fsync(folder); }) != 0;
    return failed && errno != EINVAL && errno != ENOTSUP && errno != EROFS ? errno : 0;
}

}  // namespace polhode
