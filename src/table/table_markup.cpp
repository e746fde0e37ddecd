// The writers for people: Markdown and LaTeX.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <map>
#include <type_traits>

#include "table/table.h"

namespace polhode {

namespace {

/// A number rounded to three significant digits, mantissa times 10^exponent, with no zeros at the mantissa's end.
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
    Rounded result{text.substr(0, e), std::atoi(text.c_str() + e + 1)};
    strip_trailing_zeros(result.mantissa);
    return result;
}

/// The rounded number in plain decimals where it is in [1e-3, 1e3) or zero, else empty.
std::string plain_decimals(double value, const Rounded& number) {
    if (value == 0) return "0";
    if (number.exponent < -3 || number.exponent >= 3) return "";
    std::string text = fmt::format("{:.{}f}", value, 2 - number.exponent);
    strip_trailing_zeros(text);
    return text;
}

bool is_alphanumeric(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }
bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

/// Characters that GitHub's Markdown may take as markup are escaped; an underscore within a word is none.
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

std::string markdown_number(double value) {
    if (!std::isfinite(value)) return text_of(value);
    const Rounded number = rounded(value);
    const std::string plain = plain_decimals(value, number);
    return plain.empty() ? fmt::format("{}e{}", number.mantissa, number.exponent) : plain;
}

/// What pdfLaTeX's standard set-up cannot take as a character, though captions and messages of this field use it.
const std::map<std::string_view, std::string_view>& latex_signs() {
    static const std::map<std::string_view, std::string_view> signs = {
        {"α", "\\alpha"},  {"β", "\\beta"},    {"γ", "\\gamma"},   {"δ", "\\delta"},  {"ε", "\\varepsilon"},
        {"ζ", "\\zeta"},   {"η", "\\eta"},     {"θ", "\\theta"},   {"ι", "\\iota"},   {"κ", "\\kappa"},
        {"λ", "\\lambda"}, {"μ", "\\mu"},      {"µ", "\\mu"},      {"ν", "\\nu"},     {"ξ", "\\xi"},
        {"π", "\\pi"},     {"ρ", "\\rho"},     {"σ", "\\sigma"},   {"τ", "\\tau"},    {"υ", "\\upsilon"},
        {"φ", "\\varphi"}, {"χ", "\\chi"},     {"ψ", "\\psi"},     {"ω", "\\omega"},  {"Γ", "\\Gamma"},
        {"Δ", "\\Delta"},  {"Θ", "\\Theta"},   {"Λ", "\\Lambda"},  {"Ξ", "\\Xi"},     {"Π", "\\Pi"},
        {"Σ", "\\Sigma"},  {"Φ", "\\Phi"},     {"Ψ", "\\Psi"},     {"Ω", "\\Omega"},  {"×", "\\times"},
        {"·", "\\cdot"},   {"±", "\\pm"},      {"−", "-"},         {"≤", "\\le"},     {"≥", "\\ge"},
        {"≠", "\\neq"},    {"≈", "\\approx"},  {"∞", "\\infty"},   {"√", "\\surd"},   {"∫", "\\int"},
        {"‖", "\\Vert"},   {"°", "{}^\\circ"}, {"½", "\\frac12"},  {"⊗", "\\otimes"}, {"→", "\\to"},
        {"∈", "\\in"},     {"²", "{}^2"},      {"³", "{}^3"},      {"⁴", "{}^4"},     {"⁻", "{}^-"},
        {"¹", "{}^1"},     {"⁰", "{}^0"},      {"⁵", "{}^5"},      {"⁶", "{}^6"},     {"⁷", "{}^7"},
        {"⁸", "{}^8"},     {"⁹", "{}^9"},      {"∂", "\\partial"}, {"∝", "\\propto"}, {"∇", "\\nabla"},
    };
    return signs;
}

std::string_view latex_special(char c) {
    switch (c) {
        case '\\':
            return "\\textbackslash{}";
        case '{':
            return "\\{";
        case '}':
            return "\\}";
        case '$':
            return "\\$";
        case '&':
            return "\\&";
        case '#':
            return "\\#";
        case '%':
            return "\\%";
        case '_':
            return "\\_";
        case '~':
            return "\\textasciitilde{}";
        case '^':
            return "\\textasciicircum{}";
        case '<':
            return "\\textless{}";
        case '>':
            return "\\textgreater{}";
        case '|':
            return "\\textbar{}";
        case '"':
            return "''";
        case '`':
            return "\\textasciigrave{}";
        // after \\ these two would be read as its arguments
        case '[':
            return "{[}";
        case '*':
            return "{*}";
        // two hyphens would become a dash
        case '-':
            return "-{}";
        default:
            return {};
    }
}

std::size_t character_bytes(char first) {
    const auto byte = static_cast<unsigned char>(first);
    return byte < 0xc0 ? 1 : byte < 0xe0 ? 2 : byte < 0xf0 ? 3 : 4;
}

std::string latex_text(const std::string& text) {
    std::string out;
    for (std::size_t i = 0; i < text.size();) {
        const char c = text[i];
        const std::string_view character = std::string_view(text).substr(i, character_bytes(c));
        const bool next_is_hyphen = i + 1 < text.size() && text[i + 1] == '-';
        i += character.size();
        if (is_control(c)) {
            if (c == '\n' || c == '\t') out += ' ';
        } else if (const auto sign = latex_signs().find(character); sign != latex_signs().end()) {
            out += fmt::format("${}$", sign->second);
        } else if (const std::string_view special = latex_special(c);
                   !special.empty() && (c != '-' || next_is_hyphen)) {
            out += special;
        } else {
            out += character;
        }
    }
    return out;
}

std::string latex_number(double value) {
    if (std::isnan(value)) return "nan";
    if (std::isinf(value)) return value > 0 ? "$\\infty$" : "$-\\infty$";
    const Rounded number = rounded(value);
    const std::string plain = plain_decimals(value, number);
    if (!plain.empty()) return fmt::format("${}$", plain);
    const std::string power = fmt::format("10^{{{}}}", number.exponent);
    if (number.mantissa == "1") return fmt::format("${}$", power);
    if (number.mantissa == "-1") return fmt::format("$-{}$", power);
    return fmt::format("${}\\times{}$", number.mantissa, power);
}

/// A table of finished text: the heading first, then the rows.
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

/// Columns with at least one number and no text are aligned to the right.
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

std::size_t width(const std::string& text) {
    const auto starts_character = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; };
    return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), starts_character));
}

}  // namespace

std::string markdown(const Table& table) {
    require_rectangular(table);
    const auto lines = written(table, markdown_text, markdown_number);
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

std::string latex(const Table& table, const std::string& caption, const std::string& label) {
    require_rectangular(table);
    const auto lines = written(table, latex_text, latex_number);
    std::string out = "\\begin{table}\n  \\centering\n";
    if (!caption.empty()) out += fmt::format("  \\caption{{{}}}\n", latex_text(caption));
    if (!label.empty()) out += fmt::format("  \\label{{{}}}\n", label);
    out += "  \\begin{tabular}{";
    for (const bool right : number_columns(table)) out += right ? 'r' : 'l';
    out += "}\n    \\toprule\n";
    for (std::size_t row = 0; row < lines.size(); ++row) {
        out += fmt::format("    {} \\\\\n", fmt::join(lines[row], " & "));
        if (row == 0) out += "    \\midrule\n";
    }
    out += "    \\bottomrule\n  \\end{tabular}\n\\end{table}\n";
    return out;
}

}  // namespace polhode
