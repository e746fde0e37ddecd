// Own integrators against the libraries' at equal error, each run beside all the others: the factors in time asked for
// and reached, the smallest error of each method, and how errors grow and times add up over a long run.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <deque>
#include <optional>

#include "experiment/kinds/curves.h"
#include "experiment/kinds/kinds.h"
#include "experiment/run/case.h"
#include "experiment/run/findings.h"
#include "experiment/run/sweep.h"
#include "experiment/run/timing.h"
#include "integrators/run/stiffness.h"
#include "integrators/truth/reference.h"
#include "measure/growth.h"

namespace polhode {
namespace {

constexpr std::array<double, 3> levels{1e-6, 1e-9, 1e-12};  // rad, over all samples

/// Who is to be how much faster than whom, at each of the levels.
struct Comparison {
    const char* own;   ///< a method's name, or empty: the fastest own one that steps
    const char* peer;  ///< a method's name, controlled by tolerance; or empty: the fastest library's
    std::array<double, 3> asked;
};

// by kind of motion; 0: nothing is asked for
std::vector<Comparison> comparisons(const Problem& problem) {
    if (problem.needs.torque_free)
        return {{"exact", "", {60, 100, 250}}, {"", "odeint_fehlberg78", {3, 5, 5}}, {"", "", {0, 0, 0}}};
    if (is_stiff(problem)) return {{"", "cvode_bdf", {1.5, 2.5, 2}}, {"", "", {0, 0, 0}}};
    return {{"", "odeint_fehlberg78", {4, 7, 9}}, {"", "", {0, 0, 0}}};
}

/// Median and minimum of one method's times at one error.
struct TimeAt {
    double median = 0, minimum = 0;
};

// The fastest run whose error is at most `level`; between two neighbouring settings on either side of the level by a
// straight line through log time over log error, so that nobody gains by where settings happen to lie.
std::optional<TimeAt> time_at(const std::vector<const Result*>& rows, double level) {
    std::optional<TimeAt> best;
    const auto offer = [&](const TimeAt& time) {
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
            offer({*row->seconds_median, *row->seconds_min});
            const double coarser = before ? *before->errors["attitude"].max : 0;
            if (coarser > level) {
                const double along = std::log(coarser / level) / std::log(coarser / error);
                const auto between = [&](double from, double to) { return from * std::pow(to / from, along); };
                offer({between(*before->seconds_median, *row->seconds_median),
                       between(*before->seconds_min, *row->seconds_min)});
            }
        }
        before = row;
    }
    return best;
}

struct Runner {
    const PlannedCurve* curve = nullptr;
    TimeAt time;
};

class SceneSpeeds {
  public:
    SceneSpeeds(const Plan& plan, const PlannedScene& scene, std::vector<Result>& all)
        : plan_(plan), scene_(scene), problem_(pose(scene.scene)) {
        measure(all);
    }
    const Problem& problem() const { return problem_; }

    std::vector<const Result*> rows(const PlannedCurve& curve) const {
        std::vector<const Result*> found;
        for (const Case& c : cases_)
            if (c.curve == &curve && c.result) found.push_back(&*c.result);
        return found;
    }
    std::optional<TimeAt> time_of(const PlannedCurve& curve, double level) const { return time_at(rows(curve), level); }

    template <class Belongs>
    std::optional<Runner> fastest(double level, const Belongs& belongs) const {
        std::optional<Runner> best;
        for (const PlannedCurve& curve : plan_.curves) {
            if (!belongs(curve)) continue;
            const std::optional<TimeAt> time = time_of(curve, level);
            if (time && (!best || time->median < best->time.median)) best = Runner{&curve, *time};
        }
        return best;
    }

