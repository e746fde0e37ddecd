// Runs sweeps. First the truths of all scenes are computed in parallel. Then, scene by scene and setting by setting
// from coarse to fine, the errors of all methods are measured in parallel and their runs are timed in turn. Each case
// is claimed before it is run and stored when it is finished, so that several processes can share a directory.
#include "experiment/run/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <thread>
#include <utility>

#include "experiment/run/case.h"
#include "experiment/run/case_store.h"
#include "experiment/run/locks.h"
#include "experiment/run/progress.h"
#include "experiment/run/timing.h"
#include "experiment/run/versions.h"
#include "integrators/analysis/conditioning.h"
#include "integrators/run/watch.h"
#include "integrators/truth/reference.h"
#include "text/claims.h"
#include "text/parallel.h"

namespace polhode {
namespace {

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free);

std::vector<Case> list_cases(const Plan& plan, const RunOptions& options) {
    std::vector<Case> cases;
    const CaseSelection selection(plan, options);
    for (std::size_t s = 0; s < plan.scenes.size(); ++s)
        for (std::size_t k = 0; k < plan.curves.size(); ++k) {
            if (!selection.contains(s, k)) continue;
            const PlannedCurve& curve = plan.curves[k];
            for (std::size_t rank = 0; rank < curve.settings.size(); ++rank) {
                Case c{
                    &plan.scenes[s], &curve, rank, case_key(plan, plan.scenes[s], curve, curve.settings[rank]), {}, {}};
                c.result = load_case(options.directory, c.key);
                cases.push_back(std::move(c));
            }
        }
    return cases;
}

// The conditioning at the experiment's samples. A limit on steps, not on time, gives the same result on every machine.
Conditioning compute_conditioning(const Scene& scene, long samples) {
    ConditioningSettings settings;
    settings.max_steps = 10'000'000;
    return conditioning(scene, sample_times(scene.duration, samples), settings);
}

// Runs all cases of one scene: for each setting, coarse to fine, errors in parallel and then timings in turn.
class SceneSweep {
  public:
    SceneSweep(const Plan& plan, const RunOptions& options, std::vector<Case*> cases, const Reference& truth,
               const Conditioning& conditioning, const Claims& claims, Progress& progress)
        : plan_(plan),
          options_(options),
          cases_(std::move(cases)),
          truth_(truth),
          conditioning_(conditioning),
          floors_(compute_floors(conditioning)),
          kappa_(conditioning.available ? std::optional(conditioning.attitude.back()) : std::nullopt),
          claims_(claims),
          progress_(progress) {}

    // Runs the cases that no other process has claimed. Returns their number.
    long run() {
        const Scene& scene = cases_.front()->scene->scene;
        std::size_t ranks = 0;
        for (const Case* c : cases_) ranks = std::max(ranks, c->rank + 1);
        for (const Case* c : cases_)
            if (!problems_.contains(c->curve->formulation))
                problems_.emplace(c->curve->formulation, pose(scene, c->curve->formulation));
        long run = 0;
        for (std::size_t rank = 0; rank < ranks && !interrupted; ++rank) {
            std::vector<Case*> now;
            for (Case* c : cases_)
                if (c->rank == rank && !c->result) now.push_back(c);
            run += run_rank(now);
        }
        return run;
    }

  private:
    // the coarser case at which the curve was cut; null if it was not cut
    const Case* find_cut(const Case& c) const {
        for (const Case* other : cases_)
            if (other->curve == c.curve && other->rank < c.rank && other->result && other->result->cut) return other;
        return nullptr;
    }

    // whether a coarser case of the curve has no result yet; another process runs it, and it may cut the curve
    bool has_pending_predecessor(const Case& c) const {
        return std::any_of(cases_.begin(), cases_.end(), [&](const Case* other) {
            return other->curve == c.curve && other->rank < c.rank && !other->result;
        });
    }

    const Problem& problem_of(const Case& c) const { return problems_.at(c.curve->formulation); }

