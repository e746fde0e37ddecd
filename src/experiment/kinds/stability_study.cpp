// Numerical stability on stiff and extreme scenes: up to which step each method is stable, what happens beyond, and
// whether it says so.
#include <algorithm>

#include "experiment/kinds/kinds.h"
#include "experiment/kinds/stability.h"
#include "experiment/kinds/stability_runs.h"
#include "experiment/kinds/stability_tables.h"

namespace polhode {
namespace {

template <class T>
void append(std::vector<T>& all, std::vector<T>&& more) {
    std::move(more.begin(), more.end(), std::back_inserter(all));
}

// what is no case of its own: done once all cases are there
void add_whole_parts(const Plan& plan, const StabilityFindings& found, const RunOptions& options, Findings& result) {
    std::vector<const Method*> fixed;
    for (const PlannedCurve& curve : plan.curves)
        if (curve.kind == SettingKind::step) fixed.push_back(curve.method);
    result.tables.push_back({"linear", "Largest h |lambda| without growth: linear theory and measured",
                             measure_linear_limits(plan, found, options.jobs, options.quick)});
    Findings maps = run_step_maps(fixed, options.jobs, options.quick);
    append(result.tables, std::move(maps.tables));
    append(result.figures, std::move(maps.figures));
    append(result.figures, draw_stability_regions(plan.scenes));
    result.tables.push_back(measure_discontinuities(options.quick));
}

// one scene in eight of a whole catalogue
Plan thinned(Plan plan) {
    constexpr std::size_t few = 20, every = 8;
    if (plan.scenes.size() <= few) return plan;
    std::vector<PlannedScene> kept;
    for (std::size_t i = 0; i < plan.scenes.size(); i += every) kept.push_back(std::move(plan.scenes[i]));
    plan.scenes = std::move(kept);
    return plan;
}

}  // namespace

Findings run_stability(const Plan& whole, const RunOptions& options) {
    const Plan plan = options.quick ? thinned(whole) : whole;
    const StabilityFindings found = run_stability_cases(plan, options);
    Findings result;
    result.missing = found.missing;
    if (sweep_interrupted()) return result;
    const std::vector<StiffnessCost> costs = stiffness_costs(plan, found);
    const Table float32 = float32_table(found);
    result.tables = {
        {"", "", stability_table(plan, found), {}, true},
        {"limits", "", limits_table(found), {}, true},
        {"counts", "", counts_table(found), {}, true},
        {"families", "Largest stable and accurate steps by families of scenes", families_table(found)},
        {"outcomes", "How the runs ended", outcomes_table(plan, found)},
        {"tolerances", "Achieved over requested errors", tolerances_table(plan, found)},
        {"float32", "Binary32 against binary64", float32, {}, true},
        {"float32_lost", "Scenes that binary32 loses", lost_table(float32)},
        {"stiffness", "What stiffness costs at equal tolerance", stiffness_table(costs)},
        {"damping", "Damping 10^6 with a constant torque: what 1e-10 rad costs", damping_table(plan, found)},
    };
    result.figures = stiffness_figures(plan, costs);
    if (result.missing == 0 && options.shard == 1) add_whole_parts(plan, found, options, result);
    result.page = stability_page(plan, found, costs, result.tables);
    return result;
}

}  // namespace polhode
