#include "text/atomic_stream.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <utility>

#include "text/atomic_file.h"
#include "text/system_calls.h"

namespace polhode {

AtomicStream::AtomicStream(std::string path) : path_(std::move(path)) {
    // resolve symbolic links, so that the target is replaced and not the link
    const std::unique_ptr<char, void (*)(void*)> resolved(::realpath(path_.c_str(), nullptr), &std::free);
    target_ = resolved ? resolved.get() : path_;
    struct stat old {};
    const bool exists = ::stat(target_.c_str(), &old) == 0;
    if (exists && S_ISDIR(old.st_mode)) fail("cannot be written", EISDIR);
    if (exists && !S_ISREG(old.st_mode)) {
        file_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
        if (file_ < 0) fail("cannot be opened", errno);
        return;
    }
    // remove temporary files left by killed runs
    remove_abandoned(folder());
    file_ = create_temporary(target_, temporary_);
    if (file_ < 0) fail("cannot be created", errno);
    if (!exists || retry_if_interrupted([&] { return ::fchmod(file_, old.st_mode & 07777); }) == 0) return;
    const int error = errno;
    ::close(file_);
    ::unlink(temporary_.c_str());
    fail("cannot be written", error);
}

AtomicStream::~AtomicStream() {
    if (file_ >= 0) ::close(file_);
    if (!committed_ && !temporary_.empty()) ::unlink(temporary_.c_str());
}

std::string AtomicStream::folder() const {
    const std::string parent = std::filesystem::path(target_).parent_path().string();
    return parent.empty() ? "." : parent;
}

void AtomicStream::fail(const char* what, int error) const { fail_of_file(path_, what, error); }

void AtomicStream::write_at(std::string_view bytes, std::size_t* offset) {
    while (!bytes.empty()) {
        const ssize_t count = retry_if_interrupted([&] {
            return offset ? ::pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(*offset))
                          : ::write(file_, bytes.data(), bytes.size());
        });
        // a write of 0 bytes gives no reason
        if (count <= 0) fail("cannot be written", count < 0 ? errno : EIO);
        bytes.remove_prefix(static_cast<std::size_t>(count));
        if (offset) *offset += static_cast<std::size_t>(count);
    }
}

void AtomicStream::write(std::string_view bytes) {
    write_at(bytes, nullptr);
    written_ += bytes.size();
    // start now the writing that commit() would wait for
    constexpr std::size_t step = std::size_t{16} << 20;
    if (!is_regular() || written_ - started_ < step) return;
    ::sync_file_range(file_, static_cast<off_t>(started_), static_cast<off_t>(written_ - started_),
                      SYNC_FILE_RANGE_WRITE);
    started_ = written_;
}

void AtomicStream::write_over_beginning(std::string_view bytes) {
    if (!is_regular() || bytes.size() > written_)
        throw std::logic_error(path_ + ": cannot overwrite more bytes than were written");
    std::size_t offset = 0;
    write_at(bytes, &offset);
}

void AtomicStream::commit() {
    int error = is_regular() && retry_if_interrupted([&] { return ::fsync(file_); }) != 0 ? errno : 0;
    if (const int fault = close_file(std::exchange(file_, -1)); error == 0) error = fault;
    if (error == 0 && is_regular() &&
        retry_if_interrupted([&] { return ::rename(temporary_.c_str(), target_.c_str()); }) != 0)
        error = errno;
    if (error != 0) fail("cannot be written", error);
    committed_ = true;
    if (!is_regular()) return;
    const int directory =
        retry_if_interrupted([&] { return ::open(folder().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); });
    if (directory < 0) return;  // a directory may be writable but not readable
    error = sync_folder(directory);
    ::close(directory);
    if (error != 0) fail("was written, but its folder cannot be synced", error);
}

}  // namespace polhode
