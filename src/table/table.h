// A table of named columns, and its writers. Knows nothing of methods or scenes.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace polhode {

/// Empty (a number that does not exist), a word, a real number or a count.
using Cell = std::variant<std::monostate, std::string, double, long>;

/// A cell with the value, or an empty one where there is none.
template <class T>
Cell cell_of(const std::optional<T>& value) {
    if (value) return *value;
    return {};
}

/// Named columns and rows of cells. Every writer throws std::invalid_argument for a table without columns and for a row
/// that is not as long as the header; those for machines (csv, json) also for two columns of one name.
struct Table {
    std::vector<std::string> columns;     ///< their names
    std::vector<std::vector<Cell>> rows;  ///< each as long as `columns`
};

/// A cell as the CSV has it: empty, text (not quoted yet), shortest decimals that read back to the same binary64
/// ("nan", "inf" and "-inf" where it is not finite).
std::string text_of(const Cell& cell);

/// RFC 4180: a header line, then one line a row; fields with comma, quote or newline are quoted. Each line ends in a
/// line feed.
std::string csv(const Table& table);

/// The table that csv() wrote; every non-empty cell a string. Lines may also end in a carriage return and a line feed,
/// the last one in nothing. Throws std::invalid_argument with line and fault: no header, two columns of one name, a row
/// of another length than the header, a quote inside a field or never closed, text behind a closing quote.
Table parse_csv(std::string_view text);

/// The same a record at a time, the header first: for texts too long to stand in memory as tables. `take` may keep what
/// it is given.
void read_csv(std::string_view text, const std::function<void(std::vector<std::string>&)>& take);

/// For people: real numbers to three significant digits, scientific outside [1e-3, 1e3), counts in full, empty cells
/// as they are, columns of numbers aligned to the right. Text shows literally: what the format would take as markup is
/// escaped.
std::string markdown(const Table& table);

/// A longtable for a plain article that uses booktabs, longtable and siunitx: numbers to three significant digits, in
/// small type, no wider than the text. Of a table that would be, columns that have one value throughout are told in the
/// caption; then the lesser ones, and those at the right, are left to the CSV, and the caption says which. An empty
/// caption or label is left out. The caption is text, the label stays as it is given. Greek letters and the field's
/// signs become LaTeX commands.
std::string latex(const Table& table, const std::string& caption, const std::string& label);

/// An array of objects, one a line; real numbers as in the CSV; empty cells and numbers that are not finite are null.
/// Bytes that are not UTF-8 become U+FFFD.
std::string json(const Table& table);

/// A column of a table and what it is to be called in another.
struct ColumnChoice {
    std::string column;   ///< its name in the table
    std::string heading;  ///< its name in the result
};
/// Only these columns, in this order, under these headings. Throws std::invalid_argument where one is missing.
Table select(const Table& table, const std::vector<ColumnChoice>& choices);

/// The index of a column by its name. Throws std::invalid_argument where there is none.
std::size_t column_index(const Table& table, std::string_view name);

/// Throws std::invalid_argument unless the table has a column and every row is as long as the header.
void require_rectangular(const Table& table);

}  // namespace polhode
