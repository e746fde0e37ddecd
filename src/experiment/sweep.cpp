#include "experiment/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <numbers>

#include "experiment/calibration.h"
#include "experiment/case_store.h"
#include "experiment/locks.h"
#include "experiment/parallel.h"
#include "experiment/pattern.h"
#include "experiment/progress.h"
#include "experiment/timing.h"
#include "integrators/truth/reference.h"

namespace polhode {
namespace {

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free);

// One case on its way: where it stands in the plan, its key, and its result once there is one.
struct Case {
    const PlannedScene* scene;
    const PlannedCurve* curve;
    std::size_t rank;  // of the setting on its curve
    std::string key;
    std::optional<Result> result;
    Settings settings{};  // what it was run with

    double setting() const { return curve->settings[rank]; }
};

std::vector<Case> cases_of(const Plan& plan, const RunOptions& options) {
    std::vector<Case> cases;
    const Pattern filter(options.filter);
    for (std::size_t s = 0; s < plan.scenes.size(); ++s) {
        if (static_cast<int>(s % static_cast<std::size_t>(options.shards)) != options.shard - 1) continue;
        for (const PlannedCurve& curve : plan.curves) {
            const std::string name = plan.scenes[s].label + "/" + std::string(curve.method->name);
            if (!filter.matches(name)) continue;
            for (std::size_t rank = 0; rank < curve.settings.size(); ++rank) {
                Case c{
                    &plan.scenes[s], &curve, rank, case_key(plan, plan.scenes[s], curve, curve.settings[rank]), {}, {}};
                c.result = load_case(options.directory, c.key);
                cases.push_back(std::move(c));
            }
        }
    }
    return cases;
}

Result blank(const Case& c) {
    Result result;
    result.scene = c.scene->label;
    result.method = c.curve->method->name;
    result.setting_kind = c.curve->kind;
    result.formulation = c.curve->formulation;
    if (c.curve->calibrated) {
        result.evaluations_per_revolution = c.setting();
        result.setting = c.settings.step.value_or(c.settings.tolerance.value_or(0));
    } else {
        result.setting = c.curve->kind == SettingKind::none ? 0 : c.setting();
    }
    return result;
}

// False where no setting costs what it should: then the row says so.
bool choose_settings(const Experiment& experiment, Case& c) {
    Settings& settings = c.settings;
    settings.samples = experiment.samples;
    settings.max_steps = experiment.max_steps;
    settings.seconds_limit = experiment.seconds_per_run;
    settings.formulation = c.curve->formulation;
    double setting = c.setting();
    if (c.curve->calibrated) {
        const Calibration found = calibrate(c.scene->scene, *c.curve->method, c.curve->kind, setting);
        if (!found.found) {
            c.result = blank(c);
            c.result->status = Status::unsupported, c.result->message = found.message;
            return false;
        }
        setting = found.setting;
    }
    if (c.curve->kind == SettingKind::step) settings.step = setting;
    if (c.curve->kind == SettingKind::tolerance) settings.tolerance = setting;
    return true;
}

// T by the mean |w| of the truth, in revolutions
std::optional<double> revolutions(const Reference& reference) {
    if (!reference.available || reference.samples.size() < 2) return {};
    double sum = 0;
    for (const ReferenceSample& s : reference.samples) {
        const auto& w = s.angular_velocity_B;
        sum += std::hypot(w[0].high, w[1].high, w[2].high);
    }
    const double mean = sum / static_cast<double>(reference.samples.size());
    return mean * reference.samples.back().t / (2 * std::numbers::pi);
}

bool keeps_series(Kind kind) { return kind == Kind::drift || kind == Kind::conservation; }

// The untimed run: it takes the steps of the timed one and looks at every sample.
void measure_errors(const Experiment& experiment, const Problem& problem, const Reference& reference, Case& c) {
    if (!choose_settings(experiment, c)) return;
    Result result = blank(c);
    Settings settings = c.settings;
    // looking sideways for samples costs more than the run that is limited
    settings.seconds_limit *= 4;
    const Trajectory trajectory = solve(problem, *c.curve->method, settings);
    result.status = trajectory.status, result.message = trajectory.message;
    result.cut = trajectory.limit_reached;
    if (trajectory.step > 0) result.step_taken = trajectory.step;
    if (trajectory.status != Status::unsupported) {
        result.steps = trajectory.steps, result.rhs_evaluations = trajectory.rhs_evaluations;
        const ErrorSeries series = error_series(problem.scene, trajectory, reference);
        result.errors = errors(series, trajectory, reference);
        if (keeps_series(experiment.kind)) result.series = series, result.revolutions = revolutions(reference);
    }
    if (result.status == Status::ok && !reference.available)
        result.message += (result.message.empty() ? "" : "; ") + ("no truth: " + reference.message);
    if (result.status == Status::ok && c.curve->kind == SettingKind::tolerance &&
        result.errors.attitude_final.value_or(0) > 1) {
        result.status = Status::tolerance_not_met;
        result.message = fmt::format("ends {:.3g} rad off", *result.errors.attitude_final);
    }
    if (result.rhs_evaluations.value_or(0) > experiment.max_evaluations) {
        result.status = Status::failed, result.cut = true, result.errors = {};
        result.message = fmt::format("more than the limit of {} evaluations", experiment.max_evaluations);
    }
    result.seconds_min = trajectory.seconds;  // of this run; timing replaces it
    c.result = std::move(result);
}

// The rows of a curve beyond the setting at which it was cut.
void cut_curve(const Case& at, Case& beyond) {
    beyond.result = blank(beyond);
    beyond.result->status = Status::failed;
    beyond.result->cut = true;
    beyond.result->message =
        fmt::format("not run: the curve was cut at {} {:g}", name_of(at.curve->kind), at.setting());
}

// All cases of one scene: truth, then setting by setting all methods side by side.
class SceneSweep {
  public:
    SceneSweep(const Plan& plan, const RunOptions& options, std::vector<Case*> cases, Progress& progress)
        : plan_(plan), options_(options), cases_(std::move(cases)), progress_(progress) {}

