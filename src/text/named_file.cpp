#include "text/named_file.h"

#include <fmt/format.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>

#include "text/input_file.h"
#include "text/message.h"

namespace polhode {
namespace {

std::atomic<bool> outside_is_allowed{false};

std::string real_path(const std::string& path) {
    const std::unique_ptr<char, decltype(&std::free)> real(::realpath(path.c_str(), nullptr), &std::free);
    return real ? std::string(real.get()) : std::string();
}

[[noreturn]] void refuse_outside(const std::string& path) {
    throw InputError(path, "", "is outside the folder of the file that refers to it",
                     "move it there, or permit it by --allow-outside (in C++ and Python allow_outside_files)");
}

}  // namespace

void allow_outside_files(bool allowed) { outside_is_allowed = allowed; }

std::string path_in(const std::string& folder, const std::string& name) {
    return folder.empty() || name.starts_with('/') ? name : folder + '/' + name;
}

std::string path_inside(const std::string& folder, const std::string& name) {
    const std::string path = path_in(folder, name);
    // an absolute path is refused even if it leads into the folder
    if (name.starts_with('/') && !outside_is_allowed) refuse_outside(path);
    require_inside(folder, path);
    return real_path(path);
}

void require_inside(const std::string& folder, const std::string& path) {
    if (path.find('\0') != std::string::npos)
        throw InputError(path, "", "contains a zero byte", "give the path of a file");
    const std::string real = real_path(path);
    if (real.empty())
        throw InputError(path, "", fmt::format("cannot be opened: {}", std::strerror(errno)),
                         "give the path of an existing file");
    std::string within = real_path(folder.empty() ? "." : folder);
    if (!within.ends_with('/')) within += '/';
    if (!outside_is_allowed && !real.starts_with(within)) refuse_outside(path);
}

std::string read_named_text(const std::string& folder, const std::string& name, std::size_t largest,
                            const char* expected) {
    return read_whole_file(path_inside(folder, name), path_in(folder, name), largest, expected, FileKinds::regular);
}

std::string read_whole_file(const std::string& path, const std::string& display_name, std::size_t largest,
                            const char* expected, FileKinds kinds) {
    InputFile file(path, display_name, expected, kinds);
    const auto refuse_size = [&] {
        file.refuse(largest >> 20 > 0 ? fmt::format("is larger than {} MiB", largest >> 20)
                                      : fmt::format("is larger than {} bytes", largest));
    };
    std::string text;
    // reserve memory if the size is known; the file may still grow, but not beyond the limit
    if (const std::optional<std::size_t> size = file.size()) {
        if (*size > largest) refuse_size();
        text.reserve(*size);
    }
    char block[1 << 16];
    for (;;) {
        const std::size_t count = file.read(block, sizeof block);
        if (count == 0) return text;
        text.append(block, count);
        if (text.size() > largest) refuse_size();
    }
}

}  // namespace polhode
