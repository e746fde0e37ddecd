#include "text/claims.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <set>
#include <utility>

#include "text/content_hash.h"
#include "text/message.h"

namespace polhode {
namespace {

// Open file description lock (F_OFD_SETLK), not a process lock: other openings of the file in this process do not
// drop it.
int lock_byte(int file, short type, long long byte) {
    struct flock lock {};
    lock.l_type = type, lock.l_whence = SEEK_SET;
    lock.l_start = static_cast<off_t>(byte), lock.l_len = 1;
    int result = ::fcntl(file, F_OFD_SETLK, &lock);
    while (result != 0 && errno == EINTR) result = ::fcntl(file, F_OFD_SETLK, &lock);
    return result;
}

}  // namespace

Claims::Claim::Claim(Claim&& other) noexcept : file_(std::exchange(other.file_, -1)), byte_(other.byte_) {}

Claims::Claim& Claims::Claim::operator=(Claim&& other) noexcept {
    // the previous claim is released with `other`
    std::swap(file_, other.file_), std::swap(byte_, other.byte_);
    return *this;
}

Claims::Claim::~Claim() {
    if (file_ >= 0) lock_byte(file_, F_UNLCK, byte_);
}

Claims::Claims(const std::string& path)
    : path_(path), file_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666)) {}

Claims::~Claims() {
    if (file_ >= 0) ::close(file_);
}

std::optional<Claims::Claim> Claims::take(std::string_view key) const {
    if (file_ < 0) return Claim(-1, 0);
    constexpr std::size_t digits = 15;  // keeps the byte number below 2^60
    const long long byte = std::strtoll(content_hash(key).substr(0, digits).c_str(), nullptr, 16);
    if (lock_byte(file_, F_WRLCK, byte) == 0) return Claim(file_, byte);
    if (errno == EAGAIN || errno == EACCES) return {};
    warn_unlocked(path_, errno);
    return Claim(-1, 0);
}

void warn_unlocked(const std::string& path, int error) {
    static std::mutex mutex;
    static std::set<std::string> reported;
    const std::lock_guard lock(mutex);
    if (!reported.insert(path).second) return;
    const std::string line = "polhode: " + one_line(path, 500) + ": cannot be locked: " + std::strerror(error) +
                             "; continues as if no other run used this folder\n";
    static_cast<void>(std::fputs(line.c_str(), stderr));  // a failure cannot be reported anywhere
}

}  // namespace polhode