    long run() {
        const Experiment& experiment = plan_.experiment;
        const Scene& scene = cases_.front()->scene->scene;
        std::size_t ranks = 0;
        for (const Case* c : cases_) ranks = std::max(ranks, c->rank + 1);
        if (std::all_of(cases_.begin(), cases_.end(), [](const Case* c) { return c->result.has_value(); })) return 0;
        progress_.say(fmt::format("{}: truth of {}", experiment.name, cases_.front()->scene->label));
        const Reference reference = polhode::reference(scene, experiment.samples);
        for (const Case* c : cases_)
            if (!problems_.contains(c->curve->formulation))
                problems_.emplace(c->curve->formulation, pose(scene, c->curve->formulation));
        long run = 0;
        for (std::size_t rank = 0; rank < ranks && !interrupted; ++rank) {
            std::vector<Case*> now;
            for (Case* c : cases_)
                if (c->rank == rank && !c->result) now.push_back(c);
            run += run_rank(reference, now);
        }
        return run;
    }

  private:
    // the coarser case at which this one's curve was cut, if it was
    const Case* cut_before(const Case& c) const {
        for (const Case* other : cases_)
            if (other->curve == c.curve && other->rank < c.rank && other->result && other->result->cut) return other;
        return nullptr;
    }

    const Problem& problem_of(const Case& c) const { return problems_.at(c.curve->formulation); }