    // Claims cases. Returns those to run; others are waiting, claimed by another process, stored or cut.
    std::vector<Case*> claim_cases(const std::vector<Case*>& all, std::vector<Claims::Claim>& held) {
        std::vector<Case*> now;
        for (Case* c : all) {
            if (has_pending_predecessor(*c)) continue;
            std::optional<Claims::Claim> claim = claims_.take(c->key);
            if (!claim) continue;
            held.push_back(std::move(*claim));
            if ((c->result = load_case(options_.directory, c->key))) {
                // another process has stored it in the meantime
                progress_.advance(describe_case(plan_, *c));
            } else if (const Case* at = find_cut(*c)) {
                cut_curve(*at, *c);
                store(*c);
            } else {
                now.push_back(c);
            }
        }
        return now;
    }

    // Stores the results with their timings.
    void store_timed(const std::vector<Case*>& now, const std::vector<TimedRun>& runs) {
        auto timed = runs.begin();
        for (Case* c : now) {
            Result& result = *c->result;
            result.seconds_min.reset();
            if (result.status == Status::ok || result.status == Status::tolerance_not_met) {
                const TimedRun& run = *timed++;
                c->spent += run.spent;
                if (run.failure.empty()) {
                    result.seconds_min = run.minimum(), result.seconds_median = run.median();
                    result.repeats = static_cast<long>(run.seconds.size());
                } else {
                    result.status = Status::failed, result.message = run.failure;
                    result.cut = run.limit_reached;
                    result.errors = {};
                    if (result.cut) result.steps.reset(), result.rhs_evaluations.reset(), result.counts = {};
                }
            }
            store(*c);
        }
    }

    // Runs the cases of one setting that no other process has claimed. Returns their number.
    long run_rank(const std::vector<Case*>& all) {
        std::vector<Claims::Claim> held;  // released when all are stored
        const std::vector<Case*> now = claim_cases(all, held);
        parallel_for(now.size(), options_.jobs, [&](std::size_t i) {
            const FileLock shared_lock(machine_lock_file(), FileLock::Kind::shared, interrupted);
            const Stopwatch stopwatch;
            if (!interrupted) measure_errors(plan_.experiment, problem_of(*now[i]), truth_, *now[i], kappa_);
            now[i]->spent = stopwatch.seconds();
        });
        if (interrupted) {
            // cases without timings are not finished
            for (Case* c : now) c->result.reset();
            return 0;
        }
        std::vector<TimedRun> runs;
        for (Case* c : now) {
            if (c->result->status == Status::ok || c->result->status == Status::tolerance_not_met)
                runs.push_back({&problem_of(*c), c->curve->method, c->settings, *c->result->seconds_min});
        }
        {
            const FileLock exclusive_lock(machine_lock_file(), FileLock::Kind::exclusive, interrupted);
            time_interleaved(runs, plan_.experiment.repeats, interrupted);
        }
        if (interrupted) {
            for (Case* c : now) c->result.reset();
            return 0;
        }
        store_timed(now, runs);
        return static_cast<long>(now.size());
    }

    void store(Case& c) {
        static const std::string machine = processor_name();
        c.result->floors = floors_;
        c.result->machine = machine;
        ErrorSeries& series = c.result->series;
        if (conditioning_.available)
            for (std::size_t k = 0; k < series.t.size(); ++k)
                series.float64_floor.push_back(conditioning_.floor(k, float64_roundoff));
        const std::string description = describe_case(plan_, c);
        // the case last, so that a stored case is complete
        save_duration(options_.directory, description, c.spent);
        save_case(options_.directory, c.key, plan_.experiment.name, *c.result);
        progress_.advance(description);
    }

    const Plan& plan_;
    const RunOptions& options_;
    std::vector<Case*> cases_;
    const Reference& truth_;
    const Conditioning& conditioning_;
    const Floors floors_;
    const std::optional<double> kappa_;  // condition number of the attitude at T
    std::map<Formulation, Problem> problems_;
    const Claims& claims_;
    Progress& progress_;
};

}  // namespace

void interrupt_sweep() { interrupted = true; }
bool sweep_interrupted() { return interrupted; }
void allow_sweeps() { interrupted = false; }

