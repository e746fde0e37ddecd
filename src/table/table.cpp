// Table: CSV writer and reader (RFC 4180), JSON writer, selection of columns. The Markdown and LaTeX writers are in
// table_markup.cpp and table_latex.cpp. CsvReader scans the whole text and counts lines for
// its errors; read_csv() passes on its records one at a time.

#include "table/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <type_traits>

#include "text/decimal.h"

namespace polhode {

namespace {

/// Quotes input text in a one-line message.
std::string shown(std::string_view text) {
    std::string line(text.substr(0, 60));
    for (char& c : line)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
    return text.size() > 60 ? line + "..." : line;
}

/// The first name that occurs twice, if any.
std::optional<std::string> repeated_name(const std::vector<std::string>& columns) {
    std::set<std::string_view> seen;
    for (const std::string& name : columns) {
        if (!seen.insert(name).second) return name;
    }
    return std::nullopt;
}

void require_distinct_names(const Table& table) {
    if (const auto name = repeated_name(table.columns)) {
        throw std::invalid_argument(fmt::format("a table has two columns named '{}'", *name));
    }
}

void append_csv_field(std::string& out, const std::string& field) {
    if (field.find_first_of(",\"\r\n") == std::string::npos) {
        out += field;
        return;
    }
    out += '"';
    for (const char c : field) {
        if (c == '"') out += '"';
        out += c;
    }
    out += '"';
}

/// Parses fields and records of CSV text and counts lines.
class CsvReader {
  public:
    explicit CsvReader(std::string_view text) : text_(text) {}

    bool at_end() const { return place_ == text_.size(); }
    int line() const { return line_; }

    /// Consumes a record and returns its fields.
    std::vector<std::string> record() {
        std::vector<std::string> fields;
        do {
            fields.push_back(!at_end() && text_[place_] == '"' ? quoted_field() : plain_field());
        } while (take(","));
        if (!at_end() && !take("\n") && !take("\r\n")) fault(line_, "there is text behind a closing quote");
        ++line_;
        return fields;
    }

    [[noreturn]] static void fault(int line, const std::string& what) {
        throw std::invalid_argument(fmt::format("line {}: {}", line, what));
    }

  private:
    bool take(std::string_view expected) {
        if (text_.substr(place_, expected.size()) != expected) return false;
        place_ += expected.size();
        return true;
    }

    std::string plain_field() {
        const std::size_t begin = place_;
        place_ = std::min(text_.find_first_of(",\n", begin), text_.size());
        // a carriage return is part of the line end
        if (!at_end() && text_[place_] == '\n' && place_ > begin && text_[place_ - 1] == '\r') --place_;
        std::string field(text_.substr(begin, place_ - begin));
        if (field.find('"') != std::string::npos) {
            fault(line_, fmt::format("a quote inside the unquoted field '{}'", shown(field)));
        }
        return field;
    }

    std::string quoted_field() {
        const int opened = line_;
        std::string field;
        for (++place_; !at_end(); ++place_) {
            const char c = text_[place_];
            if (c == '"') {
                ++place_;
                if (at_end() || text_[place_] != '"') return field;
            }
            if (c == '\n') ++line_;
            field += c;
        }
        fault(opened, "a quote is opened and never closed");
    }

    std::string_view text_;
    std::size_t place_ = 0;
    int line_ = 1;
};

}  // namespace

void require_rectangular(const Table& table) {
    if (table.columns.empty()) throw std::invalid_argument("a table has no columns");
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        if (table.rows[row].size() == table.columns.size()) continue;
        throw std::invalid_argument(fmt::format("row {} of a table has {} cells under {} columns", row + 1,
                                                table.rows[row].size(), table.columns.size()));
    }
}

