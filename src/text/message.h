// One-line error messages: escaping and shortening of quoted user text, and suggestions for misspelt words.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace polhode {

/// An error in a scene, experiment or table: its place (a JSON pointer, or line and column), the fault and the
/// remedy. what() is one line: "FILE: PLACE: FAULT; REMEDY".
class InputError : public std::runtime_error {
  public:
    /// Formats "FILE: PLACE: FAULT; REMEDY"; an empty place is omitted.
    InputError(const std::string& file, const std::string& place, const std::string& fault, const std::string& remedy);
    /// An error in a file that `file` refers to at `place`: "FILE: PLACE: " followed by the inner error's line.
    InputError(const std::string& file, const std::string& place, const InputError& inner);

    /// Place of the error in its file; empty for the whole file.
    const std::string& place() const { return place_; }
    /// The same fault and remedy at another place.
    InputError relocate(const std::string& file, const std::string& place) const;

  private:
    struct Rest {
        std::string text;  ///< fault and remedy
    };
    InputError(const std::string& file, const std::string& place, Rest rest);

    std::string place_;
    Rest rest_;
};

/// Makes `text` safe for one line of a terminal. Control characters, line separators and bytes that are not UTF-8 are
/// escaped as a backslash and a letter or hexadecimal digits. The result has at most `limit` bytes; "..." replaces
/// the middle of a longer text.
std::string one_line(std::string_view text, std::size_t limit);

/// Offset of the first byte that does not continue UTF-8 (RFC 3629: no surrogates, no overlong forms), or npos.
std::size_t first_invalid_utf8(std::string_view text);

/// The candidates close to `word`, nearest first, at most three. A candidate is close if one word contains the other
/// or if their edit distance is at most a third of the longer length; distances more than 1 above the smallest are
/// dropped.
std::vector<std::string> near_misses(std::string_view word, const std::vector<std::string>& candidates);

/// "did you mean a or b?" with the near misses among the candidates; an empty text if there are none.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

/// The words joined by commas: "a, b, c".
std::string join_with_commas(const std::vector<std::string>& words);

}  // namespace polhode
