// Writes a table as a LaTeX longtable that fits the text width of a plain article.
//
// latex() estimates the width of each column in points from its widest cell and its heading, which is broken into
// lines. While the table is too wide, it moves constant columns to the caption, switches to a smaller type, drops the
// columns of `lesser` in order, and finally drops columns from the right. Text is escaped and gets break points
// inside long names.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <map>
#include <string_view>

#include "table/markup.h"

namespace polhode {
namespace {

// Points, for a plain article at 10 pt.
constexpr double text_width = 345, between = 6;

// A type size: the width of a digit (letters are narrower on average) and the maximum width of a text column before
// lines break, in points.
struct TypeSize {
    const char* command;
    double digit, widest_text;
};
constexpr TypeSize script_size{"scriptsize", 4.2, 72}, tiny_size{"tiny", 3.55, 48};

/// Characters used in captions and messages that pdfLaTeX's standard setup cannot process.
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
        // after \\ these two would be parsed as its arguments
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

bool is_control_byte(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

std::string latex_text(const std::string& text) {
    std::string out;
    for (std::size_t i = 0; i < text.size();) {
        const char c = text[i];
        const std::string_view character = std::string_view(text).substr(i, character_bytes(c));
        const bool next_is_hyphen = i + 1 < text.size() && text[i + 1] == '-';
        i += character.size();
        if (is_control_byte(c)) {
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

// A number in a form that siunitx accepts.
std::string latex_number(double value) {
    if (std::isnan(value)) return "nan";
    if (std::isinf(value)) return value > 0 ? "$\\infty$" : "$-\\infty$";
    return fmt::format("\\num{{{}}}", format_readable_number(value));
}

// Allows line breaks before the capitals in aLongNameOfAProgram.
std::string insert_name_breaks(const std::string& text) {
    constexpr std::size_t long_name = 14;
    const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
    const auto is_capital = [](char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; };
    std::string out;
    for (auto begin = text.begin(); begin != text.end();) {
        const auto end = std::find_if_not(begin, text.end(), is_letter);
        for (auto c = begin; c != end; ++c) {
            if (end - begin > static_cast<std::ptrdiff_t>(long_name) && c != begin && is_capital(*c) &&
                !is_capital(*(c - 1)))
                out += "\\allowbreak{}";
            out += *c;
        }
        begin = end;
        if (begin != text.end()) out += *begin++;
    }
    return out;
}

std::string latex_cell_text(const Cell& cell) {
    if (const double* real = std::get_if<double>(&cell)) return latex_number(*real);
    if (const long* count = std::get_if<long>(&cell)) return fmt::format("\\num{{{}}}", *count);
    // allow line breaks in long names after these characters
    std::string text = latex_text(text_of(cell));
    for (const std::string_view end : {"\\_", "\\{", "/", "=", ":"})
        for (std::size_t at = text.find(end); at != text.npos; at = text.find(end, at + end.size()))
            text.insert(at + end.size(), "\\allowbreak{}");
    return insert_name_breaks(text);
}

std::size_t printed_characters(const Cell& cell) {
    if (const double* real = std::get_if<double>(&cell)) {
        // a minus sign is as wide as two digits
        const std::string number = format_readable_number(*real);
        return number.size() + static_cast<std::size_t>(std::ranges::count(number, '-'));
    }
    const std::string text = text_of(cell);
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

// Breaks the heading into lines of at most `most` characters; a longer word stays on its own line.
std::vector<std::string> lines_of(const std::string& heading, std::size_t most) {
    std::vector<std::string> lines;
    for (std::size_t begin = 0; begin < heading.size();) {
        const std::size_t end = std::min(heading.find(' ', begin), heading.size());
        const std::string word = heading.substr(begin, end - begin);
        if (!lines.empty() && lines.back().size() + 1 + word.size() <= most)
            lines.back() += " " + word;
        else
            lines.push_back(word);
        begin = end + 1;
    }
    return lines;
}

// A column of the printed table.
struct Column {
    std::size_t index = 0;
    bool number = false;
    double width = 0;  // pt
    std::vector<std::string> heading;
};

Column column_of(const Table& table, std::size_t index, bool number, const TypeSize& type) {
    Column column{index, number, 0, {}};
    std::size_t widest = 3;
    for (const std::vector<Cell>& row : table.rows) widest = std::max(widest, printed_characters(row[index]));
    // treat underscores as word breaks
    std::string heading = table.columns[index];
    std::ranges::replace(heading, '_', ' ');
    // text and headings break at the widest text, unless a word is longer
    const double most = number ? text_width : type.widest_text;
    const auto fitting = static_cast<std::size_t>(most / type.digit);
    column.heading = lines_of(heading, std::clamp<std::size_t>(widest, 8, fitting));
    column.width = std::min(static_cast<double>(widest) * type.digit, most);
    for (const std::string& line : column.heading)
        column.width = std::max(column.width, static_cast<double>(line.size()) * type.digit);
    return column;
}

// All rows have the same value, which the caption can state once.
bool is_constant(const Table& table, std::size_t index) {
    return table.rows.size() > 1 && std::ranges::all_of(table.rows, [&](const std::vector<Cell>& row) {
               return row[index] == table.rows.front()[index];
           });
}

// Less important columns, in the order in which they are dropped before the columns at the right.
constexpr std::array<std::string_view, 10> lesser{"message",
                                                  "described as",
                                                  "float32 floor (rad)",
                                                  "evaluations",
                                                  "steps",
                                                  "float64 floor (rad)",
                                                  "status",
                                                  "attitude, end (rad)",
                                                  "about",
                                                  "points"};

double width_of(const std::vector<Column>& columns) {
    double width = -between;
    for (const Column& column : columns) width += column.width + between;
    return width;
}

// The columns that fit the page, and the text about the others.
struct PageColumns {
    std::vector<Column> columns;
    TypeSize type = script_size;
    std::string same, left_out;  // columns with one value; columns only in the CSV file

    void drop(const Table& table, std::size_t place) {
        const std::size_t index = columns[place].index;
        if (is_constant(table, index)) {
            const std::string value = latex_cell_text(table.rows.front()[index]);
            if (!value.empty())
                same += fmt::format("{}{}: {}", same.empty() ? "" : "; ", latex_text(table.columns[index]), value);
        } else {
            left_out += (left_out.empty() ? "" : ", ") + latex_text(table.columns[index]);
        }
        columns.erase(columns.begin() + static_cast<long>(place));
    }
};

PageColumns fit_columns(const Table& table) {
    PageColumns page;
    std::vector<Column>& columns = page.columns;
    const std::vector<bool> numbers = number_columns(table);
    for (std::size_t i = 0; i < table.columns.size(); ++i)
        columns.push_back(column_of(table, i, numbers[i], page.type));
    const auto too_wide = [&] { return width_of(columns) > text_width && columns.size() > 1; };
    for (std::size_t place = columns.size(); place-- > 0 && too_wide();)
        if (is_constant(table, columns[place].index)) page.drop(table, place);
    if (too_wide()) {
        page.type = tiny_size;
        for (Column& column : columns) column = column_of(table, column.index, column.number, page.type);
    }
    for (const std::string_view name : lesser)
        for (std::size_t place = columns.size(); place-- > 0 && too_wide();)
            if (table.columns[columns[place].index] == name) page.drop(table, place);
    while (too_wide()) page.drop(table, columns.size() - 1);
    return page;
}

std::string latex_title(const std::string& caption, const PageColumns& page) {
    std::string title = latex_text(caption);
    if (!page.same.empty()) title += fmt::format("{}Constant in all rows: {}.", title.empty() ? "" : ". ", page.same);
    if (!page.left_out.empty())
        title += fmt::format("{}Further columns in the CSV file: {}.",
                             title.empty()       ? ""
                             : page.same.empty() ? ". "
                                                 : " ",
                             page.left_out);
    return title;
}

std::string latex_heading(const std::vector<Column>& columns) {
    std::string heading;
    for (const Column& column : columns) {
        std::vector<std::string> lines;
        for (const std::string& line : column.heading) lines.push_back(latex_text(line));
        const char side = column.number ? 'r' : 'l';
        heading +=
            fmt::format("{}\\multicolumn{{1}}{{{}@{{}}}}{{\\begin{{tabular}}[b]{{@{{}}{}@{{}}}}{}\\end{{tabular}}}}",
                        heading.empty() ? "" : " & ", side, side, fmt::join(lines, "\\\\"));
    }
    return heading;
}

}  // namespace

std::string latex(const Table& table, const std::string& caption, const std::string& label) {
    require_rectangular(table);
    const PageColumns page = fit_columns(table);
    const std::vector<Column>& columns = page.columns;
    const std::string title = latex_title(caption, page);
    std::string out = fmt::format(
        "% \\usepackage{{booktabs,longtable,siunitx}}\n\\begingroup\\{}\\setlength{{\\tabcolsep}}{{3pt}}\n"
        "\\sisetup{{group-minimum-digits=9,output-exponent-marker=\\ensuremath{{\\mathrm{{e}}}}}}\n\\begin{{longtable}}"
        "{{@{{}}",
        page.type.command);
    for (const Column& column : columns)
        out += column.number ? "r" : fmt::format(">{{\\raggedright\\arraybackslash}}p{{{:.0f}pt}}", column.width);
    out += "@{}}\n";
    if (!title.empty() || !label.empty())
        out +=
            fmt::format("  \\caption{{{}}}{}\\\\\n", title, label.empty() ? "" : fmt::format("\\label{{{}}}", label));
    out += fmt::format("  \\toprule\n  {} \\\\\n  \\midrule\n  \\endhead\n  \\bottomrule\n  \\endfoot\n",
                       latex_heading(columns));
    for (const std::vector<Cell>& row : table.rows) {
        std::vector<std::string> cells;
        for (const Column& column : columns) cells.push_back(latex_cell_text(row[column.index]));
        out += fmt::format("  {} \\\\\n", fmt::join(cells, " & "));
    }
    return out + "\\end{longtable}\n\\endgroup\n";
}

}  // namespace polhode
