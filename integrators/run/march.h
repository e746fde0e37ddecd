// The driver of methods that go by a fixed step: it meets samples and events exactly.
#pragma once

#include <algorithm>
#include <concepts>
#include <optional>
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

/// A method that goes step by step and holds its own state, made from a problem. A game update is one directly; a
/// scheme for first-order systems is one through SystemStepper. One whose step can fail has `bool failed() const` and
/// `void explain(Trajectory&)`, which gives status and message; it stays where it is after a failure. One that has more
/// to tell at the end has `void report(Trajectory&)`.
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
    const double T = problem.scene.duration;
    const long N = settings.samples;
    const long per_sample = steps_per_sample(T / static_cast<double>(N), *settings.step);
    const double bound = energy_bound(problem);
    trajectory.step = T / static_cast<double>(N) / static_cast<double>(per_sample);
    Budget budget(settings);
    // the number of steps is known beforehand: a run that cannot end within its limit is not begun
    if (per_sample > settings.max_steps / N) {
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
    // the steps between two samples: step i goes from time(i) to time(i + 1)
    struct Interval {
        double begin, end, h;
        long steps;
        double time(long i) const { return i == steps ? end : begin + static_cast<double>(i) * h; }
    };
    const auto interval = [&](long k) {
        const double begin = sample_time(T, k - 1, N), end = sample_time(T, k, N);
        return Interval{begin, end, (end - begin) / static_cast<double>(per_sample), per_sample};
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
    long copied_at = 0;  // steps before it, in this repetition
    EventQueue<Segment> events_of_copy = events;
    // in the first `reached` steps of this repetition the motion has diverged: in which? That is the last one counted.
    const auto diverge = [&](long reached, std::string what) {
        trajectory.steps = reached;
        std::string state;
        if (!trajectory.samples.empty()) state = last_state(trajectory.at(trajectory.moments() - 1));
        if constexpr (std::copyable<S>) {
            stepper = *copy, events = events_of_copy;
            for (long n = copied_at; n < reached; ++n) {
                const Interval at = interval(n / per_sample + 1);
                const long i = n % per_sample;
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
        if (recording) {
            const auto start = stepper.sample(0);
            if (std::string what = divergence(problem, start, bound); !what.empty()) {
                trajectory.status = Status::diverged, trajectory.message = std::move(what);
                return false;
            }
            keep(start);
        }
        copied_at = -between_copies;
        for (long k = 1; k <= N; ++k) {
            const Interval at = interval(k);
            for (long first = 0; first < per_sample;) {
                const long done = (k - 1) * per_sample + first, last = std::min(first + longest_stretch, per_sample);
                if constexpr (std::copyable<S>)
                    if (done - copied_at >= between_copies) copy = stepper, copied_at = done, events_of_copy = events;
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
                const bool sampled = recording && i == per_sample;
                if (!stepper.finite() || sampled || i - first == longest_stretch) {
                    const auto sample = stepper.sample(at.time(i));
                    std::string what = divergence(problem, sample, bound);
                    if (what.empty() && !stepper.finite()) what = "not finite at " + moment(at.time(i));
                    if (!what.empty()) return diverge(done + i - first, std::move(what));
                    if (sampled) keep(sample);
                }
                first = i;
            }
        }
        return true;
    };
    repeat(settings, trajectory, run);
    if (trajectory.status != Status::diverged) trajectory.steps = budget.steps() / settings.repetitions;
    if constexpr (requires { stepper.report(trajectory); }) stepper.report(trajectory);
    if (!settings.record && trajectory.status == Status::ok) {
        const auto end = stepper.sample(T);
        std::string what = divergence(problem, end, bound);
        if (what.empty())
            keep(end);
        else
            diverge(N * per_sample, std::move(what));
    }
    trajectory.rhs_evaluations = stepper.rhs_evaluations();
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
