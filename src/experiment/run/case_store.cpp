#include "experiment/run/case_store.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "integrators/engines/engine_methods.h"
#include "integrators/user_methods.h"
#include "text/atomic_file.h"
#include "text/content_hash.h"
#include "text/json_document.h"
#include "text/message.h"
#include "text/sealed.h"

namespace polhode {
namespace {

constexpr const char* done_text = "done\n";

std::filesystem::path path_of(const std::string& directory, const std::string& key, const char* ending) {
    return std::filesystem::path(directory) / ".cases" / (key + ending);
}

// writes a file with a checksum
void save(const std::filesystem::path& path, std::string_view text) {
    std::error_code fault;
    std::filesystem::create_directories(path.parent_path(), fault);
    if (fault)
        throw std::runtime_error(fmt::format("{}: cannot create this directory: {}",
                                             one_line(path.parent_path().string(), 500), fault.message()));
    write_atomically(path.string(), seal(text));
}

std::optional<Table> load_table(const std::filesystem::path& path) {
    const std::optional<std::string> text = read_sealed(path.string());
    if (!text) return {};
    try {
        return parse_csv(*text);
    } catch (const std::invalid_argument&) {
        return {};
    }
}

}  // namespace

std::string running_program_key() {
    if (!has_user_methods()) return program_key();
    static const std::string key =
        std::string(program_key()) +
        content_hash(read_text("/proc/self/exe", std::size_t{4} << 30, "this program's own executable"));
    return key;
}

namespace {

// The part of a case's key that program_key() does not cover: the version of an engine, which is another program, or
// the identity of a user-defined method.
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
        Result result = parse_result(*row, 0);
        const std::filesystem::path path = path_of(directory, key, ".series.csv");
        if (const auto series = load_table(path))
            result.series = parse_series(*series);
        else if (std::filesystem::exists(path))
            return {};
        return result;
    } catch (const std::invalid_argument&) {
        return {};
    }
}

void save_case(const std::string& directory, const std::string& key, const std::string& experiment,
               const Result& result) {
    // the series first, so that a case with a row is complete
    if (!result.series.t.empty()) save(path_of(directory, key, ".series.csv"), csv(series_table(result.series)));
    save(path_of(directory, key, ".csv"),
         csv({result_columns(TableKind::stored), {result_row(experiment, result, TableKind::stored)}}));
}

std::optional<Table> load_rows(const std::string& directory, const std::string& key) {
    return load_table(path_of(directory, key, ".rows.csv"));
}

void save_rows(const std::string& directory, const std::string& key, const Table& rows) {
    save(path_of(directory, key, ".rows.csv"), csv(rows));
}

void save_done(const std::string& directory, const std::string& key) {
    save(path_of(directory, key, ".done"), done_text);
}

bool is_done(const std::string& directory, const std::string& key) {
    return read_sealed(path_of(directory, key, ".done").string()) == done_text;
}

void save_duration(const std::string& directory, const std::string& description, double seconds) {
    save(path_of(directory, content_hash(description), ".seconds"), fmt::format("{:.3g}\n", seconds));
}

std::optional<double> load_duration(const std::string& directory, const std::string& description) {
    const std::string path = path_of(directory, content_hash(description), ".seconds").string();
    std::ifstream file(path, std::ios::binary);
    const std::string text(std::istreambuf_iterator<char>(file), {});
    const std::optional<std::string> sealed = unseal(text);
    // a file of an older program has neither checksum nor comment; it is not reported as corrupted
    if (!sealed && text.find('#') != text.npos) warn_damaged(path);
    std::istringstream number(sealed.value_or(""));
    number.imbue(std::locale::classic());
    double seconds = 0;
    if (!(number >> seconds)) return {};
    return seconds;
}

}  // namespace polhode
