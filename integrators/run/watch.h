// Supervision of a run: its limits, its progress, divergence of its motion, and the related messages.
#pragma once

#include <chrono>
#include <concepts>
#include <string>
#include <utility>

#include "integrators/method.h"

namespace polhode {

/// Enforces the limits of Settings: steps, right-hand-side evaluations, and time, which is checked at intervals.
class Budget {
  public:
    /// Starts the clock.
    explicit Budget(const Settings& settings);

    /// Takes one step. Returns false if the run must end; report_limit() then sets the reason. `evaluations` is the
    /// number of right-hand-side evaluations in this repetition so far.
    bool count_step(long evaluations = 0) {
        if (steps_ >= max_steps_) return report_step_limit();
        ++steps_;
        if (may_continue(evaluations)) return true;
        --steps_;
        return false;
    }
    /// Returns true if the run may continue with work that is not a step: another attempt, or a separate sample.
    /// `evaluations` as for count_step().
    bool may_continue(long evaluations = 0) {
        if (evaluations >= max_evaluations_) return report_evaluation_limit();
        return --until_check_ > 0 || check_time();
    }
    /// Number of steps over all repetitions.
    long steps() const { return steps_; }
    /// Ends a run before its first step because it needs more steps than allowed: Status::failed.
    void report_excess_steps(Trajectory& trajectory) const;
    /// Ends the run after count_step() or may_continue() returned false: Status::failed, with the reason.
    void report_limit(Trajectory& trajectory) const;

  private:
    bool report_step_limit();
    bool report_evaluation_limit();
    bool check_time();
    double elapsed() const;

    long steps_ = 0, max_steps_, max_evaluations_;
    int repetitions_;
    double seconds_limit_;
    // number of steps between two checks of the clock, about 10 ms, at most 1024
    long until_check_ = 1, check_interval_ = 1;
    double checked_at_ = 0;  // s after start_
    std::chrono::steady_clock::time_point start_;
    double processor_start_;
    std::string message_;
};

/// The requested samples of a run. Problem and settings must outlive the queue.
inline SampleQueue sample_queue(const Problem& problem, const Settings& settings) {
    return settings.times.empty() ? SampleQueue(problem.scene.duration, settings.samples) : SampleQueue(settings.times);
}

/// Formats a time, s, for messages: "t = 0.125 s".
std::string format_time(double t);

/// A clock that starts on construction.
class Stopwatch {
  public:
    /// Wall clock since construction, s.
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Why the motion has diverged (a value is not finite, or the energy exceeds `bound`), with the time; or empty.
std::string divergence(const Problem& problem, const Bodies& bodies, double bound);

/// "; the last state, at t = .. s: w = (..) rad/s, q = (..)", in body axes. Appended to messages of failures.
std::string last_state(const Bodies& bodies);

/// Sets status and message for a step whose implicit equations were not solved. `bodies`: the last state.
void report_unsolved_step(Trajectory& trajectory, const Bodies& bodies);

/// Appends the sample and returns true, or sets Status::diverged with the previous sample and returns false.
bool record(const Problem& problem, const Bodies& bodies, double bound, Trajectory& trajectory);

/// The result for a problem that a method cannot represent: no samples, Status::unsupported and the reason.
Trajectory unsupported(std::string message);

/// Calls run(recording) `repetitions` times, or until one call returns false. Only the last call records samples, if
/// the settings request them. Sets the trajectory's seconds to the mean per run. Returns whether all runs completed.
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

/// Supervises a tolerance-driven run. A failed check sets the trajectory's status and message and returns false. The
/// energy is checked with each sample and after every 16 accepted steps. (march() checks it less often and then finds
/// the exact step that diverged, which is possible only with fixed steps.)
class Watch {
  public:
    /// The arguments must outlive this object.
    Watch(const Problem& problem, const Settings& settings, Trajectory& trajectory)
        : problem_(&problem),
          settings_(&settings),
          trajectory_(&trajectory),
          bound_(energy_bound(problem)),
          budget_(settings) {}

    /// Must be called at t = 0, before each repetition.
    void restart() {
        until_check_ = check_interval;
        marked_steps_ = budget_.steps(), marked_time_ = 0;
    }
    /// Number of steps over all repetitions.
    long steps() const { return budget_.steps(); }

    /// True if a step may be taken; `evaluations` is the number of right-hand-side evaluations in this repetition.
    bool may_step(long evaluations) { return budget_.count_step(evaluations) || stop(); }
    /// True if another attempt or a separate step for a sample may be made; `evaluations` as for may_step().
    bool may_attempt(long evaluations) { return budget_.may_continue(evaluations) || stop(); }
    /// Must be called after an accepted step to t, s. Returns false if the run makes no progress: its steps are so
    /// short, accepted only through round-off, that the rest would take ten times the step limit.
    bool makes_progress(double t) {
        constexpr long span = 1 << 14;
        if (budget_.steps() - marked_steps_ < span) return true;
        const double needed = static_cast<double>(span) * (problem_->scene.duration - t) / (t - marked_time_);
        marked_steps_ = budget_.steps(), marked_time_ = t;
        return needed <= 10 * static_cast<double>(settings_->max_steps) ||
               fail(Status::tolerance_not_met,
                    "no progress at " + format_time(t) + ": the tolerance is too small for binary64");
    }
    /// Must be called after the samples of an accepted step. Returns false if the motion has diverged. sample() returns
    /// the current motion.
    template <std::invocable Sampler>
    bool stays_bounded(Sampler&& sample) {
        if (--until_check_ > 0) return true;
        until_check_ = check_interval;
        return is_bounded(sample());
    }
    /// Records a sample; returns false if the motion has diverged.
    bool record(const Bodies& bodies) { return polhode::record(*problem_, bodies, bound_, *trajectory_); }

    /// Ends the run with this status and message; returns false.
    bool fail(Status status, std::string message) {
        trajectory_->status = status, trajectory_->message = std::move(message);
        return false;
    }

  private:
    static constexpr int check_interval = 16;  // accepted steps

    bool stop() {
        budget_.report_limit(*trajectory_);
        return false;
    }
    bool is_bounded(const Bodies& bodies) {
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
    int until_check_ = check_interval;
};

}  // namespace polhode
