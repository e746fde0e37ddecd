// The Markdown writer.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <type_traits>

#include "table/markup.h"

namespace polhode {

namespace {

/// A number rounded to three significant digits, mantissa times 10^exponent, without trailing zeros in the mantissa.
struct Rounded {
    std::string mantissa;
    int exponent = 0;
};

void strip_trailing_zeros(std::string& decimal) {
    if (decimal.find('.') == std::string::npos) return;
    decimal.erase(decimal.find_last_not_of('0') + 1);
    if (decimal.back() == '.') decimal.pop_back();
}

Rounded rounded(double value) {
    const std::string text = fmt::format("{:.2e}", value);
    const std::size_t e = text.find('e');
    Rounded result{text.substr(0, e), std::stoi(text.substr(e + 1))};
    strip_trailing_zeros(result.mantissa);
    return result;
}

/// Plain decimals if the rounded number is in [1e-3, 1e3) or zero, else empty.
std::string plain_decimals(double value, const Rounded& number) {
    if (value == 0) return "0";
    if (number.exponent < -3 || number.exponent >= 3) return "";
    std::string text = fmt::format("{:.{}f}", value, 2 - number.exponent);
    strip_trailing_zeros(text);
    return text;
}

bool is_alphanumeric(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }
bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

/// Formats all cells: first the header, then the rows.
template <typename TextWriter, typename NumberWriter>
std::vector<std::vector<std::string>> written(const Table& table, TextWriter text, NumberWriter number) {
    std::vector<std::vector<std::string>> lines(1);
    for (const std::string& name : table.columns) lines[0].push_back(text(name));
    for (const std::vector<Cell>& row : table.rows) {
        std::vector<std::string>& line = lines.emplace_back();
        for (const Cell& cell : row) {
            const double* real = std::get_if<double>(&cell);
            line.push_back(real != nullptr ? number(*real) : text(text_of(cell)));
        }
    }
    return lines;
}

std::size_t width(const std::string& text) {
    const auto starts_character = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; };
    return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), starts_character));
}

}  // namespace

std::string markdown_text(const std::string& text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        const bool within_word =
            i > 0 && i + 1 < text.size() && is_alphanumeric(text[i - 1]) && is_alphanumeric(text[i + 1]);
        if (c == '\n') {
            out += "<br>";
        } else if (is_control(c)) {
            if (c == '\t') out += ' ';
        } else {
            if (std::string_view("\\|`*<&[]~$").find(c) != std::string_view::npos || (c == '_' && !within_word)) {
                out += '\\';
            }
            out += c;
        }
    }
    return out;
}

std::string format_readable_number(double value) {
    if (!std::isfinite(value)) return text_of(value);
    const Rounded number = rounded(value);
    const std::string plain = plain_decimals(value, number);
    return plain.empty() ? fmt::format("{}e{}", number.mantissa, number.exponent) : plain;
}

std::vector<bool> number_columns(const Table& table) {
    std::vector<bool> numbers(table.columns.size(), false);
    for (std::size_t column = 0; column < numbers.size(); ++column) {
        bool text = false, number = false;
        for (const std::vector<Cell>& row : table.rows) {
            const Cell& cell = row[column];
            text = text || std::holds_alternative<std::string>(cell);
            number = number || std::holds_alternative<double>(cell) || std::holds_alternative<long>(cell);
        }
        numbers[column] = number && !text;
    }
    return numbers;
}

std::string markdown(const Table& table) {
    require_rectangular(table);
    const auto lines = written(table, markdown_text, format_readable_number);
    const std::vector<bool> right = number_columns(table);
    std::vector<std::size_t> widths(table.columns.size(), 3);
    for (const auto& line : lines) {
        for (std::size_t column = 0; column < line.size(); ++column) {
            widths[column] = std::max(widths[column], width(line[column]));
        }
    }
    std::string out;
    for (std::size_t row = 0; row < lines.size(); ++row) {
        for (std::size_t column = 0; column < widths.size(); ++column) {
            const std::string& cell = lines[row][column];
            const std::string padding(widths[column] - width(cell), ' ');
            out += "| " + (right[column] ? padding + cell : cell + padding) + ' ';
        }
        out += "|\n";
        if (row > 0) continue;
        for (std::size_t column = 0; column < widths.size(); ++column) {
            const std::string rule(widths[column] - (right[column] ? 1 : 0), '-');
            out += "| " + rule + (right[column] ? ": " : " ");
        }
        out += "|\n";
    }
    return out;
}

}  // namespace polhode
