// Searches for the largest stable and accurate steps.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <stdexcept>

#include "experiment/kinds/stability.h"
#include "experiment/run/case.h"
#include "experiment/run/search.h"
#include "integrators/analysis/conditioning.h"
#include "integrators/run/eigenvalues.h"
#include "integrators/truth/reference.h"
#include "scene/scene_family.h"

namespace polhode {
namespace {

/// A posed scene and its truth.
struct Posed {
    Problem problem;
    Reference truth;
};

double largest_rate(const Reference& truth) {
    double rate = 0;
    for (const ReferenceSample& sample : truth.samples) {
        const auto& w = sample.angular_velocity_B;
        rate = std::max(rate, std::hypot(w[0].high, w[1].high, w[2].high));
    }
    return rate;
}

void describe_scene(const Posed& posed, StabilityScene& scene) {
    constexpr double same = 1e-3;
    if (!posed.truth.available) return;
    const double turning = largest_rate(posed.truth);
    scene.fastest_rate = turning;
    scene.eigenvalues = eigenvalues(posed.problem, posed.truth.samples.front().rounded());
    const double first = std::abs(largest_in_magnitude(scene.eigenvalues));
    scene.is_linear = turning > 0 && posed.problem.needs.system == SystemKind::principal_axis_rotation &&
                      !posed.problem.needs.torque_free && posed.problem.segments.size() == 1;
    for (const ReferenceSample& sample : posed.truth.samples) {
        const double largest = std::abs(largest_in_magnitude(eigenvalues(posed.problem, sample.rounded())));
        scene.fastest_rate = std::max(scene.fastest_rate, largest);
        if (std::abs(largest - first) > same * first) scene.is_linear = false;
    }
}

// computes the conditioning with a limit on steps, which gives the same result on every machine
void find_conditioning(const Problem& problem, long samples, StabilityScene& scene) {
    ConditioningSettings settings;
    settings.max_steps = 200'000;
    const Conditioning c = conditioning(problem, sample_times(problem.scene.duration, samples), settings);
    scene.floors = compute_floors(c);
    if (c.available) scene.kappa = c.attitude.back();
}

// Corrects status and message of runs that the sweep reports as `ok` although their motion is wrong.
void correct_status(const Experiment& experiment, Result& result, Outcome outcome) {
    if (result.status != Status::ok) return;
    const double attitude = result.errors["attitude"].max.value_or(0);
    if (outcome == Outcome::diverged) {
        result.status = Status::diverged;
        result.message =
            fmt::format("largest errors relative to the true motion: angular velocity {:.3g}, energy {:.3g}",
                        result.errors["omega"].max.value_or(0), result.errors["energy"].max.value_or(0));
    } else if (attitude > 1) {
        result.status = result.setting_kind == SettingKind::tolerance ? Status::tolerance_not_met : Status::failed;
        result.message = fmt::format("{}: largest attitude error over {} samples is {:.3g} rad", name_of(outcome),
                                     experiment.samples, attitude);
        if (result.floors.float64 && *result.floors.float64 > 0.1)
            result.message +=
                fmt::format("; rounding of the scene's data alone causes {:.2g} rad", *result.floors.float64);
    }
}

/// All runs of one method on one scene with one kind of setting.
class StepSearch {
  public:
    StepSearch(const Experiment& experiment, const PlannedScene& planned, const Posed& posed,
               const StabilityScene& scene, const PlannedCurve& curve)
        : experiment_(experiment), planned_(planned), posed_(posed), scene_(scene), curve_(curve) {}

    std::vector<StabilityRun> run() {
        if (curve_.kind != SettingKind::step) {
            for (const double setting : curve_.settings) try_setting(setting);
            return std::move(runs_);
        }
        const std::vector<long> ladder = descend();
        if (ladder.size() > 1) {
            bisect(ladder, Outcome::damped_to_rest, 1.01);
            bisect(ladder, Outcome::close, 1.1);
            bisect(ladder, Outcome::accurate, 1.1);
        }
        std::stable_sort(runs_.begin(), runs_.end(), [](const StabilityRun& a, const StabilityRun& b) {
            return a.result.setting > b.result.setting;
        });
        return std::move(runs_);
    }

