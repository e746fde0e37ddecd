// The kind `collisions`: errors of impact times, bounce height and energy for impacts on planes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiment/kinds/kinds.h"
#include "experiment/run/findings.h"
#include "experiment/run/sweep.h"
#include "figure/curve_style.h"
#include "integrators/truth/reference.h"
#include "measure/errors.h"

namespace polhode {
namespace {

// The largest height (m) above the scene's first plane over the samples with from < t <= until.
template <class Samples, class Position>
std::optional<double> apex(const Scene& scene, const Samples& samples, double from, double until,
                           const Position& position) {
    const Vector3<double>& n = scene.planes.front().normal_W;
    std::optional<double> most;
    for (const auto& sample : samples)
        if (sample.t > from && sample.t <= until) {
            const double height = dot(n, position(sample)) / std::sqrt(dot(n, n));
            most = std::max(most.value_or(height), height);
        }
    return most;
}

// Solves the scene with one setting of a curve. Scenes without planes are unsupported.
Trajectory solve_collisions(const Scene& scene, const PlannedCurve& planned, double setting, long samples,
                            double seconds_limit) {
    Settings settings;
    settings.samples = samples;
    if (planned.kind == SettingKind::step) settings.step = setting;
    if (planned.kind == SettingKind::tolerance) settings.tolerance = setting;
    settings.seconds_limit = seconds_limit;
    Trajectory run = scene.planes.empty() ? Trajectory{} : solve(scene, *planned.method, settings);
    if (scene.planes.empty()) run.status = Status::unsupported, run.message = "the scene has no planes";
    return run;
}

// Errors of a run with impacts; empty if they do not exist.
struct ImpactErrors {
    Cell first, worst, height, energy, attitude;
};

ImpactErrors measure_impacts(const Scene& scene, const Trajectory& run, const Reference& truth) {
    ImpactErrors impact_errors;
    const auto& found = run.impact_times;
    const auto& right = truth.impact_times;
    const std::size_t both = std::min(found.size(), right.size());
    double late = 0;
    for (std::size_t i = 0; i < both; ++i) late = std::max(late, std::abs((found[i] - right[i].high) - right[i].low));
    if (both > 0) {
        impact_errors.first = std::abs((found[0] - right[0].high) - right[0].low);
        // the next corner of a box may hit at once, so take the largest height of the whole rest
        const double until = run.samples.back().t;
        const auto rise = apex(scene, run.samples, right[0].high, until, [](const Sample& s) { return s.position_W; });
        const auto true_rise = apex(scene, truth.samples, right[0].high, until,
                                    [](const ReferenceSample& s) { return s.rounded().position_W; });
        if (rise && true_rise) impact_errors.height = std::abs(*rise - *true_rise);
    }
    // compare all impacts only if their numbers are equal
    if (found.size() == right.size() && both > 0) impact_errors.worst = late;
    if (run.status == Status::ok) {
        const Errors e = errors(error_series(scene, run, truth), run, truth);
        impact_errors.energy = cell_of(e["energy"].max), impact_errors.attitude = cell_of(e["attitude"].max);
    }
    return impact_errors;
}

// Adds a row for one setting, and its point to the curve.
void add_collision_row(Table& table, Curve& curve, const PlannedScene& scene, const PlannedCurve& planned,
                       double setting, const Trajectory& run, const Reference& truth) {
    std::vector<Cell> row{scene.label,
                          std::string(planned.method->name),
                          std::string(name_of(planned.kind)),
                          {},
                          std::string(name_of(run.status))};
    if (planned.kind != SettingKind::none) row[3] = setting;
    ImpactErrors e;
    std::string message = run.message;
    if (!truth.available) {
        if (!truth.message.empty()) message += (message.empty() ? "" : "; ") + truth.message;
    } else if (!run.samples.empty()) {
        e = measure_impacts(scene.scene, run, truth);
        if (const double* first = std::get_if<double>(&e.first)) {
            curve.x.push_back(static_cast<double>(run.rhs_evaluations));
            curve.y.push_back(*first);
        }
    }
    row.insert(row.end(), {static_cast<long>(run.impact_times.size()), Cell{}, e.first, e.worst, e.height, e.energy,
                           e.attitude, run.steps, run.rhs_evaluations, message});
    if (truth.available) row[6] = static_cast<long>(truth.impact_times.size());
    table.rows.push_back(std::move(row));
}

}  // namespace

Findings run_collisions(const Plan& plan, const RunOptions& options) {
    const long samples = options.quick ? 50 : 100;
    NamedTable table{"",
                     "",
                     {{"scene", "method", "setting_kind", "setting", "status", "impacts", "impacts_true",
                       "first_impact_error", "impact_time_error_max", "bounce_height_error", "energy_error_max",
                       "attitude_error_max", "steps", "rhs_evaluations", "message"},
                      {}}};
    NamedFigure figure{"collisions", {"Error in the time of the first impact", 2, {}, ""}};
    for (const PlannedScene& planned : plan.scenes) {
        const Scene& scene = planned.scene;
        const Reference truth = scene.planes.empty() ? Reference{} : reference(scene, samples);
        Panel panel{planned.label, "evaluations", "error (s)", true, true, {}};
        for (const PlannedCurve& planned_curve : plan.curves) {
            Curve curve;
            curve.label = planned_curve.method->name;
            set_style(curve, planned_curve.style);
            for (const double setting : planned_curve.settings) {
                const Trajectory run =
                    solve_collisions(scene, planned_curve, setting, samples, plan.experiment.seconds_per_run);
                add_collision_row(table.table, curve, planned, planned_curve, setting, run, truth);
            }
            if (!curve.x.empty()) panel.curves.push_back(std::move(curve));
        }
        if (!panel.curves.empty()) figure.figure.panels.push_back(std::move(panel));
    }
    Findings result;
    result.tables.push_back(std::move(table));
    if (!figure.figure.panels.empty()) result.figures.push_back(std::move(figure));
    return result;
}

}  // namespace polhode
