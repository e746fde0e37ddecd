// Merges result directories. Case files have the key of the case as name, so that files of different directories with
// the same name are of the same case and are compared. Tables are then written from the merged cases as by a run.
#include "experiment/run/merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "experiment/plan/kind.h"
#include "experiment/run/case_store.h"
#include "experiment/run/locks.h"
#include "experiment/run/provenance.h"
#include "experiment/run/run_experiment.h"
#include "table/table.h"
#include "text/atomic_file.h"
#include "text/atomic_files.h"
#include "text/decimal.h"
#include "text/folder_names.h"
#include "text/json_document.h"
#include "text/message.h"
#include "text/sealed.h"

namespace polhode {
namespace {

namespace fs = std::filesystem;

constexpr const char* record_ending = ".experiment.json";
constexpr std::size_t largest_case_file = std::size_t{1} << 30;

struct Record {
    std::string file, text, program;
    bool quick = false;

    bool operator==(const Record&) const = default;
};

std::string record_text(const Record& record) {
    const nlohmann::ordered_json json{
        {"file", record.file}, {"quick", record.quick}, {"program", record.program}, {"text", record.text}};
    return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

Record read_record(const std::string& path) {
    const JsonDocument document(read_text(path), path);
    const JsonNode& root = document.root();
    root.require_known_keys({"file", "quick", "program", "text"});
    return {root.require_member("file", "the experiment's name or file").string(),
            root.require_member("text", "the experiment's text").string(),
            root.require_member("program", "the program's key").string(),
            root.require_member("quick", "true or false").boolean()};
}

std::string cases_folder(const std::string& directory) { return (fs::path(directory) / ".cases").string(); }

// sorted names of the files in DIRECTORY/.cases
std::vector<std::string> files_in(const std::string& directory) {
    std::error_code none;
    std::vector<std::string> names = names_in(cases_folder(directory), none);
    std::erase_if(names, [&](const std::string& name) {
        return !fs::is_regular_file(fs::path(cases_folder(directory)) / name, none);
    });
    return names;
}

bool is_key(std::string_view text) {
    return text.size() == 32 && text.find_first_not_of("0123456789abcdef") == text.npos;
}

enum class CaseFile { none, table, seconds };

// Rows, series and searches are tables. copy_study() copies the marks of finished studies with their tables.
CaseFile kind_of(const std::string& name) {
    const std::size_t dot = name.find('.');
    if (dot == name.npos || !is_key(std::string_view(name).substr(0, dot))) return CaseFile::none;
    const std::string ending = name.substr(dot);
    if (ending == ".csv" || ending == ".series.csv" || ending == ".rows.csv") return CaseFile::table;
    return ending == ".seconds" ? CaseFile::seconds : CaseFile::none;
}

std::string content(const std::string& path) { return read_text(path, largest_case_file, "a readable case file"); }

bool is_time_column(const std::string& column) {
    return column.starts_with("seconds") || column == "repeats" || column == "machine";
}

double least_seconds(const Table& table) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < table.columns.size(); ++c)
        if (table.columns[c] == "seconds_min")
            for (const auto& row : table.rows) least = std::min(least, parse_decimal(text_of(row[c])).value_or(least));
    return least;
}

std::string describe_row(const Table& table, std::size_t row) {
    std::string description;
    for (const char* column : {"scene", "method", "setting_kind", "setting", "formulation"})
        for (std::size_t c = 0; c < table.columns.size(); ++c)
            if (table.columns[c] == column && !text_of(table.rows[row][c]).empty())
                description += (description.empty() ? "" : " ") + text_of(table.rows[row][c]);
    return description;
}

// The first cell in which two tables of one case differ, apart from times; empty if they agree. One cell only, because
// a message has 300 characters.
std::string difference(const Table& a, const Table& b) {
    if (a.columns != b.columns) return "the columns differ";
    if (a.rows.size() != b.rows.size()) return fmt::format("{} rows against {}", a.rows.size(), b.rows.size());
    for (std::size_t r = 0; r < a.rows.size(); ++r) {
        std::string cells;
        long differing = 0;
        for (std::size_t c = 0; c < a.columns.size(); ++c) {
            const std::string one = text_of(a.rows[r][c]), other = text_of(b.rows[r][c]);
            if (is_time_column(a.columns[c]) || one == other) continue;
            if (++differing == 1)
                cells = fmt::format("{} is {} against {}", a.columns[c], one_line(one, 32), one_line(other, 32));
        }
        if (differing > 1) cells += fmt::format(" ({} more columns differ)", differing - 1);
        if (differing > 0) return fmt::format("{}: {}", one_line(describe_row(a, r), 60), cells);
    }
    return "";
}

// Whether the file at `path` replaces `other`, which is a file of the same case. Depends on contents, not on paths.
bool is_better(const std::string& path, const std::string& other) {
    const std::string a = content(path), b = content(other);
    if (a == b) return false;
    Table first, second;
    for (const auto& [table, text, from] : {std::tuple(&first, &a, &path), std::tuple(&second, &b, &other)}) {
        try {
            *table = parse_csv(unseal(*text).value_or(""));
        } catch (const std::invalid_argument& fault) {
            throw InputError(*from, "", one_line(fault.what(), 200), "remove the file to run the case again");
        }
    }
    if (const std::string differs = difference(first, second); !differs.empty())
        throw InputError(path, "", fmt::format("disagrees with {} on the same case: {}", one_line(other, 60), differs),
                         "find out which file is correct and remove the other");
    const double least_a = least_seconds(first), least_b = least_seconds(second);
    return least_a != least_b ? least_a < least_b : a < b;
}

double seconds_in(const std::string& path) {
    std::string text = unseal(content(path)).value_or("");
    while (!text.empty() && text.back() == '\n') text.pop_back();
    return parse_decimal(text).value_or(0);
}

using Records = std::map<std::string, std::pair<Record, std::string>>;  // by name: the record and its path

void read_records(const std::string& directory, Records& records) {
    for (const std::string& name : files_in(directory)) {
        if (!name.ends_with(record_ending)) continue;
        const std::string path = (fs::path(cases_folder(directory)) / name).string();
        Record record = read_record(path);
        const std::string experiment = name.substr(0, name.size() - std::string_view(record_ending).size());
        if (record.program != running_program_key())
            throw InputError(path, "/program", "was written by another build of polhode",
                             "merge with the program that ran the cases, or run them again");
        const auto [known, is_new] = records.try_emplace(experiment, std::pair(record, path));
        if (!is_new && known->second.first != record)
            throw InputError(path, "", "does not record the same experiment as " + known->second.second,
                             "merge directories of one experiment file, either all or none with --quick");
    }
}

struct Source {
    std::string path;
    bool in_output = false;  // already in the output directory
};

struct CaseSources {
    std::map<std::string, Source> chosen;  // by file name
    long repeated = 0;
};

void collect_case_files(const std::string& directory, bool is_output, CaseSources& case_sources) {
    for (const std::string& name : files_in(directory)) {
        const CaseFile kind = kind_of(name);
        if (kind == CaseFile::none) continue;
        const std::string path = (fs::path(cases_folder(directory)) / name).string();
        // corrupted files are treated as missing, and so are rows whose series is corrupted
        const std::string series = path.substr(0, path.find(".csv", path.size() - 4)) + ".series.csv";
        if (!read_sealed(path) || (fs::exists(series) && !read_sealed(series))) continue;
        const auto [known, is_new] = case_sources.chosen.try_emplace(name, Source{path, is_output});
        if (is_new) continue;
        ++case_sources.repeated;
        Source& source = known->second;
        const bool better =
            kind == CaseFile::seconds ? seconds_in(path) > seconds_in(source.path) : is_better(path, source.path);
        if (better) source = {path, is_output};
    }
}

// Copies tables and figures of a study that one shard computed as a whole. Returns false if no shard has finished it.
bool copy_study(const Plan& plan, const std::vector<std::string>& directories, const std::string& output) {
    // if several shards have it, take the smallest content, so that the result does not depend on their order
    std::optional<std::pair<std::map<std::string, std::string>, std::string>> least;
    for (const std::string& directory : directories) {
        if (!is_study_done(plan, directory)) continue;
        std::map<std::string, std::string> files;
        for (const std::string& name : recorded_files(directory, plan.experiment.name))
            files[name] = content((fs::path(directory) / name).string());
        if (!least || files < least->first) least.emplace(std::move(files), directory);
    }
    if (!least) return is_study_done(plan, output);
    fs::create_directories(output);
    for (const auto& [name, text] : least->first) write_atomically((fs::path(output) / name).string(), text);
    record_scenes(output, plan);
    copy_provenance(least->second, output, plan.experiment.name);
    save_study_done(plan, output);
    return true;
}

}  // namespace