  private:
    const StabilityRun& try_setting(double setting) {
        const PlannedCurve one{curve_.method, curve_.style, curve_.kind, {setting}, curve_.formulation, false};
        Case c{&planned_, &one, 0, {}};
        Trajectory trajectory = measure_errors(experiment_, posed_.problem, posed_.truth, c, scene_.kappa);
        Result& result = *c.result;
        result.floors = scene_.floors;
        // runs share the machine: one time each, not meant for comparisons
        result.seconds_median = result.seconds_min, result.repeats = 1;
        // a tolerance-driven run with a large error at T is not `ok`
        trajectory.status = result.status;
        const Outcome outcome = outcome_of(trajectory, result.errors, posed_.truth);
        correct_status(experiment_, result, outcome);
        runs_.push_back({std::move(result), outcome});
        return runs_.back();
    }

    double step_of(long per_sample) const {
        return posed_.problem.scene.duration / static_cast<double>(experiment_.samples * per_sample);
    }
    const StabilityRun& try_steps(long per_sample) {
        const double h = step_of(per_sample);
        for (const StabilityRun& run : runs_)
            if (run.result.setting == h) return run;
        return try_setting(h);
    }

    // Doubles the number of steps per sample interval until two runs in a row are accurate or a limit is reached.
    // Returns these numbers.
    std::vector<long> descend() {
        std::vector<long> ladder;
        int accurate = 0;
        for (long k = 1; k <= experiment_.max_evaluations; k *= 2) {
            if (sweep_interrupted()) break;
            const StabilityRun& run = try_steps(k);
            ladder.push_back(k);
            if (run.outcome == Outcome::unsupported || run.result.cut) break;
            accurate = run.outcome == Outcome::accurate ? accurate + 1 : 0;
            if (accurate == 2) break;
        }
        return ladder;
    }

    // Bisects between the smallest step of the ladder whose outcome is worse than `worst` and the next smaller one,
    // until their ratio is `ratio`. Does nothing if the smallest step is worse than `worst` or the largest is not.
    void bisect(const std::vector<long>& ladder, Outcome worst, double ratio) {
        const auto passes = [&](long k) { return try_steps(k).outcome <= worst; };
        std::size_t at = ladder.size();
        // the outcome of a run that was cut is not meaningful
        while (at > 0 && try_steps(ladder[at - 1]).result.cut) --at;
        const std::size_t finest = at;
        while (at > 0 && passes(ladder[at - 1])) --at;
        if (at == finest || at == 0) return;
        long coarse = ladder[at - 1], fine = ladder[at];
        while (fine - coarse > 1 && static_cast<double>(fine) > ratio * static_cast<double>(coarse)) {
            if (sweep_interrupted()) return;
            const auto middle = static_cast<long>(
                std::lround(std::sqrt(static_cast<double>(coarse)) * std::sqrt(static_cast<double>(fine))));
            const long k = std::clamp(middle, coarse + 1, fine - 1);
            (passes(k) ? fine : coarse) = k;
        }
    }

