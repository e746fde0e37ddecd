// The kind `drift`: errors over time.
#include "experiment/kinds/curves.h"
#include "experiment/kinds/kinds.h"

namespace polhode {

Findings conclude_drift(const Plan& plan, const std::vector<Result>& rows) {
    NamedTable series{.name = "drift", .title = "", .table = drift_table(plan.experiment.name, rows)};
    series.is_shared = true;
    Findings findings{{std::move(series)}, drift_figures(plan, rows)};
    NamedTable joints{.name = "drift_joints", .title = "", .table = joint_drift_table(plan.experiment.name, rows)};
    joints.is_shared = true;
    if (!joints.table.rows.empty()) findings.tables.push_back(std::move(joints));
    return findings;
}

}  // namespace polhode
