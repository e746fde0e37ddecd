// Numerical stability on stiff and extreme scenes: up to which step each method is stable, what happens beyond, and
// whether it says so.
#include "experiment/stability_runs.h"
#include "experiment/stability_tables.h"
#include "experiment/study.h"

namespace polhode {

StudyResult run_stability(const Plan& plan, const RunOptions& options) {
    const StabilityFindings found = run_stability_cases(plan, options);
    StudyResult result;
    result.complete = found.missing == 0;
    if (sweep_interrupted()) return result;
    result.tables = {
        {"",
         "",
         stability_table(plan, found),
         {{"scene", "scene"},
          {"method", "method"},
          {"setting", "setting"},
          {"status", "status"},
          {"outcome", "outcome"},
          {"attitude_error_max", "attitude error (rad)"}}},
        {"limits", "Largest stable and accurate steps", limits_table(found)},
        {"families", "The same by families of scenes", families_table(found)},
        {"linear", "Largest stable h |lambda|: linear theory and measured", linear_table(found)},
        {"outcomes", "How the runs ended", outcomes_table(plan, found)},
        {"tolerances", "Achieved over requested errors", tolerances_table(plan, found)},
        {"counts", "What tolerance-driven methods did", counts_table(found)},
        {"float32", "Binary32 against binary64", float32_table(found)},
    };
    const std::vector<StiffnessCost> costs = stiffness_costs(plan, found);
    result.tables.push_back({"stiffness", "What stiffness costs at equal tolerance", stiffness_table(costs)});
    result.figures = stiffness_figures(plan, costs);
    result.page = stability_page(plan, found, costs, result.tables);
    return result;
}

}  // namespace polhode
