// A table of named columns, and its writers. Independent of methods and scenes.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace polhode {

/// Empty (an undefined value), a word, a real number or a count.
using Cell = std::variant<std::monostate, std::string, double, long>;

/// A cell with the value, or an empty cell.
template <class T>
Cell cell_of(const std::optional<T>& value) {
    if (value) return *value;
    return {};
}

/// Named columns and rows of cells. Every writer throws std::invalid_argument for a table without columns and for a
/// row whose length differs from the header's. The machine-readable writers (csv, json) also throw for duplicate
/// column names.
struct Table {
    std::vector<std::string> columns;     ///< their names
    std::vector<std::vector<Cell>> rows;  ///< each as long as `columns`
};

/// The text of a cell in CSV before quoting: empty, text, or the shortest decimal that reads back to the same
/// binary64 ("nan", "inf" or "-inf" if not finite).
std::string text_of(const Cell& cell);

/// CSV after RFC 4180: a header line, then one line per row. Fields with a comma, quote or newline are quoted. Each
/// line ends in a line feed.
std::string csv(const Table& table);

/// Parses a table written by csv(); every non-empty cell becomes a string. Lines may also end in a carriage return
/// and a line feed, and the last line end may be missing. Throws std::invalid_argument with line and fault: no
/// header, duplicate column names, a row whose length differs from the header's, a quote inside a field or never
/// closed, text after a closing quote.
Table parse_csv(std::string_view text);

/// Parses CSV one record at a time, the header first, for texts too large to hold in memory as tables. `take` may
/// move from its argument.
void read_csv(std::string_view text, const std::function<void(std::vector<std::string>&)>& take);

/// A Markdown table for readers: real numbers to three significant digits, scientific outside [1e-3, 1e3); counts in
/// full; empty cells stay empty; number columns are aligned to the right. Text is shown literally: markup characters
/// are escaped.
std::string markdown(const Table& table);

/// A LaTeX longtable for a plain article with booktabs, longtable and siunitx: numbers to three significant digits,
/// small type, no wider than the text. If the table is too wide, constant columns move to the caption; then less
/// important columns and those at the right are dropped, and the caption names them. An empty caption or label is
/// omitted. The caption is text and is escaped; the label is used unchanged. Greek letters and mathematical symbols
/// become LaTeX commands.
std::string latex(const Table& table, const std::string& caption, const std::string& label);

/// A JSON array with one object per line. Real numbers as in the CSV; empty cells and numbers that are not finite are
/// null. Bytes that are not UTF-8 become U+FFFD.
std::string json(const Table& table);

/// A column of a table and its name in a selection.
struct ColumnChoice {
    std::string column;   ///< its name in the table
    std::string heading;  ///< its name in the result
};
/// The chosen columns in this order, renamed. Throws std::invalid_argument if a column does not exist.
Table select(const Table& table, const std::vector<ColumnChoice>& choices);

/// The index of a column by its name. Throws std::invalid_argument if it does not exist.
std::size_t column_index(const Table& table, std::string_view name);

/// Throws std::invalid_argument unless the table has a column and every row has as many cells as the header.
void require_rectangular(const Table& table);

}  // namespace polhode
