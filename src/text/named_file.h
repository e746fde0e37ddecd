// Files that are named in files, and what may be opened at all: a file from a stranger reads only what lies beside it.
#pragma once

#include <cstddef>
#include <string>

namespace polhode {

/// Whether files may name files outside their own folders: not unless a program's user allows it. It holds for the
/// whole process and any thread.
void allow_outside_files(bool allowed);
/// What allow_outside_files() said last.
bool outside_files_are_allowed();

/// The path of a file as another one names it, whose folder is `folder` (empty: the working directory).
std::string path_in(const std::string& folder, const std::string& name);

/// The file's real path, all symbolic links followed. Throws InputError where it cannot be had, with the system's
/// reason (missing, links in a circle), and where it leads out of the folder and that is not allowed: an absolute
/// path, "..", or a link.
std::string path_inside(const std::string& folder, const std::string& name);

/// Throws as path_inside() where `path`, by itself or by the working directory, leads out of the folder.
void require_inside(const std::string& folder, const std::string& path);

/// The text of a file that another file names, as by path_inside(): only of a regular file, of at most `largest` bytes.
/// Throws InputError; the remedy names what was `expected`.
std::string read_named_text(const std::string& folder, const std::string& name, std::size_t largest,
                            const char* expected);

/// What a file that is opened may be.
enum class FileKinds {
    regular,   ///< a regular file
    streamed,  ///< also what a shell hands over in /dev or /proc: a pipe, a terminal, /dev/null
};

/// The text of a file, of at most `largest` bytes: a device, a socket, a directory or a FIFO is refused without
/// waiting for it. Throws InputError, in which the file is called `called`; the remedy names what was `expected`.
std::string read_whole_file(const std::string& path, const std::string& called, std::size_t largest,
                            const char* expected, FileKinds kinds);

}  // namespace polhode
