// Summary of each method over all scenes of a sweep.
#include <algorithm>
#include <map>

#include "experiment/kinds/cells.h"
#include "experiment/kinds/sweep_tables.h"

namespace polhode {
namespace {

constexpr const char* yardstick = "odeint_rk4";

double step_time(const Result& row) { return *row.seconds_median / static_cast<double>(*row.steps); }
bool has_step_time(const Result& row) {
    return row.status == Status::ok && row.seconds_median && row.steps && *row.steps > 0;
}

// the median time per step of odeint_rk4 on each scene, over all settings
std::map<std::string, double> yardsticks(const std::vector<Result>& results) {
    std::map<std::string, std::vector<double>> all;
    for (const Result& row : results)
        if (row.method == yardstick && has_step_time(row)) all[row.scene].push_back(step_time(row));
    std::map<std::string, double> medians;
    for (const auto& [scene, times] : all) medians[scene] = median(times);
    return medians;
}

}  // namespace

NamedTable summary_table(const Plan& plan, const std::vector<Result>& results) {
    NamedTable named = make_named_table("summary", "Over all scenes",
                                        {{"described_as", "description in the text"},
                                         {"method", "method"},
                                         {"order", "order"},
                                         {"setting_kind", "setting"},
                                         {"setting", "value"},
                                         {"scenes_ok", "scenes ok"},
                                         {"scenes_not_ok", "other outcomes"},
                                         {"attitude_error_median", "attitude, median (rad)"},
                                         {"attitude_error_worst", "attitude, worst (rad)"},
                                         {"momentum_error_worst", "momentum, worst"},
                                         {"energy_error_worst", "energy, worst"},
                                         {"norm_error_worst", "norm, worst"},
                                         {"step_time_ratio", "time per step, RK4 = 1"}});
    const std::map<std::string, double> rk4 = yardsticks(results);
    for (const PlannedCurve& curve : plan.curves) {
        if (curve.formulation != Formulation::reduced) continue;
        for (const double setting : curve.settings) {
            long ok = 0;
            std::map<std::string, long> others;
            std::vector<double> attitude, momentum, energy, norm, ratios;
            const auto note = [](std::vector<double>& all, const std::optional<double>& value) {
                if (value) all.push_back(*value);
            };
            for (const Result& row : results) {
                if (row.method != curve.method->name || row.setting_kind != curve.kind) continue;
                if (curve.kind != SettingKind::none && row.setting != setting) continue;
                if (row.status != Status::ok) {
                    ++others[name_of(row.status)];
                    continue;
                }
                ++ok;
                note(attitude, row.errors["attitude"].max), note(momentum, row.errors["momentum"].max);
                note(energy, row.errors["energy"].max), note(norm, row.errors["norm"].max);
                if (const auto scene = rk4.find(row.scene); scene != rk4.end() && has_step_time(row))
                    ratios.push_back(step_time(row) / scene->second);
            }
            named.table.rows.push_back({std::string(curve.method->origin), std::string(curve.method->name),
                                        curve.method->order > 0 ? Cell(long(curve.method->order)) : Cell(),
                                        std::string(name_of(curve.kind)),
                                        curve.kind == SettingKind::none ? Cell() : Cell(setting), ok,
                                        list_counts(others), median_cell(attitude), max_cell(attitude),
                                        max_cell(momentum), max_cell(energy), max_cell(norm), median_cell(ratios)});
        }
    }
    return named;
}

}  // namespace polhode
