#include "text/atomic_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <utility>

#include "text/atomic_file.h"
#include "text/system_calls.h"

namespace polhode {
namespace {

// the largest number of temporary files that a killed process may leave
constexpr std::size_t max_batch_size = 1024;

}  // namespace

AtomicFiles::AtomicFiles(std::string folder) : folder_(std::move(folder)) {}

AtomicFiles::~AtomicFiles() { drop(); }

void AtomicFiles::drop() {
    for (const PendingFile& written : batch_) ::unlink(written.temporary.c_str());
    batch_.clear();
}

void AtomicFiles::add(const std::string& name, std::string_view text) {
    const std::string path = (std::filesystem::path(folder_) / name).string();
    struct stat old {};
    const bool exists = ::lstat(path.c_str(), &old) == 0;
    if (exists && !S_ISREG(old.st_mode))
        fail_of_file(path, "is not a regular file", S_ISDIR(old.st_mode) ? EISDIR : EEXIST);
    if (batch_.size() >= max_batch_size) commit();
    PendingFile written{path, ""};
    const int file = create_temporary(path, written.temporary);
    if (file < 0) fail_of_file(path, "cannot be created", errno);
    batch_.push_back(std::move(written));
    int error = write_all(file, text);
    if (error == 0 && exists && retry_if_interrupted([&] { return ::fchmod(file, old.st_mode & 07777); }) != 0)
        error = errno;
    if (const int fault = close_file(file); error == 0) error = fault;
    if (error != 0) fail_of_file(path, "cannot be written", error);
}

void AtomicFiles::commit() {
    if (batch_.empty()) return;
    const int directory =
        retry_if_interrupted([&] { return ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); });
    if (directory < 0) fail_of_file(folder_, "cannot be opened", errno);
    // syncs the whole file system and thus the batch; with fsync() each file would wait for a flush of the disk's
    // cache
    int error = retry_if_interrupted([&] { return ::syncfs(directory); }) != 0 ? errno : 0;
    const char* what = "cannot be synced";
    std::size_t renamed = 0;
    while (error == 0 && renamed < batch_.size()) {
        const PendingFile& written = batch_[renamed];
        if (retry_if_interrupted([&] { return ::rename(written.temporary.c_str(), written.path.c_str()); }) != 0)
            error = errno, what = "cannot be written to";
        else
            ++renamed;
    }
    batch_.erase(batch_.begin(), batch_.begin() + static_cast<std::ptrdiff_t>(renamed));
    if (error == 0 && (error = sync_folder(directory)) != 0) what = "was written, but cannot be synced";
    ::close(directory);
    if (error != 0) fail_of_file(folder_, what, error);
}

}  // namespace polhode
