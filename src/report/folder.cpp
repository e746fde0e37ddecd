// Reads a result directory. FolderReader recognises each CSV file by its columns: result rows of a sweep, errors over
// time, or another table. A file with an error leaves no rows and adds a remark. All files are untrusted: their sizes
// and nesting depth are limited, and names in them are never used as paths.
#include "report/folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "integrators/method.h"
#include "scene/builtin.h"
#include "scene/scene_file.h"
#include "text/decimal.h"
#include "text/message.h"
#include "text/named_file.h"

namespace polhode {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::size_t largest_folder_file = std::size_t{1} << 30;

// Returns an empty string if the file cannot be read, is not a regular file or is too large. Links must not lead out of
// the directory.
std::string read_file(const fs::path& path) {
    try {
        return read_named_text(path.parent_path().string(), path.filename().string(), largest_folder_file, "a table");
    } catch (const InputError&) {
        return "";
    }
}

// Returns a built-in experiment. Names in result files are never used as paths.
Experiment builtin_experiment(const std::string& name) {
    const std::string_view text = builtin_experiment_text(name);
    if (text.empty()) throw InputError(name, "", "is not a built-in experiment", "give the name of one");
    return parse_experiment(text, name);
}

// Returns an empty object if the file is missing, corrupted, or nested deeper than files that polhode writes. The depth
// is limited because the JSON library writes nested values recursively.
ordered_json read_object(const fs::path& path) {
    constexpr int deepest = 64;
    bool is_deep = false;
    const auto look = [&](int depth, ordered_json::parse_event_t, const ordered_json&) {
        is_deep = is_deep || depth > deepest;
        return !is_deep;
    };
    ordered_json object = ordered_json::parse(read_file(path), look, false);
    return object.is_object() && !is_deep ? object : ordered_json::object();
}

std::string text_at(const ordered_json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end()) return "";
    return found->is_string() ? found->get<std::string>()
                              : found->dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

double number_of(const std::string& field) { return field.empty() ? absent : parse_decimal(field).value_or(absent); }

// the number in a cell, or absent
double number_in(const Cell& cell) {
    const auto* real = std::get_if<double>(&cell);
    const auto* count = std::get_if<long>(&cell);
    return real ? *real : count ? static_cast<double>(*count) : absent;
}

bool has(const std::vector<std::string>& columns, std::string_view name) {
    return std::ranges::find(columns, name) != columns.end();
}

bool has_all(const std::vector<std::string>& columns, std::initializer_list<std::string_view> names) {
    return std::ranges::all_of(names, [&](std::string_view name) { return has(columns, name); });
}

class FolderReader {
  public:
    FolderReader(ResultFolder& folder, std::size_t most_rows) : folder_(folder), most_rows_(most_rows) {}

    void read(const std::string& name, const std::string& text) {
        enum class Kind { unknown, sweep, drift, other } kind = Kind::unknown;
        std::vector<std::string> columns;
        FolderTable other{name, "", "", {}, 0};
        result_columns_.clear(), result_ = {};
        const std::size_t rows_before = folder_.rows.size(), series_before = folder_.series.size();
        try {
            read_csv(text, [&](std::vector<std::string>& fields) {
                if (kind == Kind::unknown) {
                    columns = fields;
                    kind = has_all(columns, {"experiment", "scene", "method", "setting_kind", "setting", "status",
                                             "message", "attitude_error_max"})
                               ? Kind::sweep
                           : has_all(columns, {"scene", "method", "setting", "t", "attitude_error", "experiment"})
                               ? Kind::drift
                               : Kind::other;
                    for (const ResultColumn& column : result_column_table())
                        if (const auto at = std::ranges::find(columns, column.name); column.read && at != columns.end())
                            result_columns_.emplace_back(at - columns.begin(), &column);
                    other.table.columns = columns;
                    for (const char* cell : {"experiment", "scene", "method", "setting", "t"})
                        places_[cell] = static_cast<std::size_t>(std::ranges::find(columns, cell) - columns.begin());
                } else if (kind == Kind::sweep) {
                    add_row(fields);
                } else if (kind == Kind::drift) {
                    add_series(columns, fields);
                } else {
                    add_other(other, fields);
                }
            });
        } catch (const std::invalid_argument& fault) {
            folder_.rows.resize(rows_before), folder_.series.resize(series_before);
            folder_.remarks.push_back(
                fmt::format("{}.csv is omitted: {}.", one_line(name, 100), one_line(fault.what(), 300)));
            return;
        }
        if (kind == Kind::other) folder_.tables.push_back(std::move(other));
    }

