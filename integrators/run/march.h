// The drivers that every step-by-step method shares: a fixed step that meets samples and events exactly, and a
// tolerance-driven one that takes its own steps and looks sideways for the samples.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <concepts>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "integrators/method.h"
#include "motion/finite.h"
#include "motion/systems.h"

namespace polhode {

/// Holds a run to Settings' limits: of steps, of right-hand sides, and of time, at which it looks now and then.
class Budget {
  public:
    explicit Budget(const Settings& settings);

    /// Takes one step; false once the run may not go on: `stop()` then says why. `evaluations`: so far, in this
    /// repetition.
    bool take(long evaluations = 0) {
        if (steps_ >= max_steps_) return refuse_step();
        ++steps_;
        if (goes_on(evaluations)) return true;
        --steps_;
        return false;
    }
    /// The same for work that is no step: another attempt at one, a sample aside.
    bool goes_on(long evaluations = 0) {
        if (evaluations >= max_evaluations_) return refuse_evaluation();
        return --until_look_ > 0 || in_time();
    }
    long steps() const { return steps_; }
    /// The run needs more steps than it may take: `failed` before its first.
    void forbid(Trajectory& trajectory) const;
    /// After take() said no: the run is `failed`, by its limit, with the reason.
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

/// "t = 0.125 s"
std::string moment(double t);

/// Steps that round-off alone accepts are no progress: at their pace the rest would take ten times the limit.
class Pace {
  public:
    /// `steps` have been taken before t = 0.
    Pace(const Settings& settings, double duration, long steps)
        : most_(10 * static_cast<double>(settings.max_steps)), duration_(duration), marked_steps_(steps) {}

    bool keeps(long steps, double t) {
        constexpr long span = 1 << 14;
        if (steps - marked_steps_ < span) return true;
        const double needed = static_cast<double>(span) * (duration_ - t) / (t - marked_time_);
        marked_steps_ = steps, marked_time_ = t;
        return needed <= most_;
    }
    static std::string message(double t) {
        return "no progress at " + moment(t) + ": the tolerance is too small for binary64";
    }

  private:
    double most_, duration_;
    long marked_steps_;
    double marked_time_ = 0;
};

/// Seconds since construction.
class Stopwatch {
  public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Whole steps for one sample interval of length `interval`, none longer than `step` (but for rounding).
long steps_per_sample(double interval, double step);

/// What has gone astray: a number that is not finite, or energy beyond all bounds, with the time; empty where nothing
/// has.
std::string divergence(const Problem& problem, const Sample& sample, double bound);

/// "; the last state, at t = .. s: w = (..) rad/s, q = (..)", in body axes: what follows upon what went wrong.
std::string last_state(const Sample& sample);

/// What a step's implicit equations that are not solved make of a trajectory; `sample`: the last state.
void explain_unsolved(Trajectory& trajectory, const Sample& sample);

/// Appends the sample, or tells that the run has diverged, with the sample before.
bool record(const Problem& problem, const Sample& sample, double bound, Trajectory& trajectory);

Trajectory unsupported(std::string message);

/// A method that goes step by step and holds its own state, made from a problem. A game update is one directly; a
/// scheme for first-order systems is one through SystemStepper. One whose step can fail has `bool failed() const` and
/// `void explain(Trajectory&)`, which gives status and message; it stays where it is after a failure. One that has more
/// to tell at the end has `void report(Trajectory&)`.
template <class S>
concept Stepper = requires(S s, const S c, const Segment& segment, double t, double h) {
    { s.restart() } -> std::same_as<void>;       // back to t = 0
    { s.enter(segment) } -> std::same_as<void>;  // an event: impulses, then other loads
    { s.step(t, h) } -> std::same_as<void>;      // from t to t + h
    { c.sample(t) } -> std::same_as<Sample>;
    { c.finite() } -> std::same_as<bool>;
    { c.rhs_evaluations() } -> std::same_as<long>;  // since restart
};

/// A scheme `step(const System&, double t, double* y, double h)` with `evaluations` per step, on one of the systems.
template <class Scheme, class SystemType>
class SystemStepper {
  public:
    static constexpr int dimension = SystemType::dimension;