std::string text_of(const Cell& cell) {
    return std::visit(
        [](const auto& value) -> std::string {
            using Value = std::decay_t<decltype(value)>;
            if constexpr (std::is_same_v<Value, std::monostate>) {
                return "";
            } else if constexpr (std::is_same_v<Value, std::string>) {
                return value;
            } else if constexpr (std::is_same_v<Value, double>) {
                return std::isnan(value) ? "nan" : shortest_decimal(value);  // the sign of a NaN has no meaning
            } else {
                return std::to_string(value);
            }
        },
        cell);
}

std::string csv(const Table& table) {
    require_rectangular(table);
    require_distinct_names(table);
    std::string out;
    for (std::size_t column = 0; column < table.columns.size(); ++column) {
        if (column > 0) out += ',';
        append_csv_field(out, table.columns[column]);
    }
    out += '\n';
    for (const std::vector<Cell>& row : table.rows) {
        for (std::size_t column = 0; column < row.size(); ++column) {
            if (column > 0) out += ',';
            append_csv_field(out, text_of(row[column]));
        }
        out += '\n';
    }
    return out;
}

void read_csv(std::string_view text, const std::function<void(std::vector<std::string>&)>& take) {
    CsvReader reader(text);
    if (reader.at_end()) CsvReader::fault(1, "there is no header");
    std::vector<std::string> fields = reader.record();
    const std::size_t columns = fields.size();
    if (const auto name = repeated_name(fields)) {
        CsvReader::fault(1, fmt::format("two columns are named '{}'", shown(*name)));
    }
    take(fields);
    while (!reader.at_end()) {
        const int line = reader.line();
        fields = reader.record();
        if (fields.size() != columns) {
            CsvReader::fault(line, fmt::format("{} field{} under {} column{}", fields.size(),
                                               fields.size() == 1 ? "" : "s", columns, columns == 1 ? "" : "s"));
        }
        take(fields);
    }
}

Table parse_csv(std::string_view text) {
    Table table;
    read_csv(text, [&](std::vector<std::string>& fields) {
        if (table.columns.empty()) {
            table.columns = std::move(fields);
            return;
        }
        std::vector<Cell>& row = table.rows.emplace_back();
        for (std::string& field : fields) {
            if (field.empty()) {
                row.emplace_back();
            } else {
                row.emplace_back(std::move(field));
            }
        }
    });
    return table;
}

std::string json(const Table& table) {
    require_rectangular(table);
    require_distinct_names(table);
    const auto quoted = [](const std::string& text) {
        return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    };
    std::string out = "[";
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        out += row > 0 ? ",\n {" : "\n {";
        for (std::size_t column = 0; column < table.columns.size(); ++column) {
            const Cell& cell = table.rows[row][column];
            const double* number = std::get_if<double>(&cell);
            if (column > 0) out += ", ";
            out += quoted(table.columns[column]) + ": ";
            if (std::holds_alternative<std::string>(cell)) {
                out += quoted(text_of(cell));
            } else if (std::holds_alternative<std::monostate>(cell) || (number != nullptr && !std::isfinite(*number))) {
                out += "null";
            } else {
                out += text_of(cell);
            }
        }
        out += '}';
    }
    out += "\n]\n";
    return out;
}

Table select(const Table& table, const std::vector<ColumnChoice>& choices) {
    require_rectangular(table);
    Table chosen;
    std::vector<std::size_t> indices;
    for (const ColumnChoice& choice : choices) {
        indices.push_back(column_index(table, choice.column));
        chosen.columns.push_back(choice.heading);
    }
    for (const std::vector<Cell>& row : table.rows) {
        std::vector<Cell>& cells = chosen.rows.emplace_back();
        for (const std::size_t index : indices) cells.push_back(row[index]);
    }
    return chosen;
}

std::size_t column_index(const Table& table, std::string_view name) {
    const auto found = std::find(table.columns.begin(), table.columns.end(), name);
    if (found == table.columns.end()) {
        throw std::invalid_argument(
            fmt::format("there is no column '{}' among '{}'", name, fmt::join(table.columns, "', '")));
    }
    return static_cast<std::size_t>(found - table.columns.begin());
}

}  // namespace polhode
