// The kind `speed`: run times of polhode's integrators and of the libraries at equal error, timed in turn in one run;
// the smallest error of each method; growth of errors and times over long runs.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "experiment/kinds/curves.h"
#include "experiment/kinds/kinds.h"
#include "experiment/run/findings.h"
#include "measure/growth.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

constexpr std::array<double, 3> levels{1e-6, 1e-9, 1e-12};  // rad, over all samples

/// Median and minimum of a method's times at an error.
struct TimeAt {
    double median = 0, minimum = 0;
};

// The time of the fastest run with an error of at most `level`. Interpolates log time over log error linearly between
// neighbouring settings on either side of the level, so that the result does not depend on the choice of settings.
std::optional<TimeAt> time_at(const std::vector<const Result*>& rows, double level) {
    std::optional<TimeAt> best;
    const auto keep_faster = [&](const TimeAt& time) {
        if (!best || time.median < best->median) best = time;
    };
    const Result* before = nullptr;
    for (const Result* row : rows) {
        if (row->status != Status::ok || !row->seconds_median || !row->errors["attitude"].max) {
            before = nullptr;
            continue;
        }
        const double error = std::max(*row->errors["attitude"].max, 1e-18);
        if (error <= level) {
            keep_faster({*row->seconds_median, *row->seconds_min});
            const double coarser = before ? *before->errors["attitude"].max : 0;
            if (coarser > level) {
                const double along = std::log(coarser / level) / std::log(coarser / error);
                const auto between = [&](double from, double to) { return from * std::pow(to / from, along); };
                keep_faster({between(*before->seconds_median, *row->seconds_median),
                             between(*before->seconds_min, *row->seconds_min)});
            }
        }
        before = row;
    }
    return best;
}

struct FastestCurve {
    const PlannedCurve* curve = nullptr;
    TimeAt time;
};

// The fastest curve on a scene at this error among those for which belongs() is true.
template <class Belongs>
std::optional<FastestCurve> fastest(const Plan& plan, const PlannedScene& scene, const std::vector<Result>& rows,
                                    double level, const Belongs& belongs) {
    std::optional<FastestCurve> best;
    for (const PlannedCurve& curve : plan.curves) {
        if (!belongs(curve)) continue;
        const std::optional<TimeAt> time = time_at(select_rows(rows, scene, curve), level);
        if (time && (!best || time->median < best->time.median)) best = FastestCurve{&curve, *time};
    }
    return best;
}

bool controls_step(const PlannedCurve& curve) {
    return curve.method->library.empty() && curve.kind == SettingKind::tolerance;
}

// Whether the motion has a closed form: no torque acts, and there are no planes to meet.
bool is_free_motion(const Scene& scene) { return scene.planes.empty() && pose(scene).needs.torque_free; }

// Compares the fastest method of polhode that chooses its steps with the fastest method of any library. For torque-free
// scenes of one body, compares the closed form too.
void add_margins(Table& table, const Plan& plan, const PlannedScene& scene, const std::vector<Result>& rows) {
    const bool has_exact = is_free_motion(scene.scene);
    const auto is_exact = [](const PlannedCurve& c) { return c.method->name == "exact"; };
    const auto is_peer = [](const PlannedCurve& c) { return !c.method->library.empty(); };
    for (const bool exact : has_exact ? std::vector{true, false} : std::vector{false})
        for (const double level : levels) {
            const auto own =
                exact ? fastest(plan, scene, rows, level, is_exact) : fastest(plan, scene, rows, level, controls_step);
            const auto peer = fastest(plan, scene, rows, level, is_peer);
            std::vector<Cell> row{scene.label, level};
            const auto add = [&](const std::optional<FastestCurve>& runner, const char* otherwise) {
                row.emplace_back(runner ? curve_label(*runner->curve) : std::string(otherwise));
                row.push_back(runner ? Cell(runner->time.median) : Cell());
            };
            add(own, exact ? "exact does not reach it" : "no polhode method reaches it");
            add(peer, "no library reaches it");
            const bool both = own && peer;
            row.push_back(both ? Cell(peer->time.median / own->time.median) : Cell());
            row.push_back(both ? Cell(peer->time.minimum / own->time.minimum) : Cell());
            table.rows.push_back(std::move(row));
        }
}

