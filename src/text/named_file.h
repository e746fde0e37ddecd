// Files that are named in other files, and which files may be opened. An untrusted file can only name files in its
// own folder or below.
#pragma once

#include <cstddef>
#include <string>

namespace polhode {

/// Sets whether files may name files outside their own folders (default: no). Applies to the whole process.
/// Thread-safe.
void allow_outside_files(bool allowed);

/// The path of a file that is named in a file in `folder` (empty: the working directory).
std::string path_in(const std::string& folder, const std::string& name);

/// The file's real path with all symbolic links resolved. Throws InputError if it cannot be resolved (missing, a link
/// cycle), with the system's reason, or if it leads out of the folder without permission: an absolute path, "..", or
/// a link.
std::string path_inside(const std::string& folder, const std::string& name);

/// Throws like path_inside() if `path` (relative to the working directory) leads out of the folder.
void require_inside(const std::string& folder, const std::string& path);

/// The text of a file that another file names, located by path_inside(). It must be a regular file of at most
/// `largest` bytes. Throws InputError; the remedy names what was `expected`.
std::string read_named_text(const std::string& folder, const std::string& name, std::size_t largest,
                            const char* expected);

/// Kinds of files that may be opened.
enum class FileKinds {
    regular,   ///< a regular file
    streamed,  ///< also what a shell passes in /dev or /proc: a pipe, a terminal, /dev/null
};

/// The text of a file of at most `largest` bytes. Refuses a device, a socket, a directory or a FIFO without blocking
/// on it. Throws InputError that names the file as `called` and, in the remedy, what was `expected`.
std::string read_whole_file(const std::string& path, const std::string& display_name, std::size_t largest,
                            const char* expected, FileKinds kinds);

}  // namespace polhode