  private:
    void measure(std::vector<Result>& all) {
        static const std::atomic<bool> never{false};
        const Reference truth = reference(scene_.scene, plan_.experiment.samples);
        for (const PlannedCurve& curve : plan_.curves) {
            const Case* cut = nullptr;
            for (std::size_t rank = 0; rank < curve.settings.size(); ++rank) {
                cases_.push_back({&scene_, &curve, rank, "", {}, {}});
                if (cut)
                    cut_curve(*cut, cases_.back());
                else
                    measure_errors(plan_.experiment, problem_, truth, cases_.back());
                if (cases_.back().result->cut && !cut) cut = &cut_.emplace_back(cases_.back());
            }
        }
        std::vector<TimedRun> runs;
        std::vector<Case*> timed;
        for (Case& c : cases_) {
            const double expected = c.result->seconds_min.value_or(0);
            c.result->seconds_min.reset();
            if (c.result->status != Status::ok) continue;
            runs.push_back({&problem_, c.curve->method, c.settings, expected});
            timed.push_back(&c);
        }
        time_interleaved(runs, plan_.experiment.repeats, never);
        for (std::size_t i = 0; i < runs.size(); ++i) {
            Result& result = *timed[i]->result;
            if (runs[i].failure.empty()) {
                result.seconds_min = runs[i].minimum(), result.seconds_median = runs[i].median();
                result.repeats = static_cast<long>(runs[i].seconds.size());
            } else {
                result.status = Status::failed, result.message = runs[i].failure, result.errors = {};
                result.cut = runs[i].limit_reached;
            }
        }
        for (const Case& c : cases_) all.push_back(*c.result);
    }

    const Plan& plan_;
    const PlannedScene& scene_;
    Problem problem_;
    std::vector<Case> cases_;
    std::deque<Case> cut_;
};

bool controlled(const PlannedCurve& curve) { return curve.kind == SettingKind::tolerance; }
bool steps_by_itself(const PlannedCurve& curve) { return curve.method->library.empty() && controlled(curve); }

void add_margins(Table& table, const PlannedScene& scene, const SceneSpeeds& speeds) {
    for (const Comparison& comparison : comparisons(speeds.problem()))
        for (std::size_t i = 0; i < levels.size(); ++i) {
            const std::string_view own_name = comparison.own, peer_name = comparison.peer;
            const auto own = speeds.fastest(levels[i], [&](const PlannedCurve& c) {
                return own_name.empty() ? steps_by_itself(c) : c.method->name == own_name;
            });
            const auto peer = speeds.fastest(levels[i], [&](const PlannedCurve& c) {
                return peer_name.empty() ? !c.method->library.empty() : c.method->name == peer_name && controlled(c);
            });
            std::vector<Cell> row{scene.label, levels[i]};
            const auto add = [&](const std::optional<Runner>& runner, std::string_view wanted, const char* otherwise) {
                row.emplace_back(runner           ? curve_label(*runner->curve)
                                 : wanted.empty() ? std::string(otherwise) + " reaches it"
                                                  : std::string(wanted) + " does not reach it");
                row.push_back(cell_of(runner ? std::optional(runner->time.median) : std::nullopt));
            };
            add(own, own_name, "none of ours");
            add(peer, peer_name, "no library");
            std::optional<double> ratio, of_minima, asked;
            std::string reached;
            if (own && peer) {
                ratio = peer->time.median / own->time.median;
                of_minima = peer->time.minimum / own->time.minimum;
            }
            if (comparison.asked[i] > 0) asked = comparison.asked[i];
            if (ratio && asked) reached = *ratio >= *asked ? "yes" : "no";
            row.insert(row.end(), {cell_of(ratio), cell_of(of_minima), cell_of(asked), reached});
            table.rows.push_back(std::move(row));
        }
}

void add_smallest(Table& table, const Plan& plan, const PlannedScene& scene, const SceneSpeeds& speeds) {
    for (const PlannedCurve& curve : plan.curves) {
        const Result* best = nullptr;
        for (const Result* row : speeds.rows(curve))
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
            const std::optional<TimeAt> time = speeds.time_of(curve, level);
            row.push_back(cell_of(time ? std::optional(time->median) : std::nullopt));
        }
        table.rows.push_back(std::move(row));
    }
}

