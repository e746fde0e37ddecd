// The kind `sweep`: error against run time, and the fastest method at each accuracy.
#include <algorithm>

#include "experiment/kinds/curves.h"
#include "experiment/kinds/kinds.h"
#include "experiment/kinds/sweep_tables.h"
#include "experiment/run/fastest.h"

namespace polhode {

Table fastest_table(const Plan& plan, const std::vector<Result>& results) {
    Table table{{"scene", "attitude_error", "method", "setting_kind", "setting", "seconds_median", "rhs_evaluations",
                 "runner_up", "ratio"},
                {}};
    for (const PlannedScene& scene : plan.scenes)
        for (const double wanted : accuracy_levels) {
            const std::vector<const Result*> best = sort_by_time(results, scene.label, wanted);
            if (best.empty()) {
                table.rows.push_back(
                    {scene.label, wanted, std::string("no method reaches it"), {}, {}, {}, {}, {}, {}});
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

Findings conclude_sweep(const Plan& plan, const std::vector<Result>& rows) {
    // methods without a setting have one run each, so there are no curves to draw or compare
    if (std::all_of(plan.curves.begin(), plan.curves.end(),
                    [](const PlannedCurve& c) { return c.kind == SettingKind::none; }))
        return {};
    Findings findings{{{"fastest", "Fastest at each accuracy", fastest_table(plan, rows)}},
                      work_precision_figures(plan, rows)};
    if (has_source_descriptions(plan)) findings.tables.push_back(summary_table(plan, rows));
    return findings;
}

}  // namespace polhode
