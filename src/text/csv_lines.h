// Strict reader of the lines and cells of a CSV file, shared by trajectory files and ensemble tables.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace polhode {

/// Reads a text line by line and splits each line into cells at its commas; spaces around cells are stripped. Lines
/// may end in \r\n, the text may begin with a byte order mark, and `#` begins a comment line. Throws InputError for a
/// blank line between others, a zero byte, or a line longer than 64 KiB.
class CsvLines {
  public:
    /// Writes the text's next bytes, at most `count`, to `bytes` and returns their number; 0 only at the end.
    using Source = std::function<std::size_t(char* bytes, std::size_t count)>;

    /// Both arguments must outlive this object; `file` is named in errors.
    CsvLines(std::string_view text, const std::string& file);
    /// For a text of any length; only some hundred KiB are held in memory at a time.
    CsvLines(Source source, const std::string& file);
    CsvLines(const CsvLines&) = delete;
    CsvLines& operator=(const CsvLines&) = delete;

    /// Moves to the next line that is not a comment. Returns false at the end.
    bool next();

    /// The number of the current line, from 1.
    long number() const { return number_; }
    /// The cells of the current line, valid until the next call of next().
    const std::vector<std::string_view>& cells() const { return cells_; }
    /// Estimated number of remaining lines in the text held in memory, the current line included, assuming equal
    /// lengths.
    std::size_t rows_left() const { return rest_.size() / (line_.size() + 1) + 2; }
    /// What was tolerated and skipped ("line 1 begins with a byte order mark"), or an empty text.
    const std::string& skipped_content() const { return skipped_content_; }

    /// Parses the current line as a header and returns the index in `names` of each cell. Throws InputError for
    /// semicolons or tabs in place of commas, an unknown name, or a name given twice.
    std::vector<std::size_t> header(const std::vector<std::string>& names) const;

  private:
    void refuse_other_separators() const;
    void note(const std::string& what) { skipped_content_ += (skipped_content_.empty() ? "" : ", ") + what; }
    void skip_byte_order_mark();
    bool refill();
    bool is_exhausted();
    void split();

    Source source_;
    std::string held_;  // the unread part of the last block, and the next block
    std::string_view rest_, line_;
    const std::string& file_;
    long number_ = 0;
    bool has_carriage_returns_ = false;  // a line ended in \r\n
    std::vector<std::string_view> cells_;
    std::string skipped_content_;
};

}  // namespace polhode
