// Error against run time, and the fastest at each accuracy.
#include <algorithm>

#include "experiment/kinds/curves.h"
#include "experiment/kinds/kinds.h"
#include "experiment/kinds/sweep_tables.h"

namespace polhode {

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

Findings conclude_sweep(const Plan& plan, const std::vector<Result>& rows) {
    // one run of each method is no curve, and of one method nothing is the fastest: the table says it all
    if (std::all_of(plan.curves.begin(), plan.curves.end(),
                    [](const PlannedCurve& c) { return c.kind == SettingKind::none; }))
        return {};
    Findings findings{{{"fastest", "Fastest at each accuracy", fastest_table(plan, rows)}},
                      work_precision_figures(plan, rows)};
    if (is_described(plan)) findings.tables.push_back(summary_table(plan, rows));
    return findings;
}

}  // namespace polhode
