#include "scene/formula_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "scene/scene_keys.h"
#include "text/csv_lines.h"
#include "text/decimal.h"
#include "text/message.h"
#include "text/named_file.h"

namespace polhode {
namespace {

std::vector<double> number_list(const JsonNode& node) {
    std::vector<double> numbers;
    for (const JsonNode* one : node.elements()) numbers.push_back(one->number());
    return numbers;
}

// Indices of the columns of a table's file. A first line that is not of numbers names the columns.
std::array<std::size_t, 2> find_columns(const JsonNode& node, const CsvLines& lines, const std::string& file,
                                        bool has_names) {
    std::array<std::size_t, 2> found{0, 1};
    if (const JsonNode* columns = node.find("columns")) {
        const std::vector<const JsonNode*> names = columns->elements();
        if (names.size() != 2)
            columns->fail("does not have two names", "give the columns of x and y, such as [\"t\", \"F\"]");
        if (!has_names)
            columns->fail("is given, but the first line of the file consists of numbers",
                          "remove it, or name the columns in the file's first line");
        const std::vector<std::string_view>& cells = lines.cells();
        for (std::size_t k = 0; k < 2; ++k) {
            const auto at = std::ranges::find(cells, names[k]->string());
            if (at == cells.end())
                names[k]->fail(fmt::format("is not a column of {}", one_line(file, 200)),
                               "give one of " + join_with_commas({cells.begin(), cells.end()}));
            found[k] = static_cast<std::size_t>(at - cells.begin());
        }
    }
    const std::size_t last = std::max(found[0], found[1]);
    if (lines.cells().size() <= last)
        throw InputError(file, fmt::format("line {}", lines.number()),
                         fmt::format("has {} cell{}", lines.cells().size(), lines.cells().size() == 1 ? "" : "s"),
                         "give a column of x and one of y, separated by commas");
    return found;
}

void read_table(const JsonNode& node, const std::string& directory, FormulaTable& table) {
    for (const char* key : {"x", "y"})
        if (const JsonNode* one = node.find(key)) one->fail("is given together with \"file\"", "remove one of them");
    constexpr std::size_t largest_table_file = std::size_t{1} << 20;
    const std::string file = node.find("file")->string();
    const std::string text = read_named_text(directory, file, largest_table_file, "a CSV file with the points");
    CsvLines lines(text, file);
    std::optional<std::array<std::size_t, 2>> columns;
    while (lines.next()) {
        const std::vector<std::string_view>& cells = lines.cells();
        if (!columns) {
            const bool has_names = !parse_decimal(cells.front());
            columns = find_columns(node, lines, file, has_names);
            if (has_names) continue;
        }
        for (std::size_t k = 0; k < 2; ++k) {
            const std::size_t column = (*columns)[k];
            const std::optional<double> number =
                column < cells.size() ? parse_decimal(cells[column]) : std::optional<double>();
            if (!number)
                throw InputError(file, fmt::format("line {}, column {}", lines.number(), column + 1),
                                 column < cells.size() ? "is not a number" : "is missing", "give a decimal number");
            (k == 0 ? table.x : table.y).push_back(*number);
        }
    }
}

FormulaTable parse_table(const JsonNode& node, const std::string& directory) {
    node.require_known_keys(keys_of(scene_keys(), "table"));
    FormulaTable table;
    table.name = node.key();
    if (node.find("file")) {
        read_table(node, directory, table);
    } else {
        if (const JsonNode* columns = node.find("columns")) columns->fail("is given without \"file\"", "remove it");
        table.x = number_list(node.require_member("x", "increasing numbers [x0, x1, ..], or \"file\""));
        table.y = number_list(node.require_member("y", "one number for each x"));
    }
    if (const JsonNode* between = node.find("between")) {
        if (between->string() != "linear" && between->string() != "cubic")
            between->fail(between->describe(), "give \"linear\" or \"cubic\"");
        table.between = between->string() == "cubic" ? TableInterpolation::cubic : TableInterpolation::linear;
    }
    return table;
}

std::string write_number_list(const std::vector<double>& numbers) {
    std::string text;
    for (const double x : numbers) text += (text.empty() ? "" : ", ") + shortest_decimal(x);
    return "[" + text + "]";
}

template <class Entries, class Write>
std::string write_object(const Entries& entries, const Write& write) {
    std::string text;
    for (const auto& entry : entries)
        text += fmt::format("{}{}: {}", text.empty() ? "\n    " : ",\n    ", json_string(entry.name), write(entry));
    return text.empty() ? "" : "{" + text + "\n  }";
}

}  // namespace

void parse_formula_members(const JsonNode& root, const std::string& directory, Scene& scene) {
    if (const JsonNode* parameters = root.find("parameters"))
        for (const JsonNode* one : parameters->members()) scene.parameters.push_back({one->key(), one->number()});
    if (const JsonNode* tables = root.find("tables"))
        for (const JsonNode* one : tables->members()) scene.tables.push_back(parse_table(*one, directory));
    if (const JsonNode* let = root.find("let"))
        for (const JsonNode* one : let->members()) scene.let.push_back({one->key(), one->string()});
}

std::string write_parameters(const Scene& scene) {
    return write_object(scene.parameters, [](const FormulaParameter& one) { return shortest_decimal(one.value); });
}

std::string write_tables(const Scene& scene) {
    return write_object(scene.tables, [](const FormulaTable& one) {
        return fmt::format(R"({{"x": {}, "y": {}, "between": "{}"}})", write_number_list(one.x),
                           write_number_list(one.y), one.between == TableInterpolation::cubic ? "cubic" : "linear");
    });
}

std::string write_let(const Scene& scene) {
    return write_object(scene.let, [](const FormulaDefinition& one) { return json_string(one.formula); });
}

}  // namespace polhode