    int experiment(const std::string& name) {
        const int place = experiments_.place(name);
        if (static_cast<std::size_t>(place) == folder_.experiments.size())
            folder_.experiments.emplace_back().name = name;
        return place;
    }

  private:
    void add_row(const std::vector<std::string>& fields) {
        for (const auto& [at, column] : result_columns_) try {
                column->read(fields[at], result_);
            } catch (const std::invalid_argument& fault) {
                throw std::invalid_argument(fmt::format("column {}: {}", column->name, fault.what()));
            }
        FolderRow row;
        row.experiment = experiment(fields[places_["experiment"]]);
        row.scene = folder_.scenes.place(result_.scene);
        row.method = folder_.methods.place(result_.method);
        row.message = folder_.messages.place(result_.message);
        row.formulation = folder_.formulations.place(name_of(result_.formulation));
        row.kind = result_.setting_kind, row.status = result_.status, row.cut = result_.cut;
        for (std::size_t i = 0; i < row.numbers.size(); ++i)
            row.numbers[i] = number_in(result_column_table()[i].cell(result_));
        folder_.rows.push_back(std::move(row));
    }

    void add_series(const std::vector<std::string>& columns, std::vector<std::string>& fields) {
        const int whose = experiment(fields[places_["experiment"]]);
        const int scene = folder_.scenes.place(fields[places_["scene"]]);
        const int method = folder_.methods.place(fields[places_["method"]]);
        const double setting = number_of(fields[places_["setting"]]), t = number_of(fields[places_["t"]]);
        const auto same = [](double a, double b) { return a == b || (a != a && b != b); };
        // lines of one run are consecutive, with ascending times
        if (folder_.series.empty() || folder_.series.back().experiment != whose ||
            folder_.series.back().scene != scene || folder_.series.back().method != method ||
            !same(folder_.series.back().setting, setting) ||
            (!folder_.series.back().t.empty() && t <= folder_.series.back().t.back()))
            folder_.series.push_back({whose, scene, method, setting, {}, {}});
        FolderSeries& series = folder_.series.back();
        series.t.push_back(t);
        for (std::size_t i = 0; i < standard_measures.size(); ++i) {
            const auto at = std::ranges::find(columns, std::string(standard_measures[i]) + "_error");
            series.errors[i].push_back(
                at == columns.end() ? absent : number_of(fields[static_cast<std::size_t>(at - columns.begin())]));
        }
    }

    void add_other(FolderTable& other, std::vector<std::string>& fields) const {
        if (++other.total > most_rows_) return;
        std::vector<Cell>& row = other.table.rows.emplace_back();
        for (std::string& field : fields) row.push_back(field.empty() ? Cell() : Cell(std::move(field)));
    }

    ResultFolder& folder_;
    std::size_t most_rows_;
    NameList experiments_;
    std::map<std::string, std::size_t> places_;
    std::vector<std::pair<std::size_t, const ResultColumn*>> result_columns_;  // with their indices in the file
    Result result_;                                                            // row of the current line
};

// Reads an entry of provenance.json: readable names and values, with the versions of libraries at the end.
void read_provenance(const ordered_json& entry, FolderExperiment& experiment) {
    experiment.date = text_at(entry, "date");
    experiment.about = text_at(entry, "about");
    experiment.kind = text_at(entry, "kind");
    experiment.quick = entry.value("quick", ordered_json(false)) == true;
    for (const auto& [key, words] : {std::pair{"cpu", "processor"},
                                     {"cores", "cores"},
                                     {"compiler", "compiler"},
                                     {"flags", "flags"},
                                     {"commit", "commit"},
                                     {"command_line", "command line"}})
        if (const std::string value = text_at(entry, key); !value.empty()) experiment.facts.emplace_back(words, value);
    if (const auto versions = entry.find("versions"); versions != entry.end() && versions->is_object())
        for (const auto& [name, version] : versions->items())
            experiment.facts.emplace_back(name, version.is_string() ? version.get<std::string>() : version.dump());
}

// Tables named NAME or NAME_.. belong to experiment NAME; the longest matching name wins.
std::string owner_of(const std::string& table, const std::vector<FolderExperiment>& experiments) {
    std::string owner;
    for (const FolderExperiment& e : experiments)
        if ((table == e.name || table.starts_with(e.name + "_")) && e.name.size() > owner.size()) owner = e.name;
    return owner;
}

}  // namespace

int NameList::place(const std::string& name) {
    const auto [at, is_new] = places_.try_emplace(name, static_cast<int>(names_.size()));
    if (is_new) names_.push_back(name);
    return at->second;
}