void record_experiment(const Plan& plan, const std::string& directory) {
    if (plan.experiment.text.empty()) return;
    std::error_code none;
    // store an absolute path, since the merge may run in another working directory
    const bool is_file = fs::exists(plan.file, none);
    const Record record{is_file ? fs::absolute(plan.file, none).string() : plan.file, plan.experiment.text,
                        running_program_key(), plan.quick};
    const std::string path = (fs::path(cases_folder(directory)) / (plan.experiment.name + record_ending)).string();
    try {
        if (read_record(path) == record) return;
    } catch (const InputError&) {
        // missing or incomplete
    }
    fs::create_directories(cases_folder(directory));
    write_atomically(path, record_text(record));
}

bool has_results(const std::string& directory) {
    const std::vector<std::string> names = files_in(directory);
    return std::any_of(names.begin(), names.end(),
                       [](const std::string& name) { return name.ends_with(record_ending); });
}

namespace {

// Reads the records of all directories and of the output. Returns the directories with results, without the output.
std::vector<std::string> read_sources(const std::vector<std::string>& directories, const std::string& output,
                                      Records& records, std::vector<std::string>& remarks) {
    std::vector<std::string> sources;
    for (const std::string& directory : directories) {
        if (!fs::is_directory(directory))
            throw InputError(one_line(directory, 300), "", "is not a directory",
                             "give directories written by `polhode run`");
        std::error_code none;
        if (fs::equivalent(directory, output, none)) continue;
        if (!has_results(directory)) {
            remarks.push_back(one_line(directory, 300) + " contains no results yet");
            continue;
        }
        sources.push_back(directory);
        read_records(directory, records);
    }
    if (fs::is_directory(output)) read_records(output, records);
    if (records.empty())
        throw InputError(one_line(directories.front(), 300), "", "contains no results, nor does any other directory",
                         "give directories written by `polhode run`");
    return sources;
}

// Copies the chosen case files of the sources into the output.
void merge_case_files(const std::vector<std::string>& sources, const std::vector<Plan>& plans,
                      const std::string& output, MergeResult& merged) {
    static const std::atomic<bool> never_stop{false};
    CaseSources case_sources;
    collect_case_files(output, true, case_sources);
    for (const std::string& directory : sources) collect_case_files(directory, false, case_sources);
    fs::create_directories(cases_folder(output));
    remove_abandoned_files(output);
    const FileLock report_lock(report_lock_file(output), FileLock::Kind::exclusive, never_stop);
    for (const Plan& plan : plans) record_experiment(plan, output);
    AtomicFiles cases(cases_folder(output));
    for (const auto& [name, source] : case_sources.chosen) {
        if (source.in_output) continue;
        cases.add(name, content(source.path));
        ++merged.taken;
    }
    cases.commit();
    merged.repeated = case_sources.repeated;
}

}  // namespace

MergeResult merge_results(const std::vector<std::string>& directories, const RunOptions& options,
                          const std::string& command_line) {
    const std::string& output = options.directory;
    MergeResult merged;
    Records records;
    const std::vector<std::string> sources = read_sources(directories, output, records, merged.remarks);
    std::vector<Plan> plans;
    for (const auto& [name, known] : records) {
        const Record& record = known.first;
        plans.push_back(make_plan(parse_experiment(record.text, record.file), record.file, record.quick));
    }
    merge_case_files(sources, plans, output, merged);
    for (const Plan& plan : plans) {
        ExperimentMerge one{plan.experiment.name, 0, ""};
        const ExperimentKind& kind = *plan.experiment.kind;
        if (kind.make && !kind.resumable) {
            if (!copy_study(plan, sources, output)) one.missing = 1, one.first_missing = plan.experiment.name;
        } else {
            RunOptions each = options;
            each.quick = plan.quick;
            const GatherResult result = gather_results(plan, each, command_line);
            one.missing = result.missing, one.first_missing = result.first_missing;
        }
        merged.experiments.push_back(std::move(one));
    }
    return merged;
}

}  // namespace polhode
