// Driver of fixed-step methods. It meets samples and events exactly.
//
// SampleIntervals divides the run into sample intervals with whole steps. march() advances a Stepper through them, cuts
// steps at events, enforces the limits (Budget) and detects divergence. SystemStepper makes a Stepper of a one-step
// scheme for first-order systems; march_system() runs such a scheme on the posed system.
#pragma once

#include <algorithm>
#include <concepts>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "integrators/run/watch.h"
#include "motion/finite.h"
#include "motion/systems.h"

namespace polhode {

/// Number of whole steps in a sample interval of length `interval`, s. No step exceeds `step`, s, except by rounding.
long steps_per_sample(double interval, double step);

/// The intervals between the samples of a fixed-step run, each divided into whole steps.
class SampleIntervals {
  public:
    /// Takes the samples from the problem and the settings, and the step from the settings.
    SampleIntervals(const Problem& problem, const Settings& settings);

    /// The interval between two samples. Step i goes from time(i) to time(i + 1), s.
    struct Interval {
        double begin;  ///< s
        double end;    ///< s
        double h;      ///< s, up to rounding
        long steps;    ///< at least 1
        bool sampled;  ///< there is a sample at its end

        /// Start of step i, s.
        double time(long i) const { return i == steps ? end : begin + static_cast<double>(i) * h; }
    };

    /// Number of intervals.
    long count() const { return count_; }
    /// The k-th interval, 0 <= k < count().
    Interval operator[](long k) const;
    /// True if there is a sample at t = 0.
    bool begins_with_sample() const { return times_.empty() || times_.front() == 0; }
    /// Longest step, s, up to rounding.
    double longest_step() const { return longest_step_; }
    /// Total number of steps, or the largest long if there are more.
    long steps() const { return steps_; }

  private:
    double duration_, step_, longest_step_ = 0;
    std::span<const double> times_;
    long count_, per_sample_ = 0, steps_ = 0;
};

/// Longest step of march(), s.
inline double longest_step(const Problem& problem, const Settings& settings) {
    return SampleIntervals(problem, settings).longest_step();
}

/// A method that advances by given steps, owns its state and is constructed from a problem. Game updates are Steppers;
/// schemes for first-order systems become Steppers through SystemStepper. Optional members:
/// - `bool failed() const` and `void explain(Trajectory&)`, if a step can fail. explain() sets status and message. The
///   state stays unchanged after a failure.
/// - `void report(Trajectory&)` adds information at the end of the run.
/// - `long sample_evaluations() const`, if sample() evaluates right-hand sides: their number since restart, which
///   rhs_evaluations() does not include.
template <class S>
concept Stepper = requires(S s, const S c, const Segment& segment, double t, double h) {
    { s.restart() } -> std::same_as<void>;       // returns to t = 0
    { s.enter(segment) } -> std::same_as<void>;  // an event: impulses, then the loads from here on
    { s.step(t, h) } -> std::same_as<void>;      // advances from t to t + h
    { c.sample(t) } -> std::convertible_to<Bodies>;
    { c.finite() } -> std::same_as<bool>;
    { c.rhs_evaluations() } -> std::same_as<long>;  // since restart
};

/// Applies a scheme `step(const System&, double t, double* y, double h)` with `evaluations` per step to a system.
template <class Scheme, class SystemType>
class SystemStepper {
  public:
    static constexpr int dimension = SystemType::dimension;  ///< number of state variables

    /// Starts at t = 0. The problem must outlive this object.
    explicit SystemStepper(const Problem& problem) : system_(problem) { restart(); }
    /// Returns to t = 0.
    void restart() {
        system_.initial(y_);
        steps_ = 0;
    }
    /// Processes the event that starts the segment: impulses, then the loads from here on.
    void enter(const Segment& segment) { system_.enter(segment, y_); }
    /// One step from t to t + h, s.
    void step(double t, double h) {
        scheme_.step(system_, t, y_, h);
        ++steps_;
    }
    /// The motion at t, s, which must be the current time.
    Sample sample(double t) const { return system_.motion(t, y_); }
    /// True if the state has no infinities or NaN.
    bool finite() const { return all_finite(y_); }
    /// Number of right-hand-side evaluations since restart().
    long rhs_evaluations() const { return steps_ * Scheme::evaluations; }

