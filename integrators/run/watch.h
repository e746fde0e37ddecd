// What watches over a run: its limits, whether it gets on, whether its motion has diverged, and how it is told.
#pragma once

#include <chrono>
#include <concepts>
#include <string>
#include <utility>

#include "integrators/method.h"

namespace polhode {

/// Holds a run to Settings' limits: of steps, of right-hand sides, and of time, at which it looks now and then.
class Budget {
  public:
    /// Starts the clock.
    explicit Budget(const Settings& settings);

    /// Takes one step; false once the run may not go on, and stop() then says why. `evaluations` is how many right-hand
    /// sides this repetition has evaluated so far.
    bool take(long evaluations = 0) {
        if (steps_ >= max_steps_) return refuse_step();
        ++steps_;
        if (goes_on(evaluations)) return true;
        --steps_;
        return false;
    }
    /// Whether the run may go on with work that is no step: another attempt at one, a sample aside. `evaluations` is as
    /// for take().
    bool goes_on(long evaluations = 0) {
        if (evaluations >= max_evaluations_) return refuse_evaluation();
        return --until_look_ > 0 || in_time();
    }
    /// Steps taken, over all repetitions.
    long steps() const { return steps_; }
    /// Ends a run that needs more steps than it may take before its first: it is `failed`.
    void forbid(Trajectory& trajectory) const;
    /// Ends the run after take() or goes_on() said no: it is `failed`, by its limit, with the reason.
    void stop(Trajectory& trajectory) const;

  private:
    bool refuse_step();
    bool refuse_evaluation();
    bool in_time();
    double spent() const;

    long steps_ = 0, max_steps_, max_evaluations_;
    int repetitions_;
    double seconds_limit_;
    // as many steps between two looks at the clock as take some 10 ms, 1024 at the most
    long until_look_ = 1, between_looks_ = 1;
    double looked_ = 0;  // s, after start_
    std::chrono::steady_clock::time_point start_;
    double processor_start_;
    std::string message_;
};

/// The samples that a run is asked for, which must outlive the queue.
inline SampleQueue sample_queue(const Problem& problem, const Settings& settings) {
    return settings.times.empty() ? SampleQueue(problem.scene.duration, settings.samples) : SampleQueue(settings.times);
}

/// A time (s) as messages tell it: "t = 0.125 s".
std::string moment(double t);

/// A clock that starts when it is made.
class Stopwatch {
  public:
    /// Wall clock since it was made, s.
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// What has gone astray: a number that is not finite, or energy beyond all bounds, with the time; empty where nothing
/// has.
std::string divergence(const Problem& problem, const Bodies& bodies, double bound);

/// "; the last state, at t = .. s: w = (..) rad/s, q = (..)", in body axes: what follows upon what went wrong.
std::string last_state(const Bodies& bodies);

/// What a step's implicit equations that are not solved make of a trajectory; `bodies`: the last state.
void explain_unsolved(Trajectory& trajectory, const Bodies& bodies);

/// Appends the moment, or tells that the run has diverged, with the moment before.
bool record(const Problem& problem, const Bodies& bodies, double bound, Trajectory& trajectory);

/// What a method gives for a problem that it cannot represent: no samples, Status::unsupported, and why.
Trajectory unsupported(std::string message);

/// Calls run(recording) as often as the settings repeat the run, the last time with samples where they are asked for,
/// until one ends early; the trajectory gets the seconds of one. Returns whether all of them went to the end.
template <std::predicate<bool> Run>
bool repeat(const Settings& settings, Trajectory& trajectory, Run&& run) {
    int runs = 0;
    bool complete = true;
    const Stopwatch stopwatch;
    while (complete && runs < settings.repetitions) {
        ++runs;
        complete = run(settings.record && runs == settings.repetitions);
    }
    trajectory.seconds = stopwatch.seconds() / runs;
    return complete;
}

/// Watches over a run whose steps a tolerance drives. What ends the run early sets the trajectory's status and message,
/// and gives false. The energy is looked at with each sample and after every 16 accepted steps. (march() looks at it
/// more rarely, and goes back to the very step that led astray, which only fixed steps let it find.)
class Watch {
  public:
    /// All three must outlive the watch.
    Watch(const Problem& problem, const Settings& settings, Trajectory& trajectory)
        : problem_(&problem),
          settings_(&settings),
          trajectory_(&trajectory),
          bound_(energy_bound(problem)),
          budget_(settings) {}

    /// To be called at t = 0, before each repetition.
    void restart() {
        until_look_ = between_looks;
        marked_steps_ = budget_.steps(), marked_time_ = 0;
    }
    /// Over all repetitions.
    long steps() const { return budget_.steps(); }

    /// Whether a step may be taken; `evaluations` is how many right-hand sides this repetition has evaluated so far.
    bool may_step(long evaluations) { return budget_.take(evaluations) || stop(); }
    /// Whether another attempt at a step, or a step aside, may be made; `evaluations` is as for may_step().
    bool may_attempt(long evaluations) { return budget_.goes_on(evaluations) || stop(); }
    /// To be called after an accepted step to t (s): whether the run makes progress. It makes none where its steps are
    /// so short, accepted by round-off alone, that at their pace the rest would take ten times the limit of steps.
    bool gets_on(double t) {
        constexpr long span = 1 << 14;
        if (budget_.steps() - marked_steps_ < span) return true;
        const double needed = static_cast<double>(span) * (problem_->scene.duration - t) / (t - marked_time_);
        marked_steps_ = budget_.steps(), marked_time_ = t;
        return needed <= 10 * static_cast<double>(settings_->max_steps) ||
               fail(Status::tolerance_not_met,
                    "no progress at " + moment(t) + ": the tolerance is too small for binary64");
    }
    /// To be called after the samples of an accepted step: whether the motion has not diverged. sample() gives the
    /// motion as it is now.
    template <std::invocable Look>
    bool stays_sane(Look&& sample) {
        if (--until_look_ > 0) return true;
        until_look_ = between_looks;
        return is_sane(sample());
    }
    /// Takes a sample; false where the motion has diverged.
    bool record(const Bodies& bodies) { return polhode::record(*problem_, bodies, bound_, *trajectory_); }

    /// Ends the run with this status and message; false.
    bool fail(Status status, std::string message) {
        trajectory_->status = status, trajectory_->message = std::move(message);
        return false;
    }

  private:
    static constexpr int between_looks = 16;  // accepted steps

    bool stop() {
        budget_.stop(*trajectory_);
        return false;
    }
    bool is_sane(const Bodies& bodies) {
        std::string what = divergence(*problem_, bodies, bound_);
        return what.empty() || fail(Status::diverged, what + last_state(bodies));
    }

    const Problem* problem_;
    const Settings* settings_;
    Trajectory* trajectory_;
    double bound_;
    Budget budget_;
    long marked_steps_ = 0;
    double marked_time_ = 0;  // s
    int until_look_ = between_looks;
};

}  // namespace polhode
