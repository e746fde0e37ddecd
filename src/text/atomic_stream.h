// Files that are there whole or not at all, written piece by piece.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace polhode {

/// What write_atomically (text/atomic_file.h) does, for a content that is never held whole: it grows in a temporary
/// file beside `path`, which is synced and renamed by commit(). Without commit() the old file stays, and nothing is
/// left behind. What is no regular file (a terminal, a pipe) is written directly. All members throw std::runtime_error
/// (one line, with the path and the system's reason).
class AtomicStream {
  public:
    /// Creates the temporary file.
    explicit AtomicStream(std::string path);
    ~AtomicStream();
    AtomicStream(const AtomicStream&) = delete;
    AtomicStream& operator=(const AtomicStream&) = delete;

    /// Whether what was written can be written over: false for a terminal or a pipe.
    bool is_regular() const { return !temporary_.empty(); }
    /// Appends.
    void write(std::string_view bytes);
    /// Writes over the first bytes of a regular file, as many as were written at least.
    void write_over_beginning(std::string_view bytes);
    /// Puts the file into its place; nothing may be written any more.
    void commit();

  private:
    std::string folder() const;
    [[noreturn]] void fail(const char* what, int error) const;
    void write_at(std::string_view bytes, std::size_t* offset);

    std::string path_, target_, temporary_;
    int file_ = -1;
    bool committed_ = false;
    std::size_t started_ = 0, written_ = 0;  // in bytes: handed to the disk, and in all
};

}  // namespace polhode
