// Errors over time.
#include "experiment/kinds/curves.h"
#include "experiment/kinds/kinds.h"

namespace polhode {

Findings conclude_drift(const Plan& plan, const std::vector<Result>& rows) {
    NamedTable series{.name = "drift", .title = "", .table = drift_table(plan.experiment.name, rows)};
    series.is_shared = true;
    return {{std::move(series)}, drift_figures(plan, rows)};
}

}  // namespace polhode
