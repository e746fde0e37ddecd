// The kind `convergence`: observed orders.
#include <algorithm>

#include "experiment/kinds/curves.h"
#include "experiment/kinds/kinds.h"
#include "experiment/kinds/sweep_tables.h"
#include "measure/observed_order.h"

namespace polhode {

Table order_table(const Plan& plan, const std::vector<Result>& results) {
    Table table{{"scene", "method", "setting_kind", "claimed_order", "observed_order", "points", "from", "to",
                 "smallest_error", "largest_error", "float64_floor"},
                {}};
    for (const PlannedScene& scene : plan.scenes)
        for (const PlannedCurve& curve : plan.curves) {
            std::vector<double> setting, error;
            std::optional<double> floor;  // at T, as the errors
            for (const Result* row : select_rows(results, scene, curve)) {
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

Findings conclude_convergence(const Plan& plan, const std::vector<Result>& rows) {
    return {{{"orders", "Observed orders", order_table(plan, rows)}}, convergence_figures(plan, rows)};
}

}  // namespace polhode