    const Experiment& experiment_;
    const PlannedScene& planned_;
    const Posed& posed_;
    const StabilityScene& scene_;
    const PlannedCurve& curve_;
    std::vector<StabilityRun> runs_;
};

Outcome outcome_named(const std::string& name) {
    for (const Outcome outcome : outcomes)
        if (name == name_of(outcome)) return outcome;
    throw std::invalid_argument("unknown outcome");
}

Table empty_runs_table() {
    Table table{result_columns(), {}};
    table.columns.insert(table.columns.end(), {"family", "parameter", "fastest_rate", "outcome"});
    return table;
}

void append_runs(Table& table, const std::string& experiment, const StabilityScene& scene,
                 const std::vector<StabilityRun>& runs) {
    for (const StabilityRun& run : runs) {
        std::vector<Cell> row = result_row(experiment, run.result);
        row.insert(row.end(),
                   {scene.family, cell_of(scene.parameter), scene.fastest_rate, std::string(name_of(run.outcome))});
        table.rows.push_back(std::move(row));
    }
}

// throws std::invalid_argument if a cell cannot be read
std::vector<StabilityRun> runs_of(const Table& table) {
    std::vector<StabilityRun> runs;
    const std::size_t outcome = column_index(table, "outcome");
    for (std::size_t row = 0; row < table.rows.size(); ++row)
        runs.push_back({parse_result(table, row), outcome_named(text_of(table.rows[row][outcome]))});
    return runs;
}

// a varied scene, NAME{..}, belongs to the family of the scene NAME
StabilityScene scene_of(const PlannedScene& planned) {
    StabilityScene scene;
    scene.label = planned.label, scene.duration = planned.scene.duration;
    const FamilyMember member = family_member(planned.label.substr(0, planned.label.find('{')));
    scene.family = member.family;
    if (!member.parameter.empty()) scene.parameter = member.value;
    return scene;
}

// the largest step such that it and all smaller ones have an outcome not worse than `worst`
const StabilityRun* largest_step(const std::vector<StabilityRun>& runs, Outcome worst) {
    const StabilityRun* found = nullptr;
    for (auto run = runs.rbegin(); run != runs.rend(); ++run) {
        if (run->result.cut && !found) continue;
        if (run->outcome > worst) break;
        found = &*run;
    }
    return found;
}

void find_limits(StabilityFinding& finding) {
    if (finding.kind != SettingKind::step) return;
    finding.stable = largest_step(finding.runs, Outcome::damped_to_rest);
    finding.close = largest_step(finding.runs, Outcome::close);
    finding.accurate = largest_step(finding.runs, Outcome::accurate);
    // the next larger step of the ladder: steps of the last bisections are too close to the limit
    for (const StabilityRun& run : finding.runs) {
        if (run.outcome <= Outcome::damped_to_rest || run.outcome == Outcome::unsupported || run.result.cut) continue;
        if (!finding.stable || run.result.setting > 1.2 * finding.stable->result.setting) finding.beyond = &run;
    }
}

}  // namespace

StabilityFindings run_stability_cases(const Plan& plan, const RunOptions& options) {
    const Experiment& experiment = plan.experiment;
    StabilityFindings found;
    for (const PlannedScene& planned : plan.scenes) found.scenes.push_back(scene_of(planned));
    std::vector<Search> searches = find_searches(plan, options.directory);
    found.findings.resize(searches.size());
    for (std::size_t i = 0; i < searches.size(); ++i) {
        StabilityFinding& finding = found.findings[i];
        finding.scene = &found.scenes[searches[i].scene];
        finding.method = searches[i].curve->method, finding.kind = searches[i].curve->kind;
        if (!searches[i].rows) continue;
        try {
            finding.runs = runs_of(*searches[i].rows);
        } catch (const std::invalid_argument&) {
            searches[i].rows.reset();
        }
    }
    std::vector<std::unique_ptr<Posed>> posed(plan.scenes.size());
    run_searches(
        plan, options, searches,
        [&](std::size_t s, bool needed) {
            const Scene& scene = plan.scenes[s].scene;
            posed[s] = std::make_unique<Posed>(Posed{pose(scene), reference(scene, experiment.samples)});
            describe_scene(*posed[s], found.scenes[s]);
            if (needed) find_conditioning(posed[s]->problem, experiment.samples, found.scenes[s]);
        },
        [&](std::size_t i) {
            const std::size_t s = searches[i].scene;
            StabilityFinding& finding = found.findings[i];
            finding.runs = StepSearch(experiment, plan.scenes[s], *posed[s], found.scenes[s], *searches[i].curve).run();
            Table rows = empty_runs_table();
            append_runs(rows, experiment.name, found.scenes[s], finding.runs);
            return rows;
        });
    for (std::size_t i = 0; i < searches.size(); ++i) {
        StabilityFinding& finding = found.findings[i];
        // ignore interrupted searches
        if (!searches[i].rows) ++found.missing, finding.runs.clear();
        if (!finding.runs.empty()) found.scenes[searches[i].scene].floors = finding.runs.front().result.floors;
        find_limits(finding);
    }
    return found;
}

Table stability_table(const Plan& plan, const StabilityFindings& found) {
    Table table = empty_runs_table();
    for (const StabilityFinding& finding : found.findings)
        append_runs(table, plan.experiment.name, *finding.scene, finding.runs);
    return table;
}

}  // namespace polhode