// Over T, 10 T, 100 T at the finest tolerance: how errors grow, what a second of motion costs.
void add_long(Table& table, const Plan& plan, const PlannedScene& scene, bool quick) {
    if (!pose(scene.scene).needs.torque_free) return;  // a truth that costs the same for any T
    for (const PlannedCurve& curve : plan.curves) {
        if (!steps_by_itself(curve)) continue;
        for (double factor = 1; factor <= (quick ? 10 : 100); factor *= 10) {
            PlannedScene longer = scene;
            longer.scene.duration *= factor;
            const Problem problem = pose(longer.scene);
            Settings settings;
            settings.tolerance = curve.settings.back();
            settings.samples = 1000;
            const Trajectory trajectory = solve(problem, *curve.method, settings);
            settings.record = false;
            const Trajectory timed = solve(problem, *curve.method, settings);
            const Reference truth = reference(longer.scene, settings.samples);
            std::vector<Cell> row{scene.label, std::string(curve.method->name), *settings.tolerance,
                                  longer.scene.duration, std::string(name_of(trajectory.status))};
            if (trajectory.status == Status::ok) {
                const ErrorSeries series = error_series(longer.scene, trajectory, truth);
                const Errors worst = errors(series, trajectory, truth);
                const auto exponent = [&](const std::vector<double>& error) {
                    const std::optional<Growth> growth = error_growth(series.t, error, 0.1);
                    return cell_of(growth ? std::optional(growth->exponent) : std::nullopt);
                };
                row.insert(row.end(),
                           {cell_of(worst["attitude"].max), exponent(series["attitude"]), cell_of(worst["energy"].max),
                            exponent(series["energy"]), trajectory.steps, timed.seconds / longer.scene.duration, ""});
            } else {
                row.insert(row.end(), {Cell(), Cell(), Cell(), Cell(), Cell(), Cell(), trajectory.message});
            }
            table.rows.push_back(std::move(row));
        }
    }
}

}  // namespace

Findings run_speed(const Plan& plan, const RunOptions& options) {
    Findings result;
    NamedTable margins{"margins",
                       "Factors in time at equal error, asked for and reached",
                       {{"scene", "attitude_error", "own", "own_seconds", "peer", "peer_seconds", "ratio",
                         "ratio_of_minima", "ratio_asked", "reached"},
                        {}},
                       {{"scene", "scene"},
                        {"attitude_error", "error (rad)"},
                        {"own", "ours"},
                        {"own_seconds", "time (s)"},
                        {"peer", "against"},
                        {"peer_seconds", "time (s)"},
                        {"ratio", "factor"},
                        {"ratio_asked", "asked"}}};
    NamedTable smallest{"smallest",
                        "The smallest error of each method and its time at given errors",
                        {{"scene", "method", "setting", "attitude_error_max", "momentum_error_max", "energy_error_max",
                          "seconds_median", "seconds_at_1e-6", "seconds_at_1e-9", "seconds_at_1e-12"},
                         {}}};
    NamedTable lasting{
        "long",
        "Long runs of closed-form motions",
        {{"scene", "method", "tolerance", "duration", "status", "attitude_error_max", "attitude_exponent",
          "energy_error_max", "energy_exponent", "steps", "seconds_per_second_of_motion", "message"},
         {}}};
    std::vector<Result> all;
    for (const PlannedScene& scene : plan.scenes) {
        const SceneSpeeds speeds(plan, scene, all);
        add_margins(margins.table, scene, speeds);
        add_smallest(smallest.table, plan, scene, speeds);
        add_long(lasting.table, plan, scene, options.quick);
    }
    NamedTable runs{"", "", {result_columns(), {}}};
    for (const Result& row : all) runs.table.rows.push_back(row_of(plan.experiment.name, row));
    runs.for_people = {
        {"scene", "scene"},   {"method", "method"},           {"setting", "setting"},
        {"status", "status"}, {"seconds_median", "time (s)"}, {"attitude_error_max", "attitude error (rad)"}};
    result.figures = work_precision_figures(plan, all);
    for (NamedTable* table : {&runs, &margins, &smallest, &lasting}) result.tables.push_back(std::move(*table));
    return result;
}

}  // namespace polhode
