// The kind `tolerance`: the error of a run against its tolerance.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiment/kinds/cells.h"
#include "experiment/kinds/curves.h"
#include "experiment/kinds/kinds.h"
#include "experiment/kinds/sweep_tables.h"

namespace polhode {
namespace {

// log10(R / error); empty if the run is not `ok`
std::optional<double> digits(const std::vector<const Result*>& rows, double tolerance) {
    for (const Result* row : rows)
        if (row->setting == tolerance && row->status == Status::ok && row->errors["attitude"].max.value_or(0) > 0)
            return std::log10(tolerance / *row->errors["attitude"].max);
    return {};
}

}  // namespace

Table digits_table(const Plan& plan, const std::vector<Result>& results) {
    const std::vector<double>& tolerances = plan.experiment.tolerances;
    Table table{{"scene", "method"}, {}};
    for (const double tolerance : tolerances) table.columns.push_back(fmt::format("{:g}", tolerance));
    // summary rows over all scenes come first
    std::vector<std::vector<Cell>> middles, worsts;
    for (const PlannedCurve& curve : plan.curves) {
        if (curve.kind != SettingKind::tolerance) continue;
        const std::string method(curve.method->name);
        std::vector<Cell> of_middle{std::string("all scenes, median"), method},
            of_worst{std::string("all scenes, worst"), method};
        for (const double tolerance : tolerances) {
            std::vector<double> all;
            for (const PlannedScene& scene : plan.scenes) {
                if (const auto value = digits(select_rows(results, scene, curve), tolerance)) all.push_back(*value);
            }
            of_middle.push_back(median_cell(all)), of_worst.push_back(min_cell(all));
        }
        middles.push_back(std::move(of_middle)), worsts.push_back(std::move(of_worst));
    }
    table.rows = std::move(middles);
    table.rows.insert(table.rows.end(), worsts.begin(), worsts.end());
    for (const PlannedScene& scene : plan.scenes)
        for (const PlannedCurve& curve : plan.curves) {
            if (curve.kind != SettingKind::tolerance) continue;
            const std::vector<const Result*> rows = select_rows(results, scene, curve);
            if (rows.empty()) continue;
            std::vector<Cell> row{scene.label, std::string(curve.method->name)};
            for (const double tolerance : tolerances) row.push_back(cell_of(digits(rows, tolerance)));
            table.rows.push_back(std::move(row));
        }
    return table;
}

Findings conclude_tolerance(const Plan& plan, const std::vector<Result>& rows) {
    return {{{"digits", "log10(tolerance / error)", digits_table(plan, rows)}}, tolerance_figures(plan, rows)};
}

}  // namespace polhode
