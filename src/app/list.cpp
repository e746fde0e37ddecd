// polhode list: lists scenes, methods, experiments, metrics, keys, columns, engines and constructs as text, JSON or
// Markdown. The Markdown tables are the generated parts of the READMEs.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "app/commands.h"
#include "app/lookup.h"
#include "app/scene_index.h"
#include "experiment/plan/experiment_keys.h"
#include "experiment/run/result.h"
#include "formula/language.h"
#include "integrators/engines/engine_methods.h"
#include "integrators/method.h"
#include "motion/trajectory_columns.h"
#include "scene/builtin.h"
#include "scene/robot_schema.h"
#include "scene/scene_file.h"
#include "scene/scene_keys.h"
#include "table/table.h"
#include "text/json_document.h"

namespace polhode {
namespace {

struct Entry {
    std::string name, about;
};

// the text up to the first full stop that ends a sentence
std::string first_sentence(std::string_view text) {
    const std::size_t stop = text.find(". ");
    std::string sentence(text.substr(0, stop == text.npos ? text.size() : stop));
    while (!sentence.empty() && (sentence.back() == '.' || sentence.back() == '\n')) sentence.pop_back();
    std::replace(sentence.begin(), sentence.end(), '\n', ' ');
    return sentence;
}

std::vector<Entry> texts(std::span<const BuiltinText> all) {
    std::vector<Entry> entries;
    for (const BuiltinText& one : all) {
        const JsonDocument document(one.text, std::string(one.name));
        const JsonNode* about = document.root().find("about");
        entries.push_back({std::string(one.name), about ? about->string() : ""});
    }
    return entries;
}

std::vector<Entry> scenes() { return texts(builtin_scenes()); }
std::vector<Entry> experiments() { return texts(builtin_experiments()); }

std::vector<Entry> methods_with_auto() {
    std::vector<Entry> entries{{"auto", "Selects a method for the scene; polhode describe SCENE prints which and why"}};
    for (const Method* method : methods())
        entries.push_back({std::string(method->name), first_sentence(method->documentation)});
    return entries;
}

std::vector<Entry> engine_entries() {
    std::vector<Entry> entries;
    for (const EngineMethod& engine : engines())
        entries.push_back({std::string(engine.method->name), first_sentence(engine.method->documentation)});
    return entries;
}

// the columns of the result table that are measures
std::vector<Entry> metrics() {
    std::vector<Entry> entries;
    for (const bool is_error : {true, false})
        for (const ResultColumn& column : result_column_table())
            if (!column.meaning.empty() && column.is_error == is_error)
                entries.push_back({column.name, column.meaning});
    return entries;
}

// The keys of scene and experiment files.
std::vector<FileKey> file_keys() {
    std::vector<FileKey> all(scene_keys().begin(), scene_keys().end());
    all.insert(all.end(), experiment_keys().begin(), experiment_keys().end());
    return all;
}
std::vector<Entry> key_entries() {
    std::vector<Entry> entries;
    for (const FileKey& key : file_keys())
        entries.push_back({fmt::format("{}: {}", key.object, key.key),
                           fmt::format("{} ({}{}{}; default: {})", key.meaning, key.type, key.unit.empty() ? "" : ", ",
                                       key.unit, key.fallback)});
    return entries;
}
std::vector<Entry> column_entries() {
    std::vector<Entry> entries;
    for (const TrajectoryColumns& c : trajectory_columns())
        entries.push_back({std::string(c.names), fmt::format("{}{}{}", c.unit, c.unit.empty() ? "" : ": ", c.meaning)});
    return entries;
}

std::string key_table() {
    Table table{{"in", "key", "type", "unit", "default", "example", "meaning"}, {}};
    std::string_view object;
    for (const FileKey& key : file_keys()) {
        table.rows.push_back({key.object == object ? "" : std::string(key.object), std::string(key.key),
                              std::string(key.type), std::string(key.unit), std::string(key.fallback),
                              std::string(key.example), std::string(key.meaning)});
        object = key.object;
    }
    return markdown(table);
}

// How the importer of robot files treats each element and attribute of a format.
const char* name_of(RobotVerdict verdict) {
    return verdict == RobotVerdict::modelled     ? "modelled"
           : verdict == RobotVerdict::irrelevant ? "irrelevant"
           : verdict == RobotVerdict::partial    ? "partly modelled"
                                                 : "omitted";
}
std::string element_of(const RobotConstruct& one) {
    const std::string element = fmt::format("<{}>", one.element);
    return one.parent.empty() || one.parent == "*" ? element : fmt::format("<{}>/{}", one.parent, element);
}
std::vector<Entry> construct_entries() {
    std::vector<Entry> entries;
    for (const RobotFormat& format : robot_formats())
        for (const RobotConstruct& one : format.constructs())
            entries.push_back({fmt::format("{} {}{}{}", format.name, element_of(one), one.attribute.empty() ? "" : " ",
                                           one.attribute),
                               fmt::format("{}: {}", name_of(one.verdict), one.note)});
    return entries;
}
std::string construct_tables() {
    std::string text;
    for (const RobotFormat& format : robot_formats()) {
        Table table{{"element", "attribute", "verdict", "how it is read, why it is irrelevant, or its heading"}, {}};
        for (const RobotConstruct& one : format.constructs())
            table.rows.push_back({fmt::format("`{}`", element_of(one)), std::string(one.attribute),
                                  std::string(name_of(one.verdict)), std::string(one.note)});
        text += fmt::format("{}### {}\n\n{}", text.empty() ? "" : "\n", format.name, markdown(table));
    }
    return text;
}

// The functions and quantities of the formula language.
std::vector<Entry> formula_entries() {
    std::vector<Entry> entries;
    for (const formula::FunctionEntry& one : formula::formula_functions())
        entries.push_back({fmt::format("{}({})", one.name, one.arguments), std::string(one.about)});
    for (const formula::QuantityEntry& one : formula::formula_quantities())
        entries.push_back({std::string(one.name),
                           fmt::format("{}{}{}: {}", one.type, one.unit.empty() ? "" : ", ", one.unit, one.about)});
    for (const formula::QuantityEntry& one : formula::formula_joint_quantities())
        entries.push_back(
            {fmt::format("JOINT.{}", one.name), fmt::format("{}, {}: {}", one.type, one.unit, one.about)});
    return entries;
}

std::string as_text(const std::vector<Entry>& entries) {
    std::size_t width = 0;
    for (const Entry& entry : entries) width = std::max(width, entry.name.size());
    std::string text;
    for (const Entry& entry : entries)
        text += entry.about.empty() ? entry.name + "\n" : fmt::format("{:{}}  {}\n", entry.name, width, entry.about);
    return text;
}

std::string as_json(const std::vector<Entry>& entries) {
    Table table{{"name", "about"}, {}};
    for (const Entry& entry : entries) table.rows.push_back({entry.name, entry.about});
    return json(table);
}

const char* name_of(Control control) {
    switch (control) {
        case Control::none:
            return "none";
        case Control::fixed_step:
            return "step";
        case Control::tolerance:
            return "tolerance";
        case Control::fixed_step_or_tolerance:
            break;
    }
    return "step or tolerance";
}

// Tables with all columns for methods, scenes, keys and constructs; otherwise name and about.
std::string as_markdown(const std::string& what, const std::vector<Entry>& entries) {
    if (what == "scenes") return scene_index();
    if (what == "keys") return key_table();
    if (what == "constructs") return construct_tables();
    Table table{{"name", "about"}, {}};
    if (what == "methods") {
        table.columns = {"method", "setting", "order", "conserves", "about"};
        for (const Method* method : methods()) {
            table.rows.push_back({std::string(method->name), std::string(name_of(method->control)),
                                  method->order > 0 ? Cell(long(method->order)) : Cell(),
                                  std::string(method->conserves), first_sentence(method->documentation)});
        }
    } else {
        for (const Entry& entry : entries) table.rows.push_back({entry.name, entry.about});
    }
    std::string text = markdown(table);
    if (what == "methods") {
        text += "\nConsidered and omitted:\n\n";
        for (const OmittedMethod& method : omitted_methods())
            text += fmt::format("- `{}`: {}\n", method.name, method.reason);
    }
    return text;
}

}  // namespace

void add_list(CLI::App& program, int&) {
    struct Options {
        std::string what, format = "text";
    };
    CLI::App* command =
        program.add_subcommand("list", "Lists scenes, methods, experiments and other names, one per line.");
    command->footer(
        "Examples:\n"
        "  polhode list scenes\n"
        "  polhode list methods --format json\n");
    const auto options = std::make_shared<Options>();
    command
        ->add_option(
            "WHAT", options->what,
            "scenes, methods, experiments, metrics (columns of results), keys (of scene and experiment files), "
            "columns (of trajectories), engines, constructs (elements and attributes of robot files), formulas "
            "(functions "
            "and quantities of formulas)")
        ->required()
        ->check(CLI::IsMember(
            {"scenes", "methods", "experiments", "metrics", "keys", "columns", "engines", "constructs", "formulas"}));
    add_engines_option(*command);
    command->add_option("--format", options->format, "Output format: text, json or markdown")
        ->check(CLI::IsMember({"text", "json", "markdown"}))
        ->capture_default_str();
    command->callback([options] {
        const std::vector<Entry> entries = options->what == "scenes"        ? scenes()
                                           : options->what == "methods"     ? methods_with_auto()
                                           : options->what == "experiments" ? experiments()
                                           : options->what == "keys"        ? key_entries()
                                           : options->what == "columns"     ? column_entries()
                                           : options->what == "engines"     ? engine_entries()
                                           : options->what == "constructs"  ? construct_entries()
                                           : options->what == "formulas"    ? formula_entries()
                                                                            : metrics();
        write_output("", options->format == "json"       ? as_json(entries)
                         : options->format == "markdown" ? as_markdown(options->what, entries)
                                                         : as_text(entries));
    });
}

}  // namespace polhode
