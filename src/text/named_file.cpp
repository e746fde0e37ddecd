#include "text/named_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "text/message.h"

namespace polhode {
namespace {

std::atomic<bool> outside_is_allowed{false};

// A descriptor that is closed at the end.
class OpenFile {
  public:
    // a FIFO that nobody writes to, or a line without a carrier, is not waited for
    explicit OpenFile(const std::string& path)
        : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) {}
    ~OpenFile() {
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;

    int descriptor() const { return descriptor_; }
    // what is read from now on is waited for
    void wait() const {
        if (const int flags = ::fcntl(descriptor_, F_GETFL); flags >= 0)
            ::fcntl(descriptor_, F_SETFL, flags & ~O_NONBLOCK);
    }

  private:
    int descriptor_;
};

// What a file is that is none to be read; empty where it may be. A shell hands over pipes and terminals in /dev and
// /proc, and /dev/null, which ends at once; another device may go on for ever.
std::string unfit(const struct stat& status, const std::string& path, FileKinds kinds, int descriptor) {
    const bool handed = kinds == FileKinds::streamed && (path.starts_with("/dev/") || path.starts_with("/proc/"));
    if (S_ISREG(status.st_mode)) return "";
    if (S_ISDIR(status.st_mode)) return std::string("cannot be read: ") + std::strerror(EISDIR);
    if (S_ISFIFO(status.st_mode)) return handed ? "" : "is a FIFO and no regular file";
    if (S_ISSOCK(status.st_mode)) return handed ? "" : "is a socket and no regular file";
    const bool ends = S_ISCHR(status.st_mode) && (::isatty(descriptor) == 1 || status.st_rdev == makedev(1, 3));
    return handed && ends ? "" : "is a device and no regular file";
}

std::string real_path(const std::string& path) {
    const std::unique_ptr<char, decltype(&std::free)> real(::realpath(path.c_str(), nullptr), &std::free);
    return real ? std::string(real.get()) : std::string();
}

[[noreturn]] void refuse_outside(const std::string& path) {
    throw InputError(path, "", "leads out of the folder of the file that names it",
                     "put it there, or allow it: --allow-outside (in C++ and Python allow_outside_files)");
}

}  // namespace

void allow_outside_files(bool allowed) { outside_is_allowed = allowed; }
bool outside_files_are_allowed() { return outside_is_allowed; }

std::string path_in(const std::string& folder, const std::string& name) {
    return folder.empty() || name.starts_with('/') ? name : folder + '/' + name;
}

std::string path_inside(const std::string& folder, const std::string& name) {
    const std::string path = path_in(folder, name);
    // what begins at the root is no name of a file that lies beside another, wherever it leads
    if (name.starts_with('/') && !outside_is_allowed) refuse_outside(path);
    require_inside(folder, path);
    return real_path(path);
}

void require_inside(const std::string& folder, const std::string& path) {
    if (path.find('\0') != std::string::npos)
        throw InputError(path, "", "holds a zero byte", "give the path of a file");
    const std::string real = real_path(path);
    if (real.empty())
        throw InputError(path, "", fmt::format("cannot be opened: {}", std::strerror(errno)),
                         "give the path of a file that is there");
    std::string within = real_path(folder.empty() ? "." : folder);
    if (!within.ends_with('/')) within += '/';
    if (!outside_is_allowed && !real.starts_with(within)) refuse_outside(path);
}

std::string read_named_text(const std::string& folder, const std::string& name, std::size_t largest,
                            const char* expected) {
    return read_whole_file(path_inside(folder, name), path_in(folder, name), largest, expected, FileKinds::regular);
}

std::string read_whole_file(const std::string& path, const std::string& called, std::size_t largest,
                            const char* expected, FileKinds kinds) {
    const auto refuse = [&](const std::string& fault) {
        throw InputError(called, "", fault, fmt::format("give the path of {}", expected));
    };
    const auto refuse_size = [&] {
        refuse(largest >> 20 > 0 ? fmt::format("has more than {} MiB", largest >> 20)
                                 : fmt::format("has more than {} bytes", largest));
    };
    // a device may do something when it is opened: it is looked at first, and what was opened once more
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0 && S_ISBLK(status.st_mode)) refuse("is a device and no regular file");
    const OpenFile file(path);
    if (file.descriptor() < 0) {
        const int reason = errno;
        refuse(reason == ENXIO ? "is a socket and no regular file"
                               : fmt::format("cannot be opened: {}", std::strerror(reason)));
    }
    if (::fstat(file.descriptor(), &status) != 0) refuse(fmt::format("cannot be read: {}", std::strerror(errno)));
    if (const std::string fault = unfit(status, path, kinds, file.descriptor()); !fault.empty()) refuse(fault);
    file.wait();
    std::string text;
    // room at once where the size is known: a regular file may grow, but not beyond the largest
    if (S_ISREG(status.st_mode)) {
        if (static_cast<std::size_t>(status.st_size) > largest) refuse_size();
        text.reserve(static_cast<std::size_t>(status.st_size));
    }
    char block[1 << 16];
    for (;;) {
        const ssize_t count = ::read(file.descriptor(), block, sizeof block);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) refuse(fmt::format("cannot be read: {}", std::strerror(errno)));
        if (count == 0) return text;
        text.append(block, static_cast<std::size_t>(count));
        if (text.size() > largest) refuse_size();
    }
}

}  // namespace polhode
