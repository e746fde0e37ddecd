#include "experiment/kinds/contact_tables.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "experiment/kinds/curves.h"
#include "experiment/kinds/engines.h"
#include "experiment/kinds/step_rows.h"
#include "measure/statistics.h"

namespace polhode {
namespace {

constexpr double lost_position = 1;       // m; larger errors are not used for the observed order
constexpr double exact_position = 1e-11;  // m; an error below it is rounding, and has no order
constexpr std::size_t fewest_order_points = 3;

std::vector<ColumnChoice> scene_columns(const Plan& plan, const std::vector<std::string>& measures, bool has_attitude) {
    std::vector<ColumnChoice> columns{{"scene", "scene"}, {"method", "method"}};
    for (const std::string& measure : measures)
        for (const double step : all_steps(plan))
            columns.push_back({measure + "_error at " + step_name(step),
                               measure + ", " + step_name(step) + (measure == "attitude" ? " (rad)" : " (m)")});
    columns.push_back({"order", "order"});
    if (!has_attitude) columns.push_back({"attitude_error_max", "attitude (rad)"});
    columns.insert(columns.end(), {{"penetration_max", "penetration (m)"},
                                   {"slip_error_max", "slip (m/s)"},
                                   {"contact_energy_gain", "energy gain (J)"},
                                   {"message", "remark"}});
    return columns;
}

}  // namespace

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

NamedTable contact_scenes_table(const Plan& plan, const std::vector<Result>& rows,
                                const std::vector<std::string>& measures) {
    const bool has_attitude = std::ranges::find(measures, "attitude") != measures.end();
    NamedTable named = make_named_table("scenes", "Errors for each scene", scene_columns(plan, measures, has_attitude));
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
            for (const std::string& measure : measures)
                for (const double step : all_steps(plan)) {
                    const Result* r = find_step(own, step);
                    row.push_back(r ? error_cell(*r, measure.c_str()) : Cell());
                }
            const ContactExtremes most = contact_extremes(own);
            row.push_back(cell_of(contact_order(own)));
            if (!has_attitude) row.push_back(cell_of(attitude));
            row.insert(row.end(),
                       {cell_of(most.penetration), cell_of(most.slip), cell_of(most.energy_gain), Cell(message)});
            named.table.rows.push_back(std::move(row));
        }
    return named;
}

}  // namespace polhode
