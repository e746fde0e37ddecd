// Atomic replacement of files on POSIX: write a temporary file beside the target, fsync() it, rename() it, fsync()
// the folder. Names of temporaries identify host, process, process start time and a counter, so that
// remove_abandoned() can tell whether the writer still runs.

#include "text/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "text/folder_names.h"
#include "text/system_calls.h"

namespace polhode {
namespace {

// Resolves symbolic links, so that the target is replaced and not the link.
std::string target_of(const std::string& path) {
    const std::unique_ptr<char, void (*)(void*)> resolved(::realpath(path.c_str(), nullptr), &std::free);
    return resolved ? std::string(resolved.get()) : path;
}

std::string directory_of(const std::string& path) {
    const std::string parent = std::filesystem::path(path).parent_path().string();
    return parent.empty() ? "." : parent;
}

// Start time of a process in kernel ticks since boot. Together with the process number it identifies the process.
// Returns nothing if there is no such process or its state cannot be read. Returns `never` for a process that has
// ended but is not reaped yet.
constexpr unsigned long long never = std::numeric_limits<unsigned long long>::max();
std::optional<unsigned long long> start_of(long process) {
    std::ifstream file("/proc/" + std::to_string(process) + "/stat");
    const std::string text(std::istreambuf_iterator<char>(file), {});
    // the program's name is in parentheses and may contain anything; the fields after it are words: state, .., start
    // time
    std::size_t at = text.rfind(')');
    const bool has_ended = at != text.npos && at + 2 < text.size() && (text[at + 2] == 'Z' || text[at + 2] == 'X');
    for (int word = 0; word < 20 && at != text.npos; ++word) at = text.find(' ', at + 1);
    if (at == text.npos) return {};
    if (has_ended) return never;
    unsigned long long start = 0;
    if (std::from_chars(text.data() + at + 1, text.data() + text.size(), start).ec != std::errc{}) return {};
    return start;
}

// The host name and an identifier of the process-number namespace, since two containers may share a name. Contains no
// dots.
std::string this_host() {
    std::array<char, 256> name{};
    if (::gethostname(name.data(), name.size() - 1) != 0) name = {'h', 'o', 's', 't'};
    std::string host(name.data());
    host = host.substr(0, 64);
    struct stat numbers {};
    if (::stat("/proc/self/ns/pid", &numbers) == 0) host += "-" + std::to_string(numbers.st_ino);
    for (char& c : host)
        if (std::strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-", c) == nullptr) c = '_';
    return host;
}

constexpr std::string_view temporary_ending = ".new";

// HOST.PROCESS.START for this process
std::string writer() {
    static const std::string host = this_host();
    // not cached: a fork changes it
    const long process = ::getpid();
    return host + "." + std::to_string(process) + "." + std::to_string(start_of(process).value_or(0));
}

}  // namespace

// Name pattern: TARGET.HOST.PROCESS.START.NUMBER.new
int create_temporary(const std::string& target, std::string& name) {
    static std::atomic<unsigned> counter{0};
    constexpr std::size_t longest_name = 255;
    const std::string by = "." + writer() + ".";
    const std::filesystem::path path(target);
    for (int attempt = 0; attempt < 1000; ++attempt) {
        const std::string ending = by + std::to_string(counter++) + std::string(temporary_ending);
        const std::string beginning = path.filename().string().substr(0, longest_name - ending.size());
        name = (path.parent_path() / (beginning + ending)).string();
        const int file =
            retry_if_interrupted([&] { return ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666); });
        if (file >= 0 || errno != EEXIST) return file;
    }
    return -1;
}

namespace {

std::optional<unsigned long long> number(const std::string& text) {
    unsigned long long value = 0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (fault != std::errc{} || end != text.data() + text.size()) return {};
    return value;
}

// Whether a file with this name is a temporary whose writer has ended; `age` in seconds.
bool is_abandoned(const std::string& name, double age) {
    constexpr double day = 86400;
    // parsed from the end, since a target's name may contain dots: NUMBER, START, PROCESS, HOST
    if (!name.ends_with(temporary_ending)) return false;
    std::string rest = name.substr(0, name.size() - temporary_ending.size());
    std::vector<std::string> words;
    for (int word = 0; word < 4; ++word) {
        const std::size_t dot = rest.rfind('.');
        if (dot == rest.npos || dot == 0) return false;
        words.push_back(rest.substr(dot + 1));
        rest.resize(dot);
    }
    const auto start = number(words[1]), process = number(words[2]);
    if (!number(words[0]) || !start || !process || *process == 0 || *process > 0x7fffffff || words[3].empty())
        return false;
    if (words[3] != this_host()) return age > day;
    const auto id = static_cast<pid_t>(*process);
    if (::kill(id, 0) != 0 && errno == ESRCH) return true;
    const auto began = start_of(id);
    return began && *start != 0 && *began != *start;
}

}  // namespace

void write_atomically(const std::string& path, std::string_view text) {
    const std::string target = target_of(path);
    struct stat old {};
    const bool exists = ::stat(target.c_str(), &old) == 0;
    if (exists && S_ISDIR(old.st_mode)) fail_of_file(path, "cannot be written", EISDIR);
    if (exists && !S_ISREG(old.st_mode)) {
        const int file = retry_if_interrupted([&] { return ::open(target.c_str(), O_WRONLY | O_CLOEXEC); });
        if (file < 0) fail_of_file(path, "cannot be opened", errno);
        int error = write_all(file, text);
        if (const int fault = close_file(file); error == 0) error = fault;
        if (error != 0) fail_of_file(path, "cannot be written", error);
        return;
    }
    // The new name survives a power failure once its directory is synced. A directory that is writable but not
    // readable cannot be synced. Opening it first detects any other error before anything has changed.
    const int directory =
        retry_if_interrupted([&] { return ::open(directory_of(target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); });
    if (directory < 0 && errno != EACCES) fail_of_file(path, "cannot be created", errno);
    std::string temporary;
    const int file = create_temporary(target, temporary);
    if (file < 0) {
        const int error = errno;
        if (directory >= 0) ::close(directory);
        fail_of_file(path, "cannot be created", error);
    }
    int error = write_all(file, text);
    if (error == 0 && exists && retry_if_interrupted([&] { return ::fchmod(file, old.st_mode & 07777); }) != 0)
        error = errno;
    if (error == 0 && retry_if_interrupted([&] { return ::fsync(file); }) != 0) error = errno;
    if (const int fault = close_file(file); error == 0) error = fault;
    if (error == 0 && retry_if_interrupted([&] { return ::rename(temporary.c_str(), target.c_str()); }) != 0)
        error = errno;
    if (error != 0) {
        ::unlink(temporary.c_str());
        if (directory >= 0) ::close(directory);
        fail_of_file(path, "cannot be written", error);
    }
    if (directory < 0) return;
    error = sync_folder(directory);
    ::close(directory);
    if (error != 0) fail_of_file(path, "was written, but its folder cannot be synced", error);
}

void remove_abandoned(const std::string& directory) {
    namespace fs = std::filesystem;
    std::error_code fault;
    for (const std::string& name : names_in(directory, fault)) {
        if (!name.ends_with(temporary_ending)) continue;
        const fs::path path = fs::path(directory) / name;
        std::error_code none;
        if (!fs::is_regular_file(fs::symlink_status(path, none))) continue;
        const auto written = fs::last_write_time(path, none);
        if (none) continue;
        const double age = std::chrono::duration<double>(fs::file_time_type::clock::now() - written).count();
        if (is_abandoned(name, age)) ::unlink(path.c_str());
    }
}

void require_writable(const std::string& path) {
    const std::string target = target_of(path);
    struct stat old {};
    const bool exists = ::stat(target.c_str(), &old) == 0;
    if (exists && S_ISDIR(old.st_mode)) fail_of_file(path, "cannot be written", EISDIR);
    const std::string place = exists && !S_ISREG(old.st_mode) ? target : directory_of(target);
    if (::access(place.c_str(), W_OK) != 0) fail_of_file(path, "cannot be written", errno);
}

}  // namespace polhode
