// The kind `contact_stiffness`: penalty methods whose tolerance R sets the stiffness, which is proportional to 1/R.
// Errors against the rigid reference as the stiffness grows, and their order in 1/k.
#include <algorithm>
#include <string>
#include <vector>

#include "experiment/kinds/contact_tables.h"
#include "experiment/kinds/curves.h"
#include "experiment/kinds/kinds.h"
#include "experiment/kinds/step_rows.h"

namespace polhode {
namespace {

// All tolerances of the plan, from coarse to fine.
std::vector<double> all_tolerances(const Plan& plan) {
    for (const PlannedCurve& curve : plan.curves)
        if (curve.kind == SettingKind::tolerance) return curve.settings;
    return {};
}

std::vector<ColumnChoice> limit_columns(const std::vector<double>& tolerances) {
    std::vector<ColumnChoice> columns{{"scene", "scene"}, {"method", "method"}};
    for (const double tolerance : tolerances) {
        const std::string setting = fmt::format("R = {:g}", tolerance);
        columns.push_back({"position_error at " + setting, "position, " + setting + " (m)"});
    }
    columns.insert(columns.end(), {{"order", "order in 1/k"},
                                   {"attitude_error_smallest", "smallest attitude error (rad)"},
                                   {"penetration_smallest", "smallest penetration (m)"},
                                   {"seconds_largest", "longest run (s)"},
                                   {"message", "remark"}});
    return columns;
}

void keep_smallest(std::optional<double>& least, const std::optional<double>& value) {
    if (value && !(least && *least <= *value)) least = value;
}

std::vector<Cell> limit_row(const std::string& scene, const PlannedCurve& curve, const std::vector<double>& tolerances,
                            const std::vector<const Result*>& rows) {
    std::vector<Cell> row{scene, std::string(curve.method->name)};
    std::optional<double> attitude, penetration, seconds;
    std::string message;
    for (const Result* r : rows) {
        if (message.empty()) message = r->message;
        keep_smallest(attitude, r->errors["attitude"].max);
        keep_smallest(penetration, r->contacts.penetration);
        keep_largest(seconds, r->seconds_min);
    }
    for (const double tolerance : tolerances) {
        const Result* r = find_step(rows, tolerance);
        row.push_back(r ? error_cell(*r, "position") : Cell());
    }
    row.insert(row.end(), {cell_of(contact_order(rows)), cell_of(attitude), cell_of(penetration), cell_of(seconds),
                           Cell(message)});
    return row;
}

}  // namespace

Findings conclude_contact_stiffness(const Plan& plan, const std::vector<Result>& rows) {
    const std::vector<double> tolerances = all_tolerances(plan);
    if (tolerances.empty()) return {};
    NamedTable named =
        make_named_table("limits", "Position error as the stiffness k grows as 1/R", limit_columns(tolerances));
    Figure figure;
    figure.title = plan.experiment.name, figure.columns = 2;
    for (const PlannedScene& scene : plan.scenes) {
        Panel panel{scene.label, "R, proportional to 1/k", "largest position error (m)", true, true, {}};
        for (const PlannedCurve& planned : plan.curves) {
            const std::vector<const Result*> own = select_rows(rows, scene, planned);
            if (planned.kind != SettingKind::tolerance || own.empty()) continue;
            named.table.rows.push_back(limit_row(scene.label, planned, tolerances, own));
            Curve curve;
            curve.label = curve_label(planned);
            style_curve(curve, planned);
            for (const Result* row : own)
                if (row->status == Status::ok && row->errors["position"].max)
                    curve.x.push_back(row->setting), curve.y.push_back(*row->errors["position"].max);
            if (!curve.x.empty()) panel.curves.push_back(std::move(curve));
        }
        figure.panels.push_back(std::move(panel));
    }
    add_figure_notes(figure, plan);
    return {{std::move(named)}, {{plan.experiment.name, std::move(figure)}}};
}

}  // namespace polhode
