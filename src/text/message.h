// Text of the user's own inside one-line messages: escaped, shortened, compared with what could have been meant.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace polhode {

/// A fault in a scene, experiment or table: where it is (a JSON pointer, or line and column), what is wrong and what
/// would be right. what() is one line: "FILE: PLACE: FAULT; REMEDY".
class InputError : public std::runtime_error {
  public:
    /// Says "FILE: PLACE: FAULT; REMEDY"; an empty place is left out.
    InputError(const std::string& file, const std::string& place, const std::string& fault, const std::string& remedy);
    /// A fault in what `file` brings in at `place`: "FILE: PLACE: " and the fault's own line.
    InputError(const std::string& file, const std::string& place, const InputError& inner);

    /// Where the fault is in its file; empty for the whole file.
    const std::string& place() const { return place_; }
    /// The same fault and remedy at another place.
    InputError moved_to(const std::string& file, const std::string& place) const;

  private:
    struct Rest {
        std::string text;  ///< fault and remedy
    };
    InputError(const std::string& file, const std::string& place, Rest rest);

    std::string place_;
    Rest rest_;
};

/// `text` fit for one line on a terminal: control characters, line separators and bytes that are not UTF-8 escaped
/// as a backslash and a letter or hexadecimal digits, and of `limit` bytes at the most: "..." stands for the middle of
/// a longer one.
std::string one_line(std::string_view text, std::size_t limit);

/// Offset of the first byte that does not continue UTF-8 (RFC 3629: no surrogates, no overlong forms), or npos.
std::size_t first_invalid_utf8(std::string_view text);

/// The candidates a slip of the hand or two away from `word`, nearest first, three at the most: an edit distance of
/// up to a third of the longer one and no more than one beyond the nearest, or one contained in the other.
std::vector<std::string> near_misses(std::string_view word, const std::vector<std::string>& candidates);

/// "did you mean a or b?" of the near misses among the candidates; an empty text where there are none.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

/// The words with commas between them: "a, b, c".
std::string listed(const std::vector<std::string>& words);

}  // namespace polhode
