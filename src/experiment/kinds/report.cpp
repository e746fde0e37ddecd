#include "experiment/kinds/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "experiment/run/provenance.h"
#include "experiment/run/study.h"
#include "integrators/sundials/build.h"
#include "measure/observed_order.h"
#include "text/atomic_file.h"

namespace polhode {
namespace {

// What a reader of the page needs of the columns; the csv has them all.
Table for_people(const Table& table) {
    return select(table, {{"scene", "scene"},
                          {"method", "method"},
                          {"setting_kind", "setting"},
                          {"setting", "value"},
                          {"status", "status"},
                          {"seconds_median", "time (s)"},
                          {"steps", "steps"},
                          {"rhs_evaluations", "evaluations"},
                          {"attitude_error_final", "attitude, end (rad)"},
                          {"attitude_error_max", "attitude, max (rad)"},
                          {"float64_floor", "float64 floor (rad)"},
                          {"float32_floor", "float32 floor (rad)"},
                          {"momentum_error_max", "momentum"},
                          {"energy_error_max", "energy"},
                          {"message", "message"}});
}

// beside each method what the text that it is from calls it
void add_descriptions(Table& page) {
    const std::size_t method = column_index(page, "method");
    page.columns.insert(page.columns.begin() + static_cast<long>(method) + 1, "described as");
    for (auto& row : page.rows) {
        const Method* known = find_method(text_of(row[method]));
        row.insert(row.begin() + static_cast<long>(method) + 1, std::string(known ? known->described_as : ""));
    }
}

const std::vector<ColumnChoice> gain_for_people{{"scene", "scene"},
                                                {"method", "method"},
                                                {"setting_kind", "setting"},
                                                {"variables", "variables"},
                                                {"attitude_error", "attitude error (rad)"},
                                                {"seconds_as_written", "full (s)"},
                                                {"seconds_principal_frame", "full, principal frame (s)"},
                                                {"seconds_reduced", "reduced (s)"},
                                                {"gain", "gain"},
                                                {"error_ratio", "error at equal settings"},
                                                {"left_out", "left out"}};

const std::vector<ColumnChoice> growth_for_people{{"scene", "scene"},
                                                  {"evaluations_per_revolution", "evaluations a revolution"},
                                                  {"method", "method"},
                                                  {"setting_kind", "setting"},
                                                  {"setting", "value"},
                                                  {"energy_error", "energy"},
                                                  {"energy_exponent", "energy, exponent"},
                                                  {"momentum_error", "momentum"},
                                                  {"momentum_exponent", "momentum, exponent"},
                                                  {"attitude_error", "attitude (rad)"},
                                                  {"attitude_exponent", "attitude, exponent"},
                                                  {"norm_error", "norm"},
                                                  {"norm_exponent", "norm, exponent"},
                                                  {"message", "message"}};

const std::vector<ColumnChoice> summary_for_people{{"described_as", "what the text describes"},
                                                   {"method", "method"},
                                                   {"order", "order"},
                                                   {"setting_kind", "setting"},
                                                   {"setting", "value"},
                                                   {"scenes_ok", "scenes ok"},
                                                   {"scenes_not_ok", "ended otherwise"},
                                                   {"attitude_error_median", "attitude, median (rad)"},
                                                   {"attitude_error_worst", "attitude, worst (rad)"},
                                                   {"momentum_error_worst", "momentum, worst"},
                                                   {"energy_error_worst", "energy, worst"},
                                                   {"norm_error_worst", "norm, worst"},
                                                   {"step_time_ratio", "time of a step, RK4 = 1"}};

void write_table(const Table& full, const Table& short_form, const std::string& caption, const std::string& path,
                 const std::string& name) {
    write_atomically(path + ".csv", csv(full));
    write_atomically(path + ".json", json(full));
    write_atomically(path + ".md", markdown(short_form));
    write_atomically(path + ".tex", latex(short_form, caption, "tab:" + name));
}

// A scene's name may hold a slash: in the name of a file it would be a directory.
std::string file_name(std::string name) {
    std::replace(name.begin(), name.end(), '/', '_');
    return name;
}

std::vector<std::string> draw_all(const std::vector<NamedFigure>& figures, const std::string& directory) {
    std::vector<std::string> remarks;
    for (const NamedFigure& named : figures) {
        const std::string fault =
            draw(named.figure, (std::filesystem::path(directory) / file_name(named.name)).string());
        if (!fault.empty()) remarks.push_back(named.name + ": " + fault);
    }
    return remarks;
}

// drift.csv is shared by all experiments of this kind: the rows of the others stay.
void write_drift(const std::string& directory, const std::string& experiment, const std::vector<Result>& results) {
    const std::filesystem::path path = std::filesystem::path(directory) / "drift.csv";
    Table table = drift_table(experiment, results);
    std::ifstream file(path, std::ios::binary);
    try {
        const Table old = parse_csv(std::string(std::istreambuf_iterator<char>(file), {}));
        if (old.columns == table.columns)
            for (const auto& row : old.rows)
                if (text_of(row.back()) != experiment) table.rows.push_back(row);
    } catch (const std::invalid_argument&) {
        // none there yet, or none of ours
    }
    std::stable_sort(table.rows.begin(), table.rows.end(),
                     [](const auto& a, const auto& b) { return text_of(a.back()) < text_of(b.back()); });
    write_atomically(path.string(), csv(table));
}

}  // namespace

std::vector<const Result*> rows_of(const std::vector<Result>& results, const PlannedScene& scene,
                                   const PlannedCurve& curve) {
    std::vector<const Result*> rows;
    for (const Result& r : results)
        if (r.scene == scene.label && r.method == curve.method->name && r.setting_kind == curve.kind &&
            r.formulation == curve.formulation)
            rows.push_back(&r);
    return rows;
}

Table order_table(const Plan& plan, const std::vector<Result>& results) {
    Table table{{"scene", "method", "setting_kind", "claimed_order", "observed_order", "points", "from", "to",
                 "smallest_error", "largest_error", "float64_floor"},
                {}};
    for (const PlannedScene& scene : plan.scenes)
        for (const PlannedCurve& curve : plan.curves) {
            std::vector<double> setting, error;
            std::optional<double> floor;  // at the end, as the errors
            for (const Result* row : rows_of(results, scene, curve)) {
                if (row->status != Status::ok || !row->errors["attitude"].final) continue;
                setting.push_back(row->step_taken.value_or(row->setting));
                floor = row->floors.float64_final;
                error.push_back(*row->errors["attitude"].final);
            }
            if (error.empty() || curve.kind == SettingKind::none) continue;
            const auto observed = observed_order(setting, error, 1);
            const bool step = curve.kind == SettingKind::step;
            table.rows.push_back({scene.label, std::string(curve.method->name), std::string(name_of(curve.kind)),
                                  step && curve.method->order > 0 ? Cell(long(curve.method->order)) : Cell(),
                                  observed ? Cell(observed->order) : Cell(),
                                  observed ? Cell(long(observed->points)) : Cell(),
                                  observed ? Cell(observed->from) : Cell(), observed ? Cell(observed->to) : Cell(),
                                  *std::min_element(error.begin(), error.end()),
                                  *std::max_element(error.begin(), error.end()), cell_of(floor)});
        }
    return table;
}

Table fastest_table(const Plan& plan, const std::vector<Result>& results) {
    Table table{{"scene", "attitude_error", "method", "setting_kind", "setting", "seconds_median", "rhs_evaluations",
                 "runner_up", "ratio"},
                {}};
    for (const PlannedScene& scene : plan.scenes)
        for (const double wanted : {1e-3, 1e-6, 1e-9, 1e-12}) {
            // the fastest run of each method, then the fastest of these
            std::vector<const Result*> best;
            for (const Result& r : results) {
                if (r.scene != scene.label || r.status != Status::ok || !r.seconds_median) continue;
                if (!r.errors["attitude"].max || *r.errors["attitude"].max > wanted) continue;
                const auto same = std::find_if(best.begin(), best.end(),
                                               [&](const Result* other) { return other->method == r.method; });
                if (same == best.end())
                    best.push_back(&r);
                else if (*r.seconds_median < *(*same)->seconds_median)
                    *same = &r;
            }
            std::sort(best.begin(), best.end(),
                      [](const Result* a, const Result* b) { return *a->seconds_median < *b->seconds_median; });
            if (best.empty()) {
                table.rows.push_back({scene.label, wanted, std::string("none reaches it"), {}, {}, {}, {}, {}, {}});
                continue;
            }
            const Result& first = *best[0];
            std::vector<Cell> row{scene.label,
                                  wanted,
                                  first.method,
                                  std::string(name_of(first.setting_kind)),
                                  first.setting_kind == SettingKind::none ? Cell() : Cell(first.setting),
                                  *first.seconds_median,
                                  first.rhs_evaluations ? Cell(*first.rhs_evaluations) : Cell(),
                                  {},
                                  {}};
            if (best.size() > 1) {
                row[7] = best[1]->method;
                row[8] = *best[1]->seconds_median / *first.seconds_median;
            }
            table.rows.push_back(std::move(row));
        }
    return table;
}

std::vector<std::string> write_report(const Plan& plan, const std::vector<Result>& results,
                                      const std::string& directory, const std::string& command_line, bool quick) {
    const std::string& name = plan.experiment.name;
    std::filesystem::create_directories(directory);
    const std::string base = (std::filesystem::path(directory) / name).string();
    const std::string caption = plan.experiment.about + (sundials_unoptimised() ? " (SUNDIALS unoptimised)" : "");

    Table full{result_columns(), {}};
    for (const Result& r : results) full.rows.push_back(row_of(name, r));
    const bool described = std::any_of(plan.curves.begin(), plan.curves.end(),
                                       [](const PlannedCurve& c) { return !c.method->described_as.empty(); });
    Table page = for_people(full);
    if (described) add_descriptions(page);
    write_table(full, page, caption, base, name);

    // a second table of what the rows say
    const auto write_finding = [&](const char* word, const Table& table, const char* title,
                                   const std::vector<ColumnChoice>& choices = {}) {
        write_table(table, choices.empty() ? table : select(table, choices), fmt::format("{}: {}", title, caption),
                    base + "_" + word, name + "_" + word);
    };
    std::vector<NamedFigure> figures;
    switch (plan.experiment.kind) {
        case Kind::sweep:
            // one run of each method is no curve, and of one method nothing is the fastest: the table says it all
            if (std::all_of(plan.curves.begin(), plan.curves.end(),
                            [](const PlannedCurve& c) { return c.kind == SettingKind::none; }))
                break;
            write_finding("fastest", fastest_table(plan, results), "Fastest at each accuracy");
            if (described)
                write_finding("summary", summary_table(plan, results), "Over all scenes", summary_for_people);
            figures = work_precision_figures(plan, results);
            break;
        case Kind::convergence:
            write_finding("orders", order_table(plan, results), "Observed orders");
            figures = convergence_figures(plan, results);
            break;
        case Kind::drift:
            write_drift(directory, name, results);
            figures = drift_figures(plan, results);
            break;
        case Kind::tolerance:
            write_finding("digits", digits_table(plan, results), "Digits gained over the tolerance");
            figures = tolerance_figures(plan, results);
            break;
        case Kind::leave_out:
            write_finding("gain", gain_table(plan, results), "What leaving out is worth", gain_for_people);
            break;
        case Kind::conservation:
            write_finding("growth", growth_table(plan, results), "Growth of errors", growth_for_people);
            figures = conservation_figures(plan, results);
            break;
        case Kind::study:
            break;
    }
    std::vector<std::string> remarks = draw_all(figures, directory);
    record_provenance(directory, name, command_line, quick);
    return remarks;
}

std::vector<std::string> write_study_report(const Plan& plan, const StudyResult& result, const std::string& directory,
                                            const std::string& command_line, bool quick) {
    const std::string& experiment = plan.experiment.name;
    std::filesystem::create_directories(directory);
    for (const NamedTable& named : result.tables) {
        const std::string name = named.name.empty() ? experiment : experiment + "_" + named.name;
        const std::string path = (std::filesystem::path(directory) / name).string();
        if (named.only_csv)
            write_atomically(path + ".csv", csv(named.table));
        else
            write_table(named.table, named.for_people.empty() ? named.table : select(named.table, named.for_people),
                        named.title.empty() ? plan.experiment.about : named.title, path, name);
    }
    if (!result.page.empty())
        write_atomically((std::filesystem::path(directory) / (experiment + ".md")).string(), result.page);
    std::vector<std::string> remarks = draw_all(result.figures, directory);
    record_provenance(directory, experiment, command_line, quick);
    return remarks;
}

}  // namespace polhode
