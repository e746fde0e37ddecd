// Files that are there whole or not at all.
#pragma once

#include <string>
#include <string_view>

namespace polhode {

/// Writes `text` to a temporary file beside `path`, syncs it and renames it to `path`: at any moment `path` is the old
/// file or the new one, whatever happens to the process or the machine. A symbolic link is followed; what is no
/// regular file (a terminal, a pipe) is written directly. Throws std::runtime_error (one line, with the path and the
/// system's reason) and leaves the old file as it was, and no temporary; only where the folder cannot be synced at the
/// end is the new file there. A process that is killed leaves its temporary: remove_abandoned().
void write_atomically(const std::string& path, std::string_view text);

/// Removes the temporaries that write_atomically() has left in this folder, not in those within: of processes of this
/// host that are no more, and of other hosts where they are older than a day. What cannot be removed stays.
void remove_abandoned(const std::string& directory);

/// Throws std::runtime_error where write_atomically(path, ..) could not even begin: a missing or read-only directory,
/// or `path` a directory.
void require_writable(const std::string& path);

/// A new temporary file beside `target`, under a name that no other thread or process has and that tells who writes it;
/// the process's mask gives its mode. Its descriptor, for writing, and `name`; or -1 with errno set.
int create_temporary(const std::string& target, std::string& name);

}  // namespace polhode
