// A file that is read piece by piece, opened only where it is one to be read.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "text/named_file.h"

namespace polhode {

/// An open file. Whatever is wrong with it is an InputError that calls it `called` and asks for what was `expected`.
class InputFile {
  public:
    /// Opens `path`: a device, a socket, a directory or a FIFO is refused without waiting for it.
    InputFile(const std::string& path, std::string called, std::string expected, FileKinds kinds);
    ~InputFile();
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;

    /// In bytes; nothing where it is no regular file.
    const std::optional<std::size_t>& size() const { return size_; }
    /// The next bytes, at most `count`: how many there were, 0 at the end alone. Throws InputError.
    std::size_t read(char* bytes, std::size_t count);
    /// The next `count` bytes: how many there were, fewer at the end alone. Throws InputError.
    std::size_t read_fully(char* bytes, std::size_t count);
    /// Goes on at an offset from the beginning of a regular file. Throws InputError.
    void seek(std::size_t offset);
    /// Throws InputError: what is wrong with the file.
    [[noreturn]] void refuse(const std::string& fault) const;

  private:
    std::string called_, expected_;
    int descriptor_ = -1;
    std::optional<std::size_t> size_;
};

}  // namespace polhode