    long run_rank(const Reference& reference, const std::vector<Case*>& all) {
        std::vector<Case*> now;
        for (Case* c : all) {
            if (const Case* at = cut_before(*c)) {
                cut_curve(*at, *c);
                store(*c);
            } else {
                now.push_back(c);
            }
        }
        parallel_for(now.size(), options_.jobs, [&](std::size_t i) {
            const FileLock beside_no_timing(machine_lock_file(), FileLock::Kind::shared, interrupted);
            if (!interrupted) measure_errors(plan_.experiment, problem_of(*now[i]), reference, *now[i]);
        });
        if (interrupted) {
            // errors without timings are no finished cases
            for (Case* c : now) c->result.reset();
            return 0;
        }
        std::vector<TimedRun> runs;
        for (Case* c : now) {
            if (c->result->status == Status::ok || c->result->status == Status::tolerance_not_met)
                runs.push_back({&problem_of(*c), c->curve->method, c->settings, *c->result->seconds_min});
        }
        {
            const FileLock alone(machine_lock_file(), FileLock::Kind::exclusive, interrupted);
            time_interleaved(runs, plan_.experiment.repeats, interrupted);
        }
        if (interrupted) {
            for (Case* c : now) c->result.reset();
            return 0;
        }
        auto timed = runs.begin();
        for (Case* c : now) {
            Result& result = *c->result;
            result.seconds_min.reset();
            if (result.status == Status::ok || result.status == Status::tolerance_not_met) {
                const TimedRun& run = *timed++;
                if (run.failure.empty()) {
                    result.seconds_min = run.minimum(), result.seconds_median = run.median();
                    result.repeats = static_cast<long>(run.seconds.size());
                } else {
                    result.status = Status::failed, result.message = run.failure;
                    result.cut = run.limit_reached;
                    result.errors = {};
                }
            }
            store(*c);
        }
        return static_cast<long>(now.size());
    }

    void store(const Case& c) {
        save_case(options_.directory, c.key, plan_.experiment.name, *c.result);
        progress_.advance(fmt::format("{} {} {}", plan_.experiment.name, c.result->scene, c.result->method));
    }

    const Plan& plan_;
    const RunOptions& options_;
    std::vector<Case*> cases_;
    std::map<Formulation, Problem> problems_;
    Progress& progress_;
};

std::string line_of(const Plan& plan, const Case& c) {
    const std::string setting =
        c.curve->kind == SettingKind::none ? "" : fmt::format(" {} {:g}", name_of(c.curve->kind), c.setting());
    return fmt::format("{} {} {}{}", plan.experiment.name, c.scene->label, c.curve->method->name, setting);
}

}  // namespace

void interrupt_sweep() { interrupted = true; }
bool sweep_interrupted() { return interrupted; }

std::vector<std::string> pending_cases(const Plan& plan, const RunOptions& options) {
    std::vector<std::string> lines;
    for (const Case& c : cases_of(plan, options))
        if (!c.result) lines.push_back(line_of(plan, c));
    return lines;
}

SweepCount run_sweep(const Plan& plan, const RunOptions& options) {
    std::vector<Case> cases = cases_of(plan, options);
    SweepCount sweep;
    sweep.cases = static_cast<long>(cases.size());
    Progress progress(
        static_cast<long>(std::count_if(cases.begin(), cases.end(), [](const Case& c) { return !c.result; })),
        options.quiet);
    // truths take the longest and are cached: all of them first, side by side
    std::vector<const PlannedScene*> scenes;
    for (const Case& c : cases)
        if (!c.result && (scenes.empty() || scenes.back() != c.scene)) scenes.push_back(c.scene);
    progress.say(fmt::format("{}: {} truths", plan.experiment.name, scenes.size()));
    parallel_for(scenes.size(), options.jobs, [&](std::size_t i) {
        const FileLock beside_no_timing(machine_lock_file(), FileLock::Kind::shared, interrupted);
        if (!interrupted) reference(scenes[i]->scene, plan.experiment.samples);
    });
    for (auto begin = cases.begin(); begin != cases.end() && !interrupted;) {
        const auto end = std::find_if(begin, cases.end(), [&](const Case& c) { return c.scene != begin->scene; });
        std::vector<Case*> of_scene;
        for (auto c = begin; c != end; ++c) of_scene.push_back(&*c);
        sweep.run += SceneSweep(plan, options, std::move(of_scene), progress).run();
        begin = end;
    }
    return sweep;
}

std::vector<Result> finished_results(const Plan& plan, const std::string& directory) {
    RunOptions everything;
    everything.directory = directory;
    std::vector<Result> results;
    for (Case& c : cases_of(plan, everything))
        if (c.result) results.push_back(std::move(*c.result));
    return results;
}

}  // namespace polhode
