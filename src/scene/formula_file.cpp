#include "scene/formula_file.h"

#include <fmt/format.h>

#include "scene/scene_keys.h"
#include "text/decimal.h"

namespace polhode {
namespace {

std::vector<double> number_list(const JsonNode& node) {
    std::vector<double> numbers;
    for (const JsonNode* one : node.elements()) numbers.push_back(one->number());
    return numbers;
}

FormulaTable parse_table(const JsonNode& node) {
    node.require_known_keys(keys_of(scene_keys(), "table"));
    FormulaTable table;
    table.name = node.key();
    table.x = number_list(node.require_member("x", "increasing numbers [x0, x1, ..]"));
    table.y = number_list(node.require_member("y", "one number for each x"));
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

void parse_formula_members(const JsonNode& root, Scene& scene) {
    if (const JsonNode* parameters = root.find("parameters"))
        for (const JsonNode* one : parameters->members()) scene.parameters.push_back({one->key(), one->number()});
    if (const JsonNode* tables = root.find("tables"))
        for (const JsonNode* one : tables->members()) scene.tables.push_back(parse_table(*one));
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
