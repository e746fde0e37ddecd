// Writes a file atomically in pieces.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace polhode {

/// Provides the guarantees of write_atomically() (text/atomic_file.h) for content that is never in memory as a whole.
/// The content goes to a temporary file beside `path`, which commit() syncs and renames. Without commit() the old
/// file is unchanged and no temporary file is left. Terminals, pipes and other files that are not regular are written
/// directly. All members throw std::runtime_error (one line with the path and the system's reason).
class AtomicStream {
  public:
    /// Creates the temporary file.
    explicit AtomicStream(std::string path);
    ~AtomicStream();
    AtomicStream(const AtomicStream&) = delete;
    AtomicStream& operator=(const AtomicStream&) = delete;

    /// Whether written bytes can be overwritten: false for a terminal or a pipe.
    bool is_regular() const { return !temporary_.empty(); }
    /// Appends `bytes`.
    void write(std::string_view bytes);
    /// Overwrites the first bytes of a regular file. At least as many bytes must have been written before.
    void write_over_beginning(std::string_view bytes);
    /// Puts the file in place. No further writes are allowed.
    void commit();

  private:
    std::string folder() const;
    [[noreturn]] void fail(const char* what, int error) const;
    void write_at(std::string_view bytes, std::size_t* offset);

    std::string path_, target_, temporary_;
    int file_ = -1;
    bool committed_ = false;
    std::size_t started_ = 0, written_ = 0;  // bytes: passed to the disk so far, and in total
};

}  // namespace polhode