void add_smallest(Table& table, const Plan& plan, const PlannedScene& scene, const std::vector<Result>& rows) {
    for (const PlannedCurve& curve : plan.curves) {
        const std::vector<const Result*> own = select_rows(rows, scene, curve);
        const Result* best = nullptr;
        for (const Result* row : own)
            if (row->status == Status::ok && row->errors["attitude"].max &&
                (!best || *row->errors["attitude"].max < *best->errors["attitude"].max))
                best = row;
        std::vector<Cell> row{scene.label, curve_label(curve)};
        if (best) {
            row.insert(row.end(),
                       {cell_of(curve.kind == SettingKind::none ? std::nullopt : std::optional(best->setting)),
                        cell_of(best->errors["attitude"].max), cell_of(best->errors["momentum"].max),
                        cell_of(best->errors["energy"].max), cell_of(best->seconds_median)});
        } else {
            row.insert(row.end(), 5, Cell());
        }
        for (const double level : levels) {
            const std::optional<TimeAt> time = time_at(own, level);
            row.push_back(cell_of(time ? std::optional(time->median) : std::nullopt));
        }
        table.rows.push_back(std::move(row));
    }
}

// Growth of errors and run time per second of motion, from the rows of the long runs.
Findings conclude_long(const Plan& plan, const std::vector<Result>& rows) {
    Table table{{"scene", "method", "tolerance", "duration", "status", "attitude_error_max", "attitude_exponent",
                 "energy_error_max", "energy_exponent", "steps", "seconds_per_second_of_motion", "message"},
                {}};
    const auto exponent = [](const Result& row, const char* measure) {
        const std::optional<Growth> growth = error_growth(row.series.t, row.series[measure], 0.1);
        return cell_of(growth ? std::optional(growth->exponent) : std::nullopt);
    };
    const auto add = [&](const PlannedScene& scene, const Result& row) {
        std::vector<Cell> cells{scene.scene.name, row.method, row.setting, scene.scene.duration,
                                std::string(name_of(row.status))};
        if (row.status == Status::ok)
            cells.insert(cells.end(), {cell_of(row.errors["attitude"].max), exponent(row, "attitude"),
                                       cell_of(row.errors["energy"].max), exponent(row, "energy"), cell_of(row.steps),
                                       *row.seconds_median / scene.scene.duration});
        else
            cells.insert(cells.end(), 6, Cell());
        cells.emplace_back(row.message);
        table.rows.push_back(std::move(cells));
    };
    // sorted by scene, then method, then duration
    for (auto first = plan.scenes.begin(), last = first; first != plan.scenes.end(); first = last) {
        last = std::find_if(first, plan.scenes.end(),
                            [&](const PlannedScene& other) { return other.scene.name != first->scene.name; });
        for (const PlannedCurve& curve : plan.curves)
            for (auto scene = first; scene != last; ++scene)
                for (const Result* row : select_rows(rows, *scene, curve)) add(*scene, *row);
    }
    return {{{"long", "Long runs of closed-form motions", std::move(table)}}};
}

}  // namespace

Plan long_runs(const Plan& plan) {
    static const ExperimentKind kind{.name = "speed", .reads = {}, .conclude = conclude_long, .keeps_series = true};
    Plan longer{plan.experiment, {}, {}, plan.quick};
    longer.experiment.kind = &kind, longer.experiment.samples = 1000;
    longer.experiment.seconds_per_run = std::numeric_limits<double>::infinity();
    longer.experiment.max_evaluations = std::numeric_limits<long>::max();
    for (const PlannedScene& scene : plan.scenes) {
        if (!is_free_motion(scene.scene)) continue;  // the truth of a closed form costs the same for any T
        for (const double factor : plan.quick ? std::vector{1.0, 10.0} : std::vector{1.0, 10.0, 100.0}) {
            PlannedScene& added = longer.scenes.emplace_back(scene);
            added.scene.duration *= factor;
            added.label = fmt::format("{}{{/duration={}}}", scene.label, added.scene.duration);
            added.canonical = write_scene(added.scene);
        }
    }
    for (const PlannedCurve& curve : plan.curves)
        if (controls_step(curve)) longer.curves.emplace_back(curve).settings = {curve.settings.back()};
    return longer;
}

Findings conclude_speed(const Plan& plan, const std::vector<Result>& rows) {
    NamedTable margins = make_named_table("margins", "Run time of polhode and of other libraries at equal error",
                                          {{"scene", "scene"},
                                           {"attitude_error", "error (rad)"},
                                           {"own", "polhode"},
                                           {"own_seconds", "time (s)"},
                                           {"peer", "against"},
                                           {"peer_seconds", "time (s)"},
                                           {"ratio", "factor"},
                                           {"ratio_of_minima", ""}});
    NamedTable smallest{"smallest",
                        "Smallest error of each method, and its run time at given errors",
                        {{"scene", "method", "setting", "attitude_error_max", "momentum_error_max", "energy_error_max",
                          "seconds_median", "seconds_at_1e-6", "seconds_at_1e-9", "seconds_at_1e-12"},
                         {}}};
    for (const PlannedScene& scene : plan.scenes) {
        add_margins(margins.table, plan, scene, rows);
        add_smallest(smallest.table, plan, scene, rows);
    }
    return {{std::move(margins), std::move(smallest)}, work_precision_figures(plan, rows)};
}

}  // namespace polhode
