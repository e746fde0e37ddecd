// The kind `contact`: one body on planes with friction, by time-stepping methods. Position error at each step, observed
// orders, and what each method does to penetration, slip and energy.
//
// An impact or the end of sliding falls somewhere within a step, so that the error of one run varies irregularly with
// the step. The observed order is therefore the least-squares slope over all steps whose error is below the saturation.
#include <map>
#include <optional>

#include "experiment/kinds/cells.h"
#include "experiment/kinds/contact_tables.h"
#include "experiment/kinds/curves.h"
#include "experiment/kinds/engines.h"
#include "experiment/kinds/kinds.h"
#include "experiment/kinds/step_rows.h"

namespace polhode {
namespace {

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
    return {{contact_methods_table(plan, rows), contact_orders_table(plan, rows),
             contact_scenes_table(plan, rows, {"position"})},
            contact_figures(plan, rows)};
}

}  // namespace polhode
