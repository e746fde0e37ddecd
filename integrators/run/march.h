// The driver of methods that go by a fixed step: it meets samples and events exactly.
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

/// How many whole steps fit into one sample interval of length `interval` (s), none of them longer than `step` (s) but
/// for rounding.
long steps_per_sample(double interval, double step);

/// The intervals between the samples of a run by a fixed step, each covered by whole steps.
class SampleIntervals {
  public:
    /// The problem's and the settings' samples, with the settings' step.
    SampleIntervals(const Problem& problem, const Settings& settings);

    /// From one sample to the next: step i goes from time(i) to time(i + 1), s.
    struct Interval {
        double begin;  ///< s
        double end;    ///< s
        double h;      ///< s, but for rounding
        long steps;    ///< at least one
        bool sampled;  ///< at its end

        /// Where step i begins, s.
        double time(long i) const { return i == steps ? end : begin + static_cast<double>(i) * h; }
    };

    /// How many there are.
    long count() const { return count_; }
    /// The k-th, 0 <= k < count().
    Interval operator[](long k) const;
    /// Whether there is a sample at t = 0.
    bool begins_with_sample() const { return times_.empty() || times_.front() == 0; }
    /// The longest step (s), but for rounding.
    double longest_step() const { return longest_step_; }
    /// The steps of all, or the largest long where they are more.
    long steps() const { return steps_; }

  private:
    double duration_, step_, longest_step_ = 0;
    std::span<const double> times_;
    long count_, per_sample_ = 0, steps_ = 0;
};

/// The longest step (s) that march() takes.
inline double longest_step(const Problem& problem, const Settings& settings) {
    return SampleIntervals(problem, settings).longest_step();
}

/// A method that goes step by step and holds its own state, made from a problem. A game update is one directly; a
/// scheme for first-order systems is one through SystemStepper. One whose step can fail has `bool failed() const` and
/// `void explain(Trajectory&)`, which gives status and message; it stays where it is after a failure. One that has more
/// to tell at the end has `void report(Trajectory&)`. One whose sample() evaluates right-hand sides has
/// `long sample_evaluations() const`, since restart; rhs_evaluations() does not include them.
template <class S>
concept Stepper = requires(S s, const S c, const Segment& segment, double t, double h) {
    { s.restart() } -> std::same_as<void>;       // back to t = 0
    { s.enter(segment) } -> std::same_as<void>;  // an event: impulses, then other loads
    { s.step(t, h) } -> std::same_as<void>;      // from t to t + h
    { c.sample(t) } -> std::convertible_to<Bodies>;
    { c.finite() } -> std::same_as<bool>;
    { c.rhs_evaluations() } -> std::same_as<long>;  // since restart
};

/// A scheme `step(const System&, double t, double* y, double h)` with `evaluations` per step, on one of the systems.
template <class Scheme, class SystemType>
class SystemStepper {
  public:
    static constexpr int dimension = SystemType::dimension;  ///< components of the state

    /// At t = 0. The problem must outlive it.
    explicit SystemStepper(const Problem& problem) : system_(problem) { restart(); }
    /// Goes back to t = 0.
    void restart() {
        system_.initial(y_);
        steps_ = 0;
    }
    /// Meets the event that opens the segment: impulses, then other loads.
    void enter(const Segment& segment) { system_.enter(segment, y_); }
    /// One step from t to t + h (s).
    void step(double t, double h) {
        scheme_.step(system_, t, y_, h);
        ++steps_;
    }
    /// The motion at t (s), which is where the steps have come to.
    Sample sample(double t) const { return system_.motion(t, y_); }
    /// Whether the state has neither infinities nor NaN.
    bool finite() const { return all_finite(y_); }
    /// Right-hand sides since restart().
    long rhs_evaluations() const { return steps_ * Scheme::evaluations; }

  private:
    SystemType system_;
    Scheme scheme_{};
    alignas(32) double y_[dimension];
    long steps_ = 0;
};

/// Fixed steps. Every sample time is met by whole steps; an event inside a step cuts it in two. The steps do not
/// depend on Settings::record. `options` are what the stepper is made from beside the problem.
///
/// Whether the motion has diverged is asked at each sample time, and between them after `longest_stretch` steps; the
/// steps since a copy was made are then repeated from it, one at a time, to name the one that led astray. A stepper
/// that cannot be copied is asked at each step.
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
    // the number of steps is known beforehand: a run that cannot end within its limit is not begun
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
    long copied_at = 0, copied_interval = 0, copied_step = 0;  // steps before it, in this repetition; and its place
    EventQueue<Segment> events_of_copy = events;
    // in the first `reached` steps of this repetition the motion has diverged: in which? That is the last one counted.
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
    // false when the run ended early
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

/// Solves a problem by fixed steps of Scheme<SystemType>, on whichever system it was posed as. What a scheme must have
/// is said at SystemStepper; what is thrown and returned, at solve().
template <template <class> class Scheme>
Trajectory march_system(const Problem& problem, const Settings& settings) {
    return with_one_body(problem, [&]<class SystemType>() {
        return march<SystemStepper<Scheme<SystemType>, SystemType>>(problem, settings);
    });
}

}  // namespace polhode
