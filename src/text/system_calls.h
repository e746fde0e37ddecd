// System calls that a signal may cut off.
#pragma once

#include <unistd.h>

#include <cerrno>

namespace polhode {

/// A call that returns something negative and sets errno where it fails, again for as long as a signal cuts it off.
template <class Call>
auto uncut(Call&& call) {
    auto result = call();
    while (result < 0 && errno == EINTR) result = call();
    return result;
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
