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
    bool has_initial_sample() const { return times_.empty() || times_.front() == 0; }
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

/// One run of march(): advances the stepper through the sample intervals.
template <Stepper S>
class FixedStepRun {
  public:
    /// The arguments must outlive this object.
    FixedStepRun(const Problem& problem, const Settings& settings, const SampleIntervals& intervals, Budget& budget,
                 S& stepper)
        : problem_(problem),
          settings_(settings),
          intervals_(intervals),
          budget_(budget),
          stepper_(stepper),
          bound_(energy_bound(problem)),
          events_(problem.segments),
          copy_{{}, events_} {
        trajectory_.step = intervals.longest_step();
    }
    FixedStepRun(const FixedStepRun&) = delete;
    FixedStepRun& operator=(const FixedStepRun&) = delete;

    /// Runs all repetitions.
    Trajectory solve() {
        repeat(settings_, trajectory_, [&](bool recording) { return run(recording); });
        if (trajectory_.status != Status::diverged) trajectory_.steps = budget_.steps() / settings_.repetitions;
        if constexpr (requires { stepper_.report(trajectory_); }) stepper_.report(trajectory_);
        if (!settings_.record && trajectory_.status == Status::ok) store_end();
        if constexpr (requires { stepper_.sample_evaluations(); })
            trajectory_.sample_evaluations = stepper_.sample_evaluations();
        trajectory_.rhs_evaluations = stepper_.rhs_evaluations() + trajectory_.sample_evaluations;
        return std::move(trajectory_);
    }

  private:
    using Interval = SampleIntervals::Interval;
    // steps between two tests of divergence, at most, and between two copies of the stepper, at least
    static constexpr long max_stretch = 1024, copy_interval = 64;

    /// A copy of the stepper, if it can be copied, and its position.
    struct Copy {
        struct Nothing {};
        std::conditional_t<std::copyable<S>, std::optional<S>, Nothing> stepper;
        EventQueue<Segment> events;
        long steps = 0;               ///< number of steps before the copy
        long interval = 0, step = 0;  ///< position of the next step
    };

    /// One repetition. Returns false if it ended early.
    bool run(bool recording) {
        stepper_.restart();
        events_ = EventQueue<Segment>(problem_.segments);
        enter_segments(0);
        if (recording && intervals_.has_initial_sample() && !store_start()) return false;
        copy_.steps = -copy_interval;
        done_ = 0;
        for (long k = 0; k < intervals_.count(); ++k)
            if (!cross_interval(k, recording)) return false;
        return true;
    }
    /// Takes all steps of the k-th interval. Returns false if the run ended early.
    bool cross_interval(long k, bool recording) {
        const Interval at = intervals_[k];
        for (long first = 0; first < at.steps;) {
            const long last = std::min(first + max_stretch, at.steps);
            if constexpr (std::copyable<S>)
                if (done_ - copy_.steps >= copy_interval) {
                    copy_.stepper = stepper_, copy_.events = events_;
                    copy_.steps = done_, copy_.interval = k, copy_.step = first;
                }
            long i = first;
            for (bool going = true; i < last && going; ++i) {
                if (!budget_.count_step(stepper_.rhs_evaluations())) {
                    budget_.report_limit(trajectory_);
                    return false;
                }
                take_step(at, i);
                going = !failed();
                if constexpr (!std::copyable<S>) going = going && stepper_.finite();
            }
            if (failed()) {
                if constexpr (requires { stepper_.explain(trajectory_); }) stepper_.explain(trajectory_);
                return false;
            }
            if (!check_stretch(at, first, i, recording)) return false;
            done_ += i - first, first = i;
        }
        return true;
    }
    /// Tests for divergence after the steps [first, i) and stores a sample if there is one. Returns false if the motion
    /// has diverged.
    bool check_stretch(const Interval& at, long first, long i, bool recording) {
        const bool sampled = recording && at.sampled && i == at.steps;
        if (stepper_.finite() && !sampled && i - first != max_stretch) return true;
        const auto sample = stepper_.sample(at.time(i));
        std::string what = divergence(problem_, sample, bound_);
        if (what.empty() && !stepper_.finite()) what = "not finite at " + format_time(at.time(i));
        if (!what.empty()) return report_divergence(done_ + i - first, std::move(what));
        if (sampled) store_sample(sample);
        return true;
    }

