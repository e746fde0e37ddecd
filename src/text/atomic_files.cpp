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

// each holds a file open until the disk has it
constexpr std::size_t most_at_once = 64;

}  // namespace

AtomicFiles::AtomicFiles(std::string folder) : folder_(std::move(folder)) {}

AtomicFiles::~AtomicFiles() { drop(); }

void AtomicFiles::drop() {
    for (const Written& written : batch_) {
        if (written.file >= 0) ::close(written.file);
        if (!written.temporary.empty()) ::unlink(written.temporary.c_str());
    }
    batch_.clear();
}

void AtomicFiles::add(const std::string& name, std::string_view text) {
    const std::string path = (std::filesystem::path(folder_) / name).string();
    struct stat old {};
    const bool exists = ::lstat(path.c_str(), &old) == 0;
    if (exists && !S_ISREG(old.st_mode))
        fail_of_file(path, "is no regular file", S_ISDIR(old.st_mode) ? EISDIR : EEXIST);
    if (batch_.size() >= most_at_once) commit();
    Written written{path, "", -1};
    written.file = create_temporary(path, written.temporary);
    if (written.file < 0 && (errno == EMFILE || errno == ENFILE) && !batch_.empty()) {
        commit();
        written.file = create_temporary(path, written.temporary);
    }
    if (written.file < 0) fail_of_file(path, "cannot be created", errno);
    batch_.push_back(std::move(written));
    const int file = batch_.back().file;
    if (const int error = write_all(file, text); error != 0) fail_of_file(path, "cannot be written", error);
    if (exists && uncut([&] { return ::fchmod(file, old.st_mode & 07777); }) != 0)
        fail_of_file(path, "cannot be written", errno);
    // the disk begins now what commit() waits for
    ::sync_file_range(file, 0, 0, SYNC_FILE_RANGE_WRITE);
}

void AtomicFiles::commit() {
    if (batch_.empty()) return;
    // a journal that was written for the first of them holds the others too
    for (Written& written : batch_) {
        int error = uncut([&] { return ::fsync(written.file); }) != 0 ? errno : 0;
        if (const int fault = close_file(std::exchange(written.file, -1)); error == 0) error = fault;
        if (error != 0) fail_of_file(written.path, "cannot be written", error);
    }
    for (Written& written : batch_) {
        if (uncut([&] { return ::rename(written.temporary.c_str(), written.path.c_str()); }) != 0)
            fail_of_file(written.path, "cannot be written", errno);
        written.temporary.clear();
    }
    batch_.clear();
    const int directory = uncut([&] { return ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); });
    if (directory < 0) return;  // it may be written to but not read
    const int error = sync_folder(directory);
    ::close(directory);
    if (error != 0) fail_of_file(folder_, "is written to, but cannot be synced", error);
}

}  // namespace polhode
