// Writes files atomically: a reader sees either the old file or the complete new one.
#pragma once

#include <string>
#include <string_view>

namespace polhode {

/// Writes `text` to a temporary file beside `path`, syncs it and renames it to `path`. At any moment `path` is either
/// the old file or the complete new one, even if the process is killed or the machine loses power. Symbolic links are
/// followed. Terminals, pipes and other files that are not regular are written directly. Throws std::runtime_error
/// (one line with the path and the system's reason); the old file is then unchanged and the temporary removed, unless
/// only the final sync of the folder failed, in which case the new file is in place. A killed process leaves its
/// temporary file behind: see remove_abandoned().
void write_atomically(const std::string& path, std::string_view text);

/// Removes the temporary files that write_atomically() has left in this folder (not in its subfolders): those whose
/// process on this host has ended, and those from other hosts that are older than a day. Files that cannot be removed
/// are skipped.
void remove_abandoned(const std::string& directory);

/// Throws std::runtime_error if write_atomically(path, ..) could not start: the directory is missing or read-only, or
/// `path` is a directory.
void require_writable(const std::string& path);

/// Creates a temporary file beside `target`. Its name is unique among threads and processes and identifies the
/// writing process; its mode follows the umask. Returns a descriptor open for writing and sets `name`; returns -1
/// with errno set on failure.
int create_temporary(const std::string& target, std::string& name);

}  // namespace polhode