  private:
    SystemType system_;
    Scheme scheme_{};
    alignas(32) double y_[dimension];
    long steps_ = 0;
};

/// Runs fixed steps. Whole steps meet every sample time; an event inside a step cuts it in two. The steps do not depend
/// on Settings::record. `options` are passed to the stepper's constructor after the problem.
///
/// Divergence is tested at each sample time and at least every `longest_stretch` steps. When it is found, the steps
/// since the last copy of the stepper are repeated one at a time to identify the step that diverged. A stepper that
/// cannot be copied is tested after each step.
template <Stepper S, class... Options>
requires std::constructible_from<S, const Problem&, const Options&...> Trajectory march(const Problem& problem,
                                                                                        const Settings& settings,
                                                                                        const Options&... options) {
    constexpr long longest_stretch = 1024, between_copies = 64;
    Trajectory trajectory;
    const SampleIntervals intervals(problem, settings);
    using Interval = SampleIntervals::Interval;
    const double bound = energy_bound(problem);
    trajectory.step = intervals.longest_step();
    Budget budget(settings);
    // the number of steps is known beforehand: a run that cannot end within its limit is not started
    if (intervals.steps() > settings.max_steps) {
        budget.forbid(trajectory);
        return trajectory;
    }
    S stepper(problem, options...);
    EventQueue<Segment> events(problem.segments);
    const auto failed = [&] {
        if constexpr (requires { stepper.failed(); }) return stepper.failed();
        return false;
    };
    const auto pass_events = [&](double t) {
        while (events.due(t)) stepper.enter(events.pop());
    };
    const auto take_step = [&](const Interval& at, long i) {
        double t = at.time(i);
        const double stop = at.time(i + 1);
        if (!events.due(stop)) {
            stepper.step(t, at.h);
            return;
        }
        while (events.due(stop)) {
            const double event = events.front();
            if (event > t) stepper.step(t, event - t);
            t = event;
            pass_events(event);
        }
        if (stop > t) stepper.step(t, stop - t);
    };
    const auto keep = [&](const Bodies& moment) {
        trajectory.append(moment);
        if constexpr (requires { stepper.orthogonality_defect(); })
            trajectory.orthogonality_defect.push_back(stepper.orthogonality_defect());
    };
    struct Nothing {};
    std::conditional_t<std::copyable<S>, std::optional<S>, Nothing> copy;
    long copied_at = 0, copied_interval = 0, copied_step = 0;  // steps before the copy, and its position
    EventQueue<Segment> events_of_copy = events;
    // The motion diverged within the first `reached` steps of this repetition. Finds the step and counts up to it.
    const auto diverge = [&](long reached, std::string what) {
        trajectory.steps = reached;
        std::string state;
        if (!trajectory.samples.empty()) state = last_state(trajectory.at(trajectory.moments() - 1));
        if constexpr (std::copyable<S>) {
            stepper = *copy, events = events_of_copy;
            long k = copied_interval, i = copied_step;
            Interval at = intervals[k];
            for (long n = copied_at; n < reached; ++n, ++i) {
                if (i == at.steps) at = intervals[++k], i = 0;
                const auto before = stepper.sample(at.time(i));
                take_step(at, i);
                const std::string here = divergence(problem, stepper.sample(at.time(i + 1)), bound);
                if (here.empty() && stepper.finite()) continue;
                if (!here.empty()) what = here;
                state = last_state(before), trajectory.steps = n + 1;
                break;
            }
        }
        trajectory.status = Status::diverged, trajectory.message = what + state;
        return false;
    };
    // returns false if the run ended early
    const auto run = [&](bool recording) {
        stepper.restart();
        events = EventQueue<Segment>(problem.segments);
        pass_events(0);
        if (recording && intervals.begins_with_sample()) {
            const auto start = stepper.sample(0);
            if (std::string what = divergence(problem, start, bound); !what.empty()) {
                trajectory.status = Status::diverged, trajectory.message = std::move(what);
                return false;
            }
            keep(start);
        }
        copied_at = -between_copies;
        long done = 0;
        for (long k = 0; k < intervals.count(); ++k) {
            const Interval at = intervals[k];
            for (long first = 0; first < at.steps;) {
                const long last = std::min(first + longest_stretch, at.steps);
                if constexpr (std::copyable<S>)
                    if (done - copied_at >= between_copies) {
                        copy = stepper, events_of_copy = events;
                        copied_at = done, copied_interval = k, copied_step = first;
                    }
                long i = first;
                for (bool going = true; i < last && going; ++i) {
                    if (!budget.take(stepper.rhs_evaluations())) {
                        budget.stop(trajectory);
                        return false;
                    }
                    take_step(at, i);
                    going = !failed();
                    if constexpr (!std::copyable<S>) going = going && stepper.finite();
                }
                if (failed()) {
                    if constexpr (requires { stepper.explain(trajectory); }) stepper.explain(trajectory);
                    return false;
                }
                const bool sampled = recording && at.sampled && i == at.steps;
                if (!stepper.finite() || sampled || i - first == longest_stretch) {
                    const auto sample = stepper.sample(at.time(i));
                    std::string what = divergence(problem, sample, bound);
                    if (what.empty() && !stepper.finite()) what = "not finite at " + moment(at.time(i));
                    if (!what.empty()) return diverge(done + i - first, std::move(what));
                    if (sampled) keep(sample);
                }
                done += i - first, first = i;
            }
        }
        return true;
    };
    repeat(settings, trajectory, run);
    if (trajectory.status != Status::diverged) trajectory.steps = budget.steps() / settings.repetitions;
    if constexpr (requires { stepper.report(trajectory); }) stepper.report(trajectory);
    if (!settings.record && trajectory.status == Status::ok) {
        const auto end = stepper.sample(problem.scene.duration);
        std::string what = divergence(problem, end, bound);
        if (what.empty())
            keep(end);
        else
            diverge(intervals.steps(), std::move(what));
    }
    if constexpr (requires { stepper.sample_evaluations(); })
        trajectory.sample_evaluations = stepper.sample_evaluations();
    trajectory.rhs_evaluations = stepper.rhs_evaluations() + trajectory.sample_evaluations;
    return trajectory;
}

/// Solves a problem by fixed steps of Scheme<SystemType>, for whichever system was posed. Requirements on a scheme: see
/// SystemStepper. Exceptions and status: see solve().
template <template <class> class Scheme>
Trajectory march_system(const Problem& problem, const Settings& settings) {
    return with_one_body(problem, [&]<class SystemType>() {
        return march<SystemStepper<Scheme<SystemType>, SystemType>>(problem, settings);
    });
}

}  // namespace polhode
