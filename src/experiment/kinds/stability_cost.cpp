// What stiffness costs: the same motion at the same tolerance, its fastest rate alone rising.
#include <algorithm>
#include <cmath>

#include "experiment/kinds/curves.h"
#include "experiment/kinds/stability_tables.h"
#include "measure/statistics.h"

namespace polhode {
namespace {

// families of at least three members of one duration, the parameter positive, the fastest rate rising with it
std::vector<std::vector<const StabilityScene*>> stiff_families(const StabilityFindings& found) {
    std::vector<std::vector<const StabilityScene*>> groups;
    for (const StabilityScene& scene : found.scenes) {
        if (scene.parameter.value_or(0) <= 0) continue;
        const auto same = std::find_if(groups.begin(), groups.end(),
                                       [&](const auto& group) { return group.front()->family == scene.family; });
        if (same == groups.end())
            groups.push_back({&scene});
        else
            same->push_back(&scene);
    }
    std::erase_if(groups, [](auto& group) {
        std::sort(group.begin(), group.end(),
                  [](const StabilityScene* a, const StabilityScene* b) { return *a->parameter < *b->parameter; });
        const StabilityScene &first = *group.front(), &last = *group.back();
        const bool one_duration = std::all_of(
            group.begin(), group.end(), [&](const StabilityScene* scene) { return scene->duration == first.duration; });
        return group.size() < 3 || !one_duration || last.fastest_rate < 1e3 * first.fastest_rate;
    });
    return groups;
}

const StabilityRun* run_at(const StabilityFindings& found, const StabilityScene* scene, const PlannedCurve& curve,
                           double tolerance) {
    for (const StabilityFinding& f : found.findings) {
        if (f.scene != scene || f.method != curve.method || f.kind != curve.kind) continue;
        for (const StabilityRun& run : f.runs)
            if (run.result.setting == tolerance) return &run;
    }
    return nullptr;
}

}  // namespace

std::vector<StiffnessCost> stiffness_costs(const Plan& plan, const StabilityFindings& found) {
    std::vector<StiffnessCost> costs;
    for (const auto& group : stiff_families(found))
        for (const PlannedCurve& curve : plan.curves) {
            if (curve.kind != SettingKind::tolerance) continue;
            for (const double tolerance : curve.settings) {
                StiffnessCost cost;
                cost.method = curve.method, cost.family = group.front()->family, cost.tolerance = tolerance;
                bool supported = false;
                std::vector<std::pair<double, double>> points;
                for (const StabilityScene* scene : group) {
                    const StabilityRun* run = run_at(found, scene, curve, tolerance);
                    if (!run || run->outcome == Outcome::unsupported) continue;
                    supported = true;
                    const bool ok = run->result.status == Status::ok;
                    if (!ok && !cost.lost_at)
                        cost.lost_at = scene->parameter, cost.lost_to = name_of(run->result.status);
                    if (!ok) continue;
                    cost.lost_at.reset(), cost.lost_to.clear();
                    if (run->result.rhs_evaluations.value_or(0) < 1) continue;
                    cost.parameter.push_back(*scene->parameter);
                    cost.evaluations.push_back(static_cast<double>(*run->result.rhs_evaluations));
                    points.emplace_back(std::log(cost.parameter.back()), std::log(cost.evaluations.back()));
                }
                // where stiffness is small the motion itself sets the step
                points.erase(points.begin(), points.begin() + static_cast<long>(points.size() / 2));
                if (points.size() >= 2) cost.exponent = least_squares_line(points).slope;
                if (supported) costs.push_back(std::move(cost));
            }
        }
    return costs;
}

Table stiffness_table(const std::vector<StiffnessCost>& costs) {
    Table table{{"family", "method", "tolerance", "members_ok", "evaluations_at_least", "at_parameter",
                 "evaluations_at_most", "up_to_parameter", "exponent", "lost_from_parameter", "lost_to"},
                {}};
    for (const StiffnessCost& c : costs) {
        const bool any = !c.parameter.empty();
        table.rows.push_back({c.family, std::string(c.method->name), c.tolerance, static_cast<long>(c.parameter.size()),
                              any ? Cell(c.evaluations.front()) : Cell(), any ? Cell(c.parameter.front()) : Cell(),
                              any ? Cell(c.evaluations.back()) : Cell(), any ? Cell(c.parameter.back()) : Cell(),
                              cell_of(c.exponent), cell_of(c.lost_at), c.lost_to});
    }
    return table;
}

std::vector<NamedFigure> stiffness_figures(const Plan& plan, const std::vector<StiffnessCost>& costs) {
    const std::vector<double>& tolerances = plan.experiment.tolerances;
    if (tolerances.empty() || costs.empty()) return {};
    const double middle = tolerances[tolerances.size() / 2];
    Figure figure;
    figure.title = "What stiffness costs at equal tolerance";
    figure.columns = 2;
    figure.note = "A curve ends where the method does not reach its end within the limits of a run.";
    for (const StiffnessCost& cost : costs) {
        if (cost.tolerance != middle || cost.parameter.empty()) continue;
        auto panel = std::find_if(figure.panels.begin(), figure.panels.end(),
                                  [&](const Panel& p) { return p.title == cost.family; });
        if (panel == figure.panels.end()) {
            Panel fresh;
            fresh.title = cost.family, fresh.x_label = "parameter", fresh.y_label = "right-hand sides";
            figure.panels.push_back(std::move(fresh));
            panel = figure.panels.end() - 1;
        }
        Curve curve;
        curve.label = cost.method->name;
        for (const PlannedCurve& planned : plan.curves)
            if (planned.method == cost.method) look_as(curve, planned);
        curve.x = cost.parameter, curve.y = cost.evaluations;
        curve.cut = cost.lost_at.has_value();
        panel->curves.push_back(std::move(curve));
    }
    return {{plan.experiment.name + "_stiffness", std::move(figure)}};
}

}  // namespace polhode
