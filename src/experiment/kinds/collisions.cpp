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

Vector3<double> high(const Vector3<Pair>& v) { return {v[0].high, v[1].high, v[2].high}; }

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
                Settings settings;
                settings.samples = samples;
                if (planned_curve.kind == SettingKind::step) settings.step = setting;
                if (planned_curve.kind == SettingKind::tolerance) settings.tolerance = setting;
                settings.seconds_limit = plan.experiment.seconds_per_run;
                Trajectory run = scene.planes.empty() ? Trajectory{} : solve(scene, *planned_curve.method, settings);
                if (scene.planes.empty()) run.status = Status::unsupported, run.message = "the scene has no planes";
                std::vector<Cell> row{planned.label,
                                      std::string(planned_curve.method->name),
                                      std::string(name_of(planned_curve.kind)),
                                      {},
                                      std::string(name_of(run.status))};
                if (planned_curve.kind != SettingKind::none) row[3] = setting;
                Cell first, worst, height, energy, attitude;
                std::string message = run.message;
                if (!truth.available) {
                    if (!truth.message.empty()) message += (message.empty() ? "" : "; ") + truth.message;
                } else if (!run.samples.empty()) {
                    const auto& found = run.impact_times;
                    const auto& right = truth.impact_times;
                    const std::size_t both = std::min(found.size(), right.size());
                    double late = 0;
                    for (std::size_t i = 0; i < both; ++i)
                        late = std::max(late, std::abs((found[i] - right[i].high) - right[i].low));
                    if (both > 0) {
                        first = std::abs((found[0] - right[0].high) - right[0].low);
                        curve.x.push_back(static_cast<double>(run.rhs_evaluations));
                        curve.y.push_back(std::get<double>(first));
                        // the next corner of a box may hit at once, so take the largest height of the whole rest
                        const double until = run.samples.back().t;
                        const auto rise = apex(scene, run.samples, right[0].high, until,
                                               [](const Sample& s) { return s.position_W; });
                        const auto true_rise = apex(scene, truth.samples, right[0].high, until,
                                                    [](const ReferenceSample& s) { return high(s.position_W); });
                        if (rise && true_rise) height = std::abs(*rise - *true_rise);
                    }
                    // compare all impacts only if their numbers are equal
                    if (found.size() == right.size() && both > 0) worst = late;
                    if (run.status == Status::ok) {
                        const Errors e = errors(error_series(scene, run, truth), run, truth);
                        energy = cell_of(e["energy"].max), attitude = cell_of(e["attitude"].max);
                    }
                }
                row.insert(row.end(), {static_cast<long>(run.impact_times.size()), Cell{}, first, worst, height, energy,
                                       attitude, run.steps, run.rhs_evaluations, message});
                if (truth.available) row[6] = static_cast<long>(truth.impact_times.size());
                table.table.rows.push_back(std::move(row));
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
