// The kind `stability`: its main function, and the tables of its runs.
#include <fmt/format.h>

#include <algorithm>

#include "experiment/kinds/cells.h"
#include "experiment/kinds/kinds.h"
#include "experiment/kinds/stability.h"

namespace polhode {
namespace {

Cell step_of(const StabilityRun* run) { return run ? Cell(run->result.setting) : Cell(); }
Cell evaluations_of(const StabilityRun* run) { return run ? cell_of(run->result.rhs_evaluations) : Cell(); }

// the smallest attitude error of the stable runs
std::optional<double> smallest_error(const StabilityFinding& finding) {
    std::optional<double> smallest;
    for (const StabilityRun& run : finding.runs) {
        const std::optional<double>& error = run.result.errors["attitude"].max;
        if (run.outcome <= Outcome::damped_to_rest && error && (!smallest || *error < *smallest)) smallest = error;
    }
    return smallest;
}

// keeps every eighth scene if there are more than 20
Plan thin_plan(Plan plan) {
    constexpr std::size_t few = 20, every = 8;
    if (plan.scenes.size() <= few) return plan;
    std::size_t i = 0;
    std::erase_if(plan.scenes, [&](const PlannedScene&) { return i++ % every != 0; });
    return plan;
}

// adds the studies that need all cases
void add_studies(const Plan& plan, const StabilityFindings& found, const RunOptions& options, Findings& result) {
    std::vector<const Method*> fixed;
    for (const PlannedCurve& curve : plan.curves)
        if (curve.kind == SettingKind::step) fixed.push_back(curve.method);
    result.tables.push_back({"linear", "Largest h |lambda| without growth: linear theory and measured",
                             measure_linear_limits(plan, found, options.jobs, options.quick)});
    Findings maps = run_step_maps(fixed, options.jobs, options.quick);
    std::move(maps.tables.begin(), maps.tables.end(), std::back_inserter(result.tables));
    result.tables.push_back(measure_discontinuities(options.quick));
    result.figures = std::move(maps.figures);
    std::vector<NamedFigure> regions = draw_stability_regions(plan.scenes);
    std::move(regions.begin(), regions.end(), std::back_inserter(result.figures));
}

}  // namespace

std::vector<const StabilityFinding*> findings_of(const StabilityFindings& found, const Method& method,
                                                 SettingKind kind) {
    std::vector<const StabilityFinding*> list;
    for (const StabilityFinding& f : found.findings)
        if (f.method == &method && f.kind == kind && was_run(f)) list.push_back(&f);
    return list;
}

Table limits_table(const StabilityFindings& found) {
    Table table{{"scene", "family", "parameter", "method", "duration", "fastest_rate", "stable_step",
                 "stable_step_times_rate", "close_step", "close_evaluations", "accurate_step", "accurate_evaluations",
                 "beyond_step", "beyond", "beyond_message", "float64_floor"},
                {}};
    for (const StabilityFinding& f : found.findings) {
        if (f.kind != SettingKind::step || !was_run(f)) continue;
        const StabilityScene& scene = *f.scene;
        table.rows.push_back({scene.label, scene.family, cell_of(scene.parameter), std::string(f.method->name),
                              scene.duration, scene.fastest_rate, step_of(f.stable),
                              f.stable ? Cell(f.stable->result.setting * scene.fastest_rate) : Cell(), step_of(f.close),
                              evaluations_of(f.close), step_of(f.accurate), evaluations_of(f.accurate),
                              step_of(f.beyond), f.beyond ? Cell(std::string(name_of(f.beyond->outcome))) : Cell(),
                              f.beyond ? Cell(f.beyond->result.message) : Cell(), cell_of(scene.floors.float64)});
    }
    return table;
}

Table binary32_table(const StabilityFindings& found) {
    struct Precisions {
        const StabilityFinding *binary32, *binary64;
    };
    std::vector<Precisions> pairs;
    for (const StabilityFinding& f : found.findings) {
        if (f.method->precision != Precision::binary32 || f.kind != SettingKind::step || !was_run(f)) continue;
        for (const StabilityFinding& g : found.findings)
            if (g.scene == f.scene && g.kind == f.kind && g.method->name == f.method->binary64_name)
                pairs.push_back({&f, &g});
    }
    Table table{{"method", "scenes", "lost", "error_ratio_median", "lost_on"}, {}};
    for (const auto& [method, members] :
         group_by(pairs, [](const Precisions& p) { return p.binary64->method->name; })) {
        std::vector<double> ratios;
        std::vector<std::string> lost;
        for (const Precisions& pair : members) {
            const std::optional<double> error32 = smallest_error(*pair.binary32),
                                        error64 = smallest_error(*pair.binary64);
            if (error64 && *error64 <= close_attitude && (!error32 || *error32 > close_attitude))
                lost.push_back(pair.binary64->scene->label);
            else if (error32 && error64 && *error64 > 0)
                ratios.push_back(*error32 / *error64);
        }
        table.rows.push_back({std::string(method), static_cast<long>(members.size()), static_cast<long>(lost.size()),
                              median_cell(ratios), fmt::format("{}", fmt::join(lost, ", "))});
    }
    return table;
}

Table damping_table(const Plan& plan, const StabilityFindings& found) {
    constexpr double limit = 1e-10;  // rad
    const auto error = [](const StabilityRun& run) { return run.result.errors["attitude"].max.value_or(4); };
    const auto is_better = [&](const StabilityRun& a, const StabilityRun& b) {
        const bool passes = error(a) <= limit;
        if (passes != (error(b) <= limit)) return passes;
        return passes ? a.result.rhs_evaluations.value_or(0) < b.result.rhs_evaluations.value_or(0)
                      : error(a) < error(b);
    };
    Table table{{"method", "reaches_1e-10", "tolerance", "evaluations_per_second", "attitude_error", "status"}, {}};
    for (const PlannedCurve& curve : plan.curves) {
        if (curve.kind != SettingKind::tolerance) continue;
        for (const StabilityFinding* f : findings_of(found, *curve.method, curve.kind)) {
            if (f->scene->label != "extreme/drag_torque_1e6") continue;
            const StabilityRun& best = *std::min_element(f->runs.begin(), f->runs.end(), is_better);
            const Result& r = best.result;
            table.rows.push_back(
                {std::string(curve.method->name), std::string(error(best) <= limit ? "yes" : "no"), r.setting,
                 r.rhs_evaluations ? Cell(static_cast<double>(*r.rhs_evaluations) / f->scene->duration) : Cell(),
                 cell_of(r.errors["attitude"].max), std::string(name_of(r.status))});
        }
    }
    return table;
}

Findings run_stability(const Plan& full_plan, const RunOptions& options) {
    const Plan plan = options.quick ? thin_plan(full_plan) : full_plan;
    const StabilityFindings found = run_stability_cases(plan, options);
    Findings result;
    result.missing = found.missing;
    if (sweep_interrupted()) return result;
    result.tables = {
        {"", "", stability_table(plan, found), {}, true},
        {"limits", "", limits_table(found), {}, true},
        {"float32_lost", "Scenes that binary32 does not solve", binary32_table(found)},
        {"damping", "Damping 10^6 with a constant torque: cost of 1e-10 rad", damping_table(plan, found)},
    };
    if (result.missing == 0 && options.shard == 1) add_studies(plan, found, options, result);
    result.page = stability_page(plan, found, result.tables);
    return result;
}

}  // namespace polhode
