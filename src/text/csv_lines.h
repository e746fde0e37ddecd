// The lines and cells of a CSV file, read strictly: what trajectory files and ensemble tables share.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace polhode {

/// A text line by line, each cut into cells at its commas, spaces around a cell left out. Lines may end in \r\n, a byte
/// order mark may stand in front, `#` begins a comment line. Throws InputError: a blank line between others, a zero
/// byte, a line of more than 64 KiB.
class CsvLines {
  public:
    /// Writes the text's next bytes, at most `count`, to `bytes`: how many there were, 0 at the end alone.
    using Source = std::function<std::size_t(char* bytes, std::size_t count)>;

    /// Both outlive this; `file` is named in errors.
    CsvLines(std::string_view text, const std::string& file);
    /// A text of any length, of which some hundred KiB are held at a time.
    CsvLines(Source source, const std::string& file);
    CsvLines(const CsvLines&) = delete;
    CsvLines& operator=(const CsvLines&) = delete;

    /// The next line that is no comment; false at the end.
    bool next();

    /// The number of the line at hand, from 1.
    long number() const { return number_; }
    /// The cells of the line at hand, good until next() is called again.
    const std::vector<std::string_view>& cells() const { return cells_; }
    /// About how many lines are left with this one, of the text that is held, if all are as long.
    std::size_t rows_left() const { return rest_.size() / (line_.size() + 1) + 2; }
    /// What was read past, "line 1 begins with a byte order mark", or an empty text.
    const std::string& read_past() const { return read_past_; }

    /// Takes the line at hand for a header and gives the place in `names` of each cell. Throws InputError: semicolons
    /// or tabs for commas, a name that is none of them, or one given twice.
    std::vector<std::size_t> header(const std::vector<std::string>& names) const;

  private:
    void refuse_other_separators() const;
    void note(const std::string& what) { read_past_ += (read_past_.empty() ? "" : ", ") + what; }
    void read_past_mark();
    bool refill();
    bool nothing_is_left();
    void split();

    Source source_;
    std::string held_;  // what the source has given last, and the beginning of a line before it
    std::string_view rest_, line_;
    const std::string& file_;
    long number_ = 0;
    bool returns_ = false;  // a line ended in \r\n
    std::vector<std::string_view> cells_;
    std::string read_past_;
};

}  // namespace polhode