    /// Takes step i of an interval, cut at events.
    void take_step(const Interval& at, long i) {
        double t = at.time(i);
        const double stop = at.time(i + 1);
        if (!events_.due(stop)) {
            stepper_.step(t, at.h);
            return;
        }
        while (events_.due(stop)) {
            const double event = events_.front();
            if (event > t) stepper_.step(t, event - t);
            t = event;
            enter_segments(event);
        }
        if (stop > t) stepper_.step(t, stop - t);
    }
    void enter_segments(double t) {
        while (events_.due(t)) stepper_.enter(events_.pop());
    }
    bool failed() const {
        if constexpr (requires { stepper_.failed(); }) return stepper_.failed();
        return false;
    }

    /// Stores the sample at t = 0. Returns false if the motion is not valid there.
    bool store_start() {
        const auto start = stepper_.sample(0);
        if (std::string what = divergence(problem_, start, bound_); !what.empty()) {
            trajectory_.status = Status::diverged, trajectory_.message = std::move(what);
            return false;
        }
        store_sample(start);
        return true;
    }
    /// Stores the last sample of a run without recording.
    void store_end() {
        const auto end = stepper_.sample(problem_.scene.duration);
        std::string what = divergence(problem_, end, bound_);
        if (what.empty())
            store_sample(end);
        else
            report_divergence(intervals_.steps(), std::move(what));
    }
    void store_sample(const Bodies& moment) {
        trajectory_.append(moment);
        if constexpr (requires { stepper_.orthogonality_defect(); })
            trajectory_.orthogonality_defect.push_back(stepper_.orthogonality_defect());
    }

    /// The motion diverged within the first `reached` steps of this repetition. Repeats the steps since the copy to
    /// find the step that diverged, and counts up to it. Returns false.
    bool report_divergence(long reached, std::string what) {
        trajectory_.steps = reached;
        std::string state;
        if (!trajectory_.samples.empty()) state = last_state(trajectory_.at(trajectory_.moments() - 1));
        if constexpr (std::copyable<S>) {
            stepper_ = *copy_.stepper, events_ = copy_.events;
            long k = copy_.interval, i = copy_.step;
            Interval at = intervals_[k];
            for (long n = copy_.steps; n < reached; ++n, ++i) {
                if (i == at.steps) at = intervals_[++k], i = 0;
                const auto before = stepper_.sample(at.time(i));
                take_step(at, i);
                const std::string here = divergence(problem_, stepper_.sample(at.time(i + 1)), bound_);
                if (here.empty() && stepper_.finite()) continue;
                if (!here.empty()) what = here;
                state = last_state(before), trajectory_.steps = n + 1;
                break;
            }
        }
        trajectory_.status = Status::diverged, trajectory_.message = what + state;
        return false;
    }

    const Problem& problem_;
    const Settings& settings_;
    const SampleIntervals& intervals_;
    Budget& budget_;
    S& stepper_;
    double bound_;  // J, see energy_bound()
    EventQueue<Segment> events_;
    Copy copy_;
    long done_ = 0;  // steps of this repetition
    Trajectory trajectory_;
};

/// Runs fixed steps. Whole steps meet every sample time; an event inside a step cuts it in two. The steps do not depend
/// on Settings::record. `options` are passed to the stepper's constructor after the problem.
///
/// Divergence is tested at each sample time and at least every 1024 steps. When it is found, the steps
/// since the last copy of the stepper are repeated one at a time to identify the step that diverged. A stepper that
/// cannot be copied is tested after each step.
template <Stepper S, class... Options>
requires std::constructible_from<S, const Problem&, const Options&...> Trajectory march(const Problem& problem,
                                                                                        const Settings& settings,
                                                                                        const Options&... options) {
    const SampleIntervals intervals(problem, settings);
    Budget budget(settings);
    // the number of steps is known beforehand: a run that cannot end within its limit is not started
    if (intervals.steps() > settings.max_steps) {
        Trajectory trajectory;
        trajectory.step = intervals.longest_step();
        budget.report_excess_steps(trajectory);
        return trajectory;
    }
    S stepper(problem, options...);
    return FixedStepRun<S>(problem, settings, intervals, budget, stepper).solve();
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
