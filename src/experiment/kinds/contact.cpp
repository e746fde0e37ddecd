// The kind `contact`: one body on planes with friction, by time-stepping methods. Position error at each step, observed
// orders, and what each method does to penetration, slip and energy.
//
// An impact or the end of sliding falls somewhere within a step, so that the error of one run varies irregularly with
// the step. The observed order is therefore the least-squares slope over all steps whose error is below the saturation.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "experiment/kinds/cells.h"
#include "experiment/kinds/curves.h"
#include "experiment/kinds/engines.h"
#include "experiment/kinds/kinds.h"
#include "experiment/kinds/step_rows.h"
#include "measure/statistics.h"

namespace polhode {
namespace {

constexpr double lost_position = 1;       // m; larger errors are not used for the observed order
constexpr double exact_position = 1e-11;  // m; an error below it is rounding, and has no order
constexpr std::size_t fewest_order_points = 3;

// Slope of log(position error) over log(step).
std::optional<double> contact_order(const std::vector<const Result*>& rows) {
    std::vector<std::pair<double, double>> points;
    for (const Result* row : rows) {
        const double error = row->errors["position"].max.value_or(0);
        if (row->status != Status::ok || !(error > exact_position) || !(error < lost_position)) continue;
        points.emplace_back(std::log(row->step_taken.value_or(row->setting)), std::log(error));
    }
    if (points.size() < fewest_order_points) return {};
    const double slope = least_squares_line(points).slope;
    return std::isfinite(slope) ? std::optional(slope) : std::nullopt;
}

// The largest values over the steps of one curve.
struct ContactExtremes {
    std::optional<double> penetration, slip, energy_gain;
};
void keep_largest(std::optional<double>& most, const std::optional<double>& value) {
    if (value && !(most && *most >= *value)) most = value;
}
ContactExtremes contact_extremes(const std::vector<const Result*>& rows) {
    ContactExtremes most;
    for (const Result* row : rows) {
        keep_largest(most.penetration, row->contacts.penetration);
        keep_largest(most.slip, row->contacts.slip);
        keep_largest(most.energy_gain, row->contacts.energy_gain);
    }
    return most;
}

// For each scene and method: position error at each step, order, and the largest of the other errors.
NamedTable contact_scenes_table(const Plan& plan, const std::vector<Result>& rows) {
    const std::vector<double> steps = all_steps(plan);
    std::vector<ColumnChoice> columns{{"scene", "scene"}, {"method", "method"}};
    for (const double step : steps)
        columns.push_back({"position_error at " + step_name(step), "position, " + step_name(step) + " (m)"});
    columns.insert(columns.end(), {{"order", "order"},
                                   {"attitude_error_max", "attitude (rad)"},
                                   {"penetration_max", "penetration (m)"},
                                   {"slip_error_max", "slip (m/s)"},
                                   {"contact_energy_gain", "energy gain (J)"},
                                   {"message", "remark"}});
    NamedTable named = make_named_table("scenes", "Errors for each scene", columns);
    for (const PlannedScene& scene : plan.scenes)
        for (const PlannedCurve& curve : plan.curves) {
            const std::vector<const Result*> own = select_rows(rows, scene, curve);
            if (curve.kind != SettingKind::step || own.empty()) continue;
            std::vector<Cell> row{scene.label, std::string(curve.method->name)};
            std::string message;
            std::optional<double> attitude;
            for (const Result* r : own) {
                if (message.empty()) message = r->message;
                keep_largest(attitude, r->errors["attitude"].max);
            }
            for (const double step : steps) {
                const Result* r = find_step(own, step);
                row.push_back(r ? error_cell(*r, "position") : Cell());
            }
            const ContactExtremes most = contact_extremes(own);
            row.insert(row.end(), {cell_of(contact_order(own)), cell_of(attitude), cell_of(most.penetration),
                                   cell_of(most.slip), cell_of(most.energy_gain), Cell(message)});
            named.table.rows.push_back(std::move(row));
        }
    return named;
}

// The observed order of each method on each scene.
NamedTable contact_orders_table(const Plan& plan, const std::vector<Result>& rows) {
    std::vector<ColumnChoice> columns{{"method", "method"}};
    for (const PlannedScene& scene : plan.scenes) {
        const std::size_t slash = scene.label.rfind('/');
        columns.push_back({scene.label, slash == std::string::npos ? scene.label : scene.label.substr(slash + 1)});
    }
    NamedTable named = make_named_table("orders", "Observed order of the position", columns);
    for (const PlannedCurve& curve : plan.curves) {
        if (curve.kind != SettingKind::step) continue;
        std::vector<Cell> row{std::string(curve.method->name)};
        for (const PlannedScene& scene : plan.scenes)
            row.push_back(cell_of(contact_order(select_rows(rows, scene, curve))));
        named.table.rows.push_back(std::move(row));
    }
    return named;
}

// For each method at each step: medians over the scenes, and the largest penetration and energy gain.
NamedTable contact_methods_table(const Plan& plan, const std::vector<Result>& rows) {
    NamedTable named = make_named_table("methods", "Over all scenes",
                                        {{"method", "method"},
                                         {"step", "step"},
                                         {"scenes", "scenes"},
                                         {"ended_otherwise", "other outcomes"},
                                         {"position_error", "position (m)"},
                                         {"attitude_error", "attitude (rad)"},
                                         {"worst_penetration", "worst penetration (m)"},
                                         {"worst_slip", "worst slip (m/s)"},
                                         {"worst_energy_gain", "worst energy gain (J)"},
                                         {"step_nanoseconds", ""}});
    for (const PlannedCurve& curve : plan.curves) {
        if (curve.kind != SettingKind::step) continue;
        for (const double step : curve.settings) {
            std::vector<double> positions, attitudes;
            std::vector<const Result*> ok;
            std::map<std::string, long> others;
            for (const PlannedScene& scene : plan.scenes) {
                const Result* r = find_step(select_rows(rows, scene, curve), step);
                if (!r) continue;
                if (r->status != Status::ok) {
                    ++others[name_of(r->status)];
                    continue;
                }
                ok.push_back(r);
                if (r->errors["position"].max) positions.push_back(*r->errors["position"].max);
                if (r->errors["attitude"].max) attitudes.push_back(*r->errors["attitude"].max);
            }
            const ContactExtremes most = contact_extremes(ok);
            named.table.rows.push_back({std::string(curve.method->name), step_name(step), static_cast<long>(ok.size()),
                                        list_counts(others), median_cell(positions), median_cell(attitudes),
                                        cell_of(most.penetration), cell_of(most.slip), cell_of(most.energy_gain),
                                        cell_of(step_nanoseconds(ok))});
        }
    }
    return named;
}

// Position error against the step, a panel for each scene.
std::vector<NamedFigure> contact_figures(const Plan& plan, const std::vector<Result>& rows) {
    Figure figure;
    figure.title = plan.experiment.name, figure.columns = 2;
    for (const PlannedScene& scene : plan.scenes) {
        Panel panel{scene.label, "step (s)", "largest position error (m)", true, true, {}};
        for (const PlannedCurve& planned : plan.curves) {
            if (planned.kind != SettingKind::step) continue;
            Curve curve;
            curve.label = curve_label(planned);
            style_curve(curve, planned);
            for (const Result* row : select_rows(rows, scene, planned)) {
                if (row->status != Status::ok || !row->errors["position"].max) continue;
                curve.x.push_back(row->step_taken.value_or(row->setting));
                curve.y.push_back(*row->errors["position"].max);
            }
            if (!curve.x.empty()) panel.curves.push_back(std::move(curve));
        }
        figure.panels.push_back(std::move(panel));
    }
    add_figure_notes(figure, plan);
    return {{plan.experiment.name, std::move(figure)}};
}

}  // namespace

Findings conclude_contact(const Plan& plan, const std::vector<Result>& rows) {
    if (all_steps(plan).empty()) return {};
    return {{contact_methods_table(plan, rows), contact_orders_table(plan, rows), contact_scenes_table(plan, rows)},
            contact_figures(plan, rows)};
}

}  // namespace polhode
