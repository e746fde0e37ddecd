// The kind `joints`: mechanisms with the joint solvers of games and robotics. Attitude error, joint gaps and energy
// error at each step.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "experiment/kinds/cells.h"
#include "experiment/kinds/curves.h"
#include "experiment/kinds/engines.h"
#include "experiment/kinds/kinds.h"
#include "experiment/kinds/step_rows.h"
#include "measure/observed_order.h"
#include "measure/statistics.h"
#include "text/decimal.h"

namespace polhode {
namespace {

constexpr double lost_attitude = 1;  // rad; larger errors are not used for the observed order

// The parameter that is varied, if exactly one has several values; else null.
const Variation* find_varied_parameter(const Plan& plan) {
    const auto many = [](const Variation& v) { return v.values.size() > 1; };
    const std::vector<Variation>& vary = plan.experiment.vary;
    return std::ranges::count_if(vary, many) == 1 ? &*std::ranges::find_if(vary, many) : nullptr;
}

// For each scene and method: attitude error, largest joint gap and energy error at each step. The page shows the energy
// error at the largest step only.
NamedTable scenes_table(const Plan& plan, const std::vector<Result>& rows) {
    const std::vector<double> steps = all_steps(plan);
    std::vector<ColumnChoice> columns{{"scene", "scene"}, {"method", "method"}};
    for (const double step : steps)
        columns.push_back({"attitude_error at " + step_name(step), "attitude, " + step_name(step) + " (rad)"});
    columns.push_back({"order", "order"});
    for (const double step : steps)
        columns.push_back({"joint_gap at " + step_name(step), "gap, " + step_name(step) + " (m)"});
    for (const double step : steps)
        columns.push_back(
            {"energy_error at " + step_name(step), step == steps.front() ? "energy, " + step_name(step) : ""});
    columns.push_back({"step_nanoseconds", "ns per step"});
    columns.push_back({"message", "remark"});
    NamedTable named = make_named_table("scenes", "Errors for each scene", columns);
    for (const PlannedScene& scene : plan.scenes)
        for (const PlannedCurve& curve : plan.curves) {
            if (curve.kind != SettingKind::step) continue;
            const std::vector<const Result*> own = select_rows(rows, scene, curve);
            if (own.empty()) continue;
            std::vector<Cell> row{scene.label, std::string(curve.method->name)};
            std::vector<double> reached, error;
            std::string message;
            for (const Result* r : own) {
                if (r->status != Status::ok && message.empty()) message = r->message;
                if (r->status != Status::ok || !r->errors["attitude"].max) continue;
                reached.push_back(r->step_taken.value_or(r->setting)), error.push_back(*r->errors["attitude"].max);
            }
            const auto add = [&](const char* measure) {
                for (const double step : steps) {
                    row.emplace_back();
                    if (const Result* r = find_step(own, step)) row.back() = error_cell(*r, measure);
                }
            };
            add("attitude");
            const auto order = observed_order(reached, error, lost_attitude);
            row.push_back(cell_of(order ? std::optional(order->order) : std::nullopt));
            add("joint_gap");
            add("energy");
            row.push_back(cell_of(step_nanoseconds(own)));
            row.emplace_back(message);
            named.table.rows.push_back(std::move(row));
        }
    return named;
}

// For each method at each step: medians over the scenes, and the number of completed scenes.
NamedTable methods_table(const Plan& plan, const std::vector<Result>& rows) {
    NamedTable named = make_named_table("methods", "Over all scenes",
                                        {{"method", "method"},
                                         {"step", "step"},
                                         {"scenes", "scenes"},
                                         {"ended_otherwise", "other outcomes"},
                                         {"attitude_error", "attitude (rad)"},
                                         {"joint_gap", "gap (m)"},
                                         {"worst_joint_gap", "worst gap (m)"},
                                         {"energy_error", "energy"},
                                         {"step_nanoseconds", "ns per step"}});
    for (const PlannedCurve& curve : plan.curves) {
        if (curve.kind != SettingKind::step) continue;
        for (const double step : curve.settings) {
            std::vector<double> attitudes, gaps, energies, seconds;
            std::map<std::string, long> others;
            long ok = 0;
            for (const PlannedScene& scene : plan.scenes) {
                const Result* r = find_step(select_rows(rows, scene, curve), step);
                if (!r) continue;
                if (r->status != Status::ok) {
                    ++others[name_of(r->status)];
                    continue;
                }
                ++ok;
                const auto note = [&](std::vector<double>& list, const char* measure) {
                    if (const std::optional<double> value = r->errors[measure].max) list.push_back(*value);
                };
                note(attitudes, "attitude"), note(gaps, "joint_gap"), note(energies, "energy");
                if (const auto time = step_nanoseconds({r})) seconds.push_back(*time);
            }
            named.table.rows.push_back({std::string(curve.method->name), step_name(step), ok, list_counts(others),
                                        median_cell(attitudes), median_cell(gaps), max_cell(gaps),
                                        median_cell(energies), median_cell(seconds)});
        }
    }
    return named;
}

// Errors against the step, or at the largest step against the parameter that is varied.
std::vector<NamedFigure> joint_figures(const Plan& plan, const std::vector<Result>& rows) {
    const std::vector<double> steps = all_steps(plan);
    const Variation* const parameter = find_varied_parameter(plan);
    Figure figure;
    figure.title = plan.experiment.name, figure.columns = 2;
    const std::size_t scenes_a_panel = parameter ? parameter->values.size() : 1;
    for (std::size_t first = 0; first < plan.scenes.size(); first += scenes_a_panel)
        for (const auto& [measure, label] :
             {std::pair{"attitude", "largest attitude error (rad)"}, {"joint_gap", "largest joint gap (m)"}}) {
            Panel panel{
                parameter ? plan.scenes[first].scene.name + ", " + step_name(steps.front()) : plan.scenes[first].label,
                parameter ? parameter->pointer : "step (s)",
                label,
                true,
                true,
                {}};
            for (const PlannedCurve& planned : plan.curves) {
                if (planned.kind != SettingKind::step) continue;
                Curve curve;
                curve.label = curve_label(planned);
                style_curve(curve, planned);
                const auto add = [&, measure = measure](double x, const Result* row) {
                    if (!row || row->status != Status::ok || !row->errors[measure].max) return;
                    curve.x.push_back(x), curve.y.push_back(*row->errors[measure].max);
                };
                for (std::size_t i = 0; i < scenes_a_panel; ++i) {
                    const auto own = select_rows(rows, plan.scenes[first + i], planned);
                    if (parameter)
                        add(parse_decimal(parameter->values[i]).value_or(0), find_step(own, steps.front()));
                    else
                        for (const Result* row : own) add(row->step_taken.value_or(row->setting), row);
                }
                if (!curve.x.empty()) panel.curves.push_back(std::move(curve));
            }
            figure.panels.push_back(std::move(panel));
        }
    add_figure_notes(figure, plan);
    return {{plan.experiment.name, std::move(figure)}};
}

}  // namespace

Findings conclude_joints(const Plan& plan, const std::vector<Result>& rows) {
    if (all_steps(plan).empty()) return {};
    std::vector<NamedTable> tables{scenes_table(plan, rows)};
    if (!find_varied_parameter(plan)) tables.push_back(methods_table(plan, rows));
    return {std::move(tables), joint_figures(plan, rows)};
}

}  // namespace polhode
