// A file that is read piece by piece. Unsuitable files (devices, sockets, directories) are refused at opening.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "text/named_file.h"

namespace polhode {

/// An open file. Errors are InputError; they name the file as `called` and state the `expected` kind of file.
class InputFile {
  public:
    /// Opens `path`. Refuses a device, a socket, a directory or a FIFO without blocking on it.
    InputFile(const std::string& path, std::string display_name, std::string expected, FileKinds kinds);
    ~InputFile();
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;

    /// Size in bytes; nothing for a file that is not regular.
    const std::optional<std::size_t>& size() const { return size_; }
    /// Reads the next bytes, at most `count`. Returns their number, 0 only at the end. Throws InputError.
    std::size_t read(char* bytes, std::size_t count);
    /// Reads the next `count` bytes. Returns their number, which is smaller only at the end. Throws InputError.
    std::size_t read_fully(char* bytes, std::size_t count);
    /// Continues at an offset from the start of a regular file. Throws InputError.
    void seek(std::size_t offset);
    /// Throws InputError with this fault of the file.
    [[noreturn]] void refuse(const std::string& fault) const;

  private:
    std::string display_name_, expected_;
    int descriptor_ = -1;
    std::optional<std::size_t> size_;
};

}  // namespace polhode