int NameList::find(const std::string& name) const {
    const auto at = places_.find(name);
    return at == places_.end() ? -1 : at->second;
}

ResultFolder read_folder(const std::string& directory, std::size_t most_rows) {
    std::error_code none;
    if (!fs::is_directory(directory, none))
        throw InputError(one_line(directory, 300), "",
                         fs::exists(directory, none) ? "is not a directory" : "does not exist",
                         "give a directory written by `polhode run`");
    ResultFolder folder;
    folder.directory = directory;
    folder.name = fs::weakly_canonical(directory, none).filename().string();
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(directory, none))
        if (entry.path().extension() == ".csv" && entry.is_regular_file(none)) files.push_back(entry.path());
    if (files.empty())
        throw InputError(one_line(directory, 300), "", "contains no table (.csv)",
                         "give a directory written by `polhode run`");
    std::ranges::sort(files);

    FolderReader reader(folder, most_rows);
    const ordered_json provenance = read_object(fs::path(directory) / "provenance.json");
    for (const auto& [name, entry] : provenance.items())
        if (entry.is_object()) {
            const auto place = static_cast<std::size_t>(reader.experiment(name));
            read_provenance(entry, folder.experiments[place]);
        }
    folder.messages.place("");
    for (const fs::path& file : files) reader.read(file.stem().string(), read_file(file));
    // titles are recorded by experiment
    std::map<std::string, std::string> titles;
    for (const auto& [name, entry] : provenance.items())
        if (const auto found = entry.find("titles"); entry.is_object() && found != entry.end() && found->is_object())
            for (const auto& [table, title] : found->items())
                if (title.is_string()) titles[table] = title.get<std::string>();
    for (FolderTable& table : folder.tables) {
        table.experiment = owner_of(table.name, folder.experiments);
        if (const auto title = titles.find(table.name); title != titles.end()) table.title = title->second;
    }
    // methods that occur only in tables also get one colour and one mark for all sections
    for (const FolderTable& table : folder.tables)
        if (const auto at = std::ranges::find(table.table.columns, "method"); at != table.table.columns.end())
            for (const std::vector<Cell>& row : table.table.rows)
                if (const std::string name = text_of(row[static_cast<std::size_t>(at - table.table.columns.begin())]);
                    find_method(name))
                    folder.methods.place(name);
    for (FolderExperiment& experiment : folder.experiments) {
        if (!experiment.about.empty() && !experiment.kind.empty()) continue;
        try {
            const Experiment known = builtin_experiment(experiment.name);
            if (experiment.about.empty()) experiment.about = known.about;
            if (experiment.kind.empty()) experiment.kind = std::string(known.kind->name);
        } catch (const InputError&) {
            // a user-defined experiment from before the kind was recorded
        }
    }
    const ordered_json texts = read_object(fs::path(directory) / "scenes.json");
    for (const auto& [name, text] : texts.items())
        folder.scene_texts[name] = text.is_string() ? text.get<std::string>() : text.dump();
    return folder;
}

std::map<std::string, Scene> read_scenes(const ResultFolder& folder) {
    std::map<std::string, Scene> scenes;
    const std::vector<std::string>& wanted = folder.scenes.names();
    const auto missing = [&] {
        return std::ranges::any_of(wanted, [&](const std::string& name) { return !scenes.contains(name); });
    };
    // built-in experiments first: their scenes contain the directories of the files that they refer to
    for (const FolderExperiment& experiment : folder.experiments) {
        if (!missing()) break;
        try {
            const Experiment known = builtin_experiment(experiment.name);
            for (const bool quick : {experiment.quick, !experiment.quick})
                for (PlannedScene& planned : make_plan(known, experiment.name, quick).scenes)
                    if (folder.scenes.find(planned.label) >= 0) scenes.try_emplace(planned.label, planned.scene);
        } catch (const InputError&) {
            continue;
        }
    }
    // scenes recorded in the directory take precedence
    for (const auto& [name, text] : folder.scene_texts) {
        if (folder.scenes.find(name) < 0) continue;
        try {
            scenes.insert_or_assign(name, parse_scene(text, "scenes.json", folder.directory));
        } catch (const InputError&) {
            // the scene refers to files that are not available here
        }
    }
    for (const std::string& name : wanted) {
        if (scenes.contains(name) || builtin_scene_text(name).empty()) continue;
        scenes.emplace(name, find_scene(name));
    }
    return scenes;
}

}  // namespace polhode