CaseSelection::CaseSelection(const Plan& plan, const RunOptions& options)
    : plan_(plan),
      filter_(options.filter),
      shard_(options.shard),
      shards_(options.shards),
      is_empty_(options.only_gather) {
    if (options.costs && shards_ > 1) shard_of_curve_ = assign_shards(plan, *options.costs, shards_);
}

bool CaseSelection::contains(std::size_t scene, std::size_t curve) const {
    if (is_empty_) return false;
    const int owner = shard_of_curve_.empty() ? static_cast<int>(scene % static_cast<std::size_t>(shards_))
                                              : shard_of_curve_[scene][curve];
    return owner == shard_ - 1 &&
           filter_.matches(plan_.scenes[scene].label + "/" + std::string(plan_.curves[curve].method->name));
}

std::vector<PendingCase> pending_cases(const Plan& plan, const RunOptions& options) {
    std::vector<PendingCase> pending;
    for (const Case& c : list_cases(plan, options)) {
        if (c.result) continue;
        const std::string description = describe_case(plan, c);
        pending.push_back({description, load_duration(options.directory, description)});
    }
    return pending;
}

SweepCount run_sweep(const Plan& plan, const RunOptions& options) {
    std::vector<Case> cases = list_cases(plan, options);
    SweepCount sweep;
    sweep.cases = static_cast<long>(cases.size());
    Progress progress(
        static_cast<long>(std::count_if(cases.begin(), cases.end(), [](const Case& c) { return !c.result; })),
        options.quiet);
    // a scene with unfinished cases
    struct PendingScene {
        std::vector<Case*> cases;
        Reference truth;
        Conditioning conditioning;
    };
    std::vector<PendingScene> scenes;
    for (auto begin = cases.begin(); begin != cases.end();) {
        const auto end = std::find_if(begin, cases.end(), [&](const Case& c) { return c.scene != begin->scene; });
        if (std::any_of(begin, end, [](const Case& c) { return !c.result; })) {
            scenes.emplace_back();
            for (auto c = begin; c != end; ++c) scenes.back().cases.push_back(&*c);
        }
        begin = end;
    }
    // truths take the longest time, so all of them are computed first, in parallel
    progress.report(fmt::format("{}: computing {} truths", plan.experiment.name, scenes.size()));
    parallel_for(scenes.size(), options.jobs, [&](std::size_t i) {
        const FileLock shared_lock(machine_lock_file(), FileLock::Kind::shared, interrupted);
        if (interrupted) return;
        const Scene& scene = scenes[i].cases.front()->scene->scene;
        const Stopwatch stopwatch;
        scenes[i].truth = reference(scene, plan.experiment.samples);
        scenes[i].conditioning = compute_conditioning(scene, plan.experiment.samples);
        save_truth_duration(options.directory, plan, *scenes[i].cases.front()->scene, stopwatch.seconds());
    });
    // retry cases claimed by other processes: these either store the result or release the claim
    const Claims claims(claims_file(options.directory));
    while (!scenes.empty() && !interrupted) {
        const auto missing = [](const PendingScene& known) {
            return std::count_if(known.cases.begin(), known.cases.end(), [](const Case* c) { return !c->result; });
        };
        bool none_moved = true;
        for (PendingScene& known : scenes) {
            if (interrupted) break;
            const auto before = missing(known);
            sweep.run +=
                SceneSweep(plan, options, known.cases, known.truth, known.conditioning, claims, progress).run();
            none_moved = none_moved && missing(known) == before;
            if (missing(known) == 0) known = {};
        }
        std::erase_if(scenes, [](const PendingScene& known) { return known.cases.empty(); });
        if (none_moved && !scenes.empty() && !interrupted) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return sweep;
}

std::vector<Result> finished_results(const Plan& plan, const std::string& directory) {
    RunOptions everything;
    everything.directory = directory;
    std::vector<Result> results;
    for (Case& c : list_cases(plan, everything))
        if (c.result) results.push_back(std::move(*c.result));
    return results;
}

}  // namespace polhode