    explicit SystemStepper(const Problem& problem) : problem_(&problem), system_(problem) { restart(); }
    void restart() {
        system_.initial(y_);
        steps_ = 0;
    }
    void enter(const Segment& segment) { system_.enter(segment, y_); }
    void step(double t, double h) {
        scheme_.step(system_, t, y_, h);
        ++steps_;
    }
    Sample sample(double t) const { return system_.motion(t, y_); }
    bool finite() const { return all_finite(y_); }
    long rhs_evaluations() const { return steps_ * Scheme::evaluations; }

  private:
    const Problem* problem_;
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
    const auto keep = [&](const Sample& sample) {
        trajectory.samples.push_back(sample);
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
        if (!trajectory.samples.empty()) state = last_state(trajectory.samples.back());
        if constexpr (std::copyable<S>) {
            stepper = *copy, events = events_of_copy;
            for (long n = copied_at; n < reached; ++n) {
                const Interval at = interval(n / per_sample + 1);
                const long i = n % per_sample;
                const Sample before = stepper.sample(at.time(i));
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
            const Sample start = stepper.sample(0);
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
                    const Sample sample = stepper.sample(at.time(i));
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
    const Stopwatch stopwatch;
    for (int repetition = 0; repetition < settings.repetitions; ++repetition) {
        const bool last = repetition + 1 == settings.repetitions;
        if (!run(settings.record && last)) break;
    }
    trajectory.seconds = stopwatch.seconds() / settings.repetitions;
    if (trajectory.status != Status::diverged) trajectory.steps = budget.steps() / settings.repetitions;
    if constexpr (requires { stepper.report(trajectory); }) stepper.report(trajectory);
    if (!settings.record && trajectory.status == Status::ok) {
        const Sample end = stepper.sample(T);
        std::string what = divergence(problem, end, bound);
        if (what.empty())
            keep(end);
        else
            diverge(N * per_sample, std::move(what));
    }
    trajectory.rhs_evaluations = stepper.rhs_evaluations();
    return trajectory;
}

/// march() of a scheme on whichever system the problem was posed as: SchemeOn<SystemType>::type or a plain scheme.
template <template <class> class Scheme>
Trajectory march_system(const Problem& problem, const Settings& settings) {
    return with_system(problem, [&]<class SystemType>() {
        return march<SystemStepper<Scheme<SystemType>, SystemType>>(problem, settings);
    });
}

/// What became of an attempted step of a tolerance-driven stepper.
enum class Attempt { accepted, rejected, not_finite };

/// A stepper that chooses its own steps. attempt() tries one of size h from t; accepted: t and the state have moved,
/// h is the next size; otherwise t and the state are as before and h is smaller. Copies go on independently.
template <class S>
concept ControlledStepper = std::copyable<S> && requires(S s, const S c, const Segment& segment, double& t, double& h) {
    { s.restart() } -> std::same_as<void>;
    { s.enter(segment) } -> std::same_as<void>;
    { s.first_step(t) } -> std::same_as<double>;  // a guess at t, after enter()
    { s.attempt(t, h) } -> std::same_as<Attempt>;
    { c.sample(t) } -> std::same_as<Sample>;
    { c.rhs_evaluations() } -> std::same_as<long>;
};

/// Tolerance-driven steps, cut only at events and at the end. A sample inside a step is reached sideways: a copy of
/// the stepper as it was at the step's start goes there by itself. So the steps do not depend on the sampling.
///
/// One that solves implicit equations has `long newton_failures() const`, since restart(): the attempts that ended as
/// rejected because they did not converge.
template <ControlledStepper S>
Trajectory march_controlled(const Problem& problem, const Settings& settings, S stepper) {
    constexpr int attempts_per_step = 1000;
    constexpr long between_looks = 16;  // steps, at the energy
    Trajectory trajectory;
    const double T = problem.scene.duration, bound = energy_bound(problem);
    long rejected = 0;
    Budget budget(settings);
    const auto fail = [&](Status status, std::string message) {
        trajectory.status = status, trajectory.message = std::move(message);
        return false;
    };
    // goes from t to at most `stop` by one accepted step; false: the run has ended
    const auto advance = [&](S& s, double& t, double& h, double stop) {
        for (int i = 0; i < attempts_per_step; ++i) {
            if (!budget.goes_on(s.rhs_evaluations())) {
                budget.stop(trajectory);
                return false;
            }
            const double left = stop - t;
            // a remainder of a few rounding errors joins the step
            const bool last = h >= left * (1 - 1e-14);
            // what t + h really moves by: else the rounding of t adds up to 1e-14 of it in 3000 steps
            const double moved = (t + h) - t;
            double size = last ? left : moved > 0 ? moved : h;
            const double begin = t, tried = size;
            const Attempt outcome = s.attempt(t, size);
            if (outcome == Attempt::accepted) {
                if (last) t = stop;
                h = last && size < h && tried < h ? h : size;
                return true;
            }
            if (&s == &stepper) ++rejected;
            h = size;
            if (!(h > 0) || begin + h == begin) {
                if (outcome == Attempt::not_finite)
                    return fail(Status::diverged,
                                "not finite however small the step, at " + moment(t) + last_state(s.sample(t)));
                return fail(Status::tolerance_not_met, "step size below the spacing of numbers at " + moment(t) +
                                                           ": the tolerance is too small for binary64");
            }
        }
        return fail(Status::tolerance_not_met,
                    std::to_string(attempts_per_step) + " rejected attempts at one step, at " + moment(t));
    };
    const auto run = [&](bool recording) {
        stepper.restart();
        rejected = 0;
        long until_look = between_looks;
        Pace pace(settings, T, budget.steps());
        SampleQueue samples = recording ? SampleQueue(T, settings.samples) : SampleQueue();
        double t = 0, h = 0;
        const auto enter = [&](const Segment& segment) {
            stepper.enter(segment);
            t = segment.begin, h = segment.end > t ? stepper.first_step(t) : 0;
            return true;
        };
        const auto show = [&](double at) { return record(problem, stepper.sample(at), bound, trajectory); };
        return follow(problem.segments, samples, enter, show, [&](const Segment& segment) {
            while (t < segment.end) {
                if (!budget.take(stepper.rhs_evaluations())) {
                    budget.stop(trajectory);
                    return false;
                }
                const bool looking = samples.front() <= t + h * 1.0000001;
                std::optional<S> before;
                if (looking) before = stepper;
                double from = t, side_step = h;
                if (!advance(stepper, t, h, segment.end)) return false;
                if (!pace.keeps(budget.steps(), t)) return fail(Status::tolerance_not_met, Pace::message(t));
                if (--until_look == 0) {
                    until_look = between_looks;
                    const Sample sample = stepper.sample(t);
                    if (std::string what = divergence(problem, sample, bound); !what.empty())
                        return fail(Status::diverged, what + last_state(sample));
                }
                for (; samples.due(segment, t); samples.pop()) {
                    const double at = samples.front();
                    if (at == t) {
                        if (!show(t)) return false;
                    } else {
                        if (!before) return fail(Status::failed, "a sample was passed unseen");
                        while (from < at)
                            if (!advance(*before, from, side_step, at)) return false;
                        if (!record(problem, before->sample(at), bound, trajectory)) return false;
                    }
                }
            }
            return true;
        });
    };
    const Stopwatch stopwatch;
    for (int repetition = 0; repetition < settings.repetitions; ++repetition) {
        const bool last = repetition + 1 == settings.repetitions;
        if (!run(settings.record && last)) break;
    }
    trajectory.seconds = stopwatch.seconds() / settings.repetitions;
    trajectory.steps = budget.steps() / settings.repetitions;
    trajectory.rhs_evaluations = stepper.rhs_evaluations();
    trajectory.counts.rejected_steps = rejected;
    if constexpr (requires { stepper.newton_failures(); }) {
        trajectory.counts.newton_failures = stepper.newton_failures();
        trajectory.counts.rejected_steps = rejected - stepper.newton_failures();
    }
    if (!settings.record && trajectory.status == Status::ok) record(problem, stepper.sample(T), bound, trajectory);
    return trajectory;
}

}  // namespace polhode
