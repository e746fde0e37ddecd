#include "experiment/run/case_store.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "integrators/engines/engine_methods.h"
#include "integrators/own_methods.h"
#include "text/atomic_file.h"
#include "text/content_hash.h"
#include "text/json_document.h"

namespace polhode {
namespace {

std::filesystem::path path_of(const std::string& directory, const std::string& key, const char* ending) {
    return std::filesystem::path(directory) / ".cases" / (key + ending);
}

std::optional<Table> load_table(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) return {};
    try {
        return parse_csv(std::string(std::istreambuf_iterator<char>(file), {}));
    } catch (const std::invalid_argument&) {
        return {};
    }
}

}  // namespace

std::string running_program_key() {
    if (!has_own_methods()) return program_key();
    static const std::string key =
        std::string(program_key()) +
        content_hash(read_text("/proc/self/exe", std::size_t{4} << 30, "this program's own executable"));
    return key;
}

namespace {

// Other programs change without this one's doing so: an engine is another with its version, and a method that is no
// part of the program has an identity.
std::string version_of(const Method& method) {
    const EngineMethod* engine = engine_of(method);
    if (!engine) return std::string(method.identity);
    const EngineReport report = engine->inspect(nullptr);
    return report.fault.empty() ? report.hello.version : "not here";
}

}  // namespace

std::string case_key(const Plan& plan, const PlannedScene& scene, const PlannedCurve& curve, double setting) {
    const Experiment& e = plan.experiment;
    return content_hash(fmt::format("{}\n{}\n{}\n{}\n{} {} {} {} {}\n{} {} {} {} {}\n{}", running_program_key(), e.name,
                                    scene.label, scene.canonical, curve.method->name, name_of(curve.kind), setting,
                                    name_of(curve.formulation), curve.calibrated, e.samples, e.repeats,
                                    e.seconds_per_run, e.max_steps, e.max_evaluations, version_of(*curve.method)));
}

std::optional<Result> load_case(const std::string& directory, const std::string& key) {
    const auto row = load_table(path_of(directory, key, ".csv"));
    if (!row || row->rows.size() != 1) return {};
    try {
        Result result = result_of(*row, 0);
        if (const auto series = load_table(path_of(directory, key, ".series.csv"))) result.series = series_of(*series);
        return result;
    } catch (const std::invalid_argument&) {
        return {};
    }
}

void save_case(const std::string& directory, const std::string& key, const std::string& experiment,
               const Result& result) {
    std::filesystem::create_directories(std::filesystem::path(directory) / ".cases");
    // the series first: a row is there only once all of the case is
    if (!result.series.t.empty())
        write_atomically(path_of(directory, key, ".series.csv").string(), csv(series_table(result.series)));
    write_atomically(path_of(directory, key, ".csv").string(),
                     csv({result_columns(TableOf::stored), {row_of(experiment, result, TableOf::stored)}}));
}

std::optional<Table> load_rows(const std::string& directory, const std::string& key) {
    return load_table(path_of(directory, key, ".rows.csv"));
}

void save_rows(const std::string& directory, const std::string& key, const Table& rows) {
    std::filesystem::create_directories(std::filesystem::path(directory) / ".cases");
    write_atomically(path_of(directory, key, ".rows.csv").string(), csv(rows));
}

void save_done(const std::string& directory, const std::string& key) {
    std::filesystem::create_directories(std::filesystem::path(directory) / ".cases");
    write_atomically(path_of(directory, key, ".done").string(), "done\n");
}

bool is_done(const std::string& directory, const std::string& key) {
    return std::filesystem::exists(path_of(directory, key, ".done"));
}

void save_duration(const std::string& directory, const std::string& words, double seconds) {
    std::filesystem::create_directories(std::filesystem::path(directory) / ".cases");
    write_atomically(path_of(directory, content_hash(words), ".seconds").string(), fmt::format("{:.3g}\n", seconds));
}

std::optional<double> load_duration(const std::string& directory, const std::string& words) {
    std::ifstream file(path_of(directory, content_hash(words), ".seconds"));
    double seconds = 0;
    if (!(file >> seconds)) return {};
    return seconds;
}

}  // namespace polhode
