#include "text/input_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "text/message.h"

namespace polhode {
namespace {

// Why the file cannot be read, or an empty string if it can. A shell passes pipes and terminals in /dev and /proc,
// and /dev/null, which ends at once. Other devices may never end.
std::string unreadable_reason(const struct stat& status, const std::string& path, FileKinds kinds, int descriptor) {
    const bool is_streamed = kinds == FileKinds::streamed && (path.starts_with("/dev/") || path.starts_with("/proc/"));
    if (S_ISREG(status.st_mode)) return "";
    if (S_ISDIR(status.st_mode)) return std::string("cannot be read: ") + std::strerror(EISDIR);
    if (S_ISFIFO(status.st_mode)) return is_streamed ? "" : "is a FIFO, not a regular file";
    if (S_ISSOCK(status.st_mode)) return is_streamed ? "" : "is a socket, not a regular file";
    const bool ends = S_ISCHR(status.st_mode) && (::isatty(descriptor) == 1 || status.st_rdev == makedev(1, 3));
    return is_streamed && ends ? "" : "is a device, not a regular file";
}

}  // namespace

InputFile::InputFile(const std::string& path, std::string display_name, std::string expected, FileKinds kinds)
    : display_name_(std::move(display_name)), expected_(std::move(expected)) {
    // opening a device may have side effects: check the path first, and the opened file again below
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0 && S_ISBLK(status.st_mode)) refuse("is a device, not a regular file");
    // O_NONBLOCK: do not wait for the writer of a FIFO or the carrier of a serial line
    descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (descriptor_ < 0) {
        const int reason = errno;
        refuse(reason == ENXIO ? "is a socket, not a regular file"
                               : fmt::format("cannot be opened: {}", std::strerror(reason)));
    }
    std::string fault = ::fstat(descriptor_, &status) != 0 ? fmt::format("cannot be read: {}", std::strerror(errno))
                                                           : unreadable_reason(status, path, kinds, descriptor_);
    if (!fault.empty()) {
        ::close(descriptor_);
        refuse(fault);
    }
    // from here on, reads block
    if (const int flags = ::fcntl(descriptor_, F_GETFL); flags >= 0) ::fcntl(descriptor_, F_SETFL, flags & ~O_NONBLOCK);
    if (S_ISREG(status.st_mode)) size_ = static_cast<std::size_t>(status.st_size);
}

InputFile::~InputFile() { ::close(descriptor_); }

std::size_t InputFile::read(char* bytes, std::size_t count) {
    for (;;) {
        const ssize_t bytes_read = ::read(descriptor_, bytes, count);
        if (bytes_read >= 0) return static_cast<std::size_t>(bytes_read);
        if (errno != EINTR) refuse(fmt::format("cannot be read: {}", std::strerror(errno)));
    }
}

std::size_t InputFile::read_fully(char* bytes, std::size_t count) {
    std::size_t bytes_read = 0;
    while (const std::size_t more = bytes_read < count ? read(bytes + bytes_read, count - bytes_read) : 0)
        bytes_read += more;
    return bytes_read;
}

void InputFile::seek(std::size_t offset) {
    if (::lseek(descriptor_, static_cast<off_t>(offset), SEEK_SET) < 0)
        refuse(fmt::format("cannot be read: {}", std::strerror(errno)));
}

void InputFile::refuse(const std::string& fault) const {
    throw InputError(display_name_, "", fault, fmt::format("give the path of {}", expected_));
}

}  // namespace polhode
