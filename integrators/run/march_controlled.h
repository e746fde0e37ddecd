// Driver of steppers that choose their own steps by a tolerance. Samples lie inside steps and do not cut them.
#pragma once

#include <concepts>
#include <optional>
#include <string>
#include <utility>

#include "integrators/run/watch.h"

namespace polhode {

/// Result of an attempted step of a tolerance-driven stepper.
enum class Attempt { accepted, rejected, not_finite };

/// A stepper that chooses its own steps. attempt() tries a step h from t. If it is accepted, t and the state have
/// advanced and h is the next step; otherwise t and the state are unchanged and h is smaller. Copies are independent.
template <class S>
concept ControlledStepper = std::copyable<S> && requires(S s, const S c, const Segment& segment, double& t, double& h) {
    { s.restart() } -> std::same_as<void>;
    { s.enter(segment) } -> std::same_as<void>;
    { s.first_step(t) } -> std::same_as<double>;  // estimate at t, after enter()
    { s.attempt(t, h) } -> std::same_as<Attempt>;
    { c.sample(t) } -> std::convertible_to<Bodies>;
    { c.rhs_evaluations() } -> std::same_as<long>;
};

/// One run of march_controlled(): the stepper, its time and next step size, and the samples still to come.
template <ControlledStepper S>
class ControlledRun {
  public:
    /// References must outlive this object.
    ControlledRun(const Problem& problem, const Settings& settings, S stepper, Trajectory& trajectory)
        : problem_(problem),
          settings_(settings),
          stepper_(std::move(stepper)),
          trajectory_(trajectory),
          watch_(problem, settings, trajectory) {}

    /// Runs all repetitions and sets the trajectory.
    void run() {
        repeat(settings_, trajectory_, [&](bool recording) { return run_once(recording); });
        trajectory_.steps = watch_.steps() / settings_.repetitions;
        trajectory_.counts.rejected_steps = rejected_;
        if constexpr (requires { stepper_.newton_failures(); }) {
            trajectory_.counts.newton_failures = stepper_.newton_failures();
            trajectory_.counts.rejected_steps = rejected_ - stepper_.newton_failures();
        }
        if (!settings_.record && trajectory_.status == Status::ok)
            watch_.record(stepper_.sample(problem_.scene.duration));
        trajectory_.sample_evaluations = sample_evaluations();
        trajectory_.rhs_evaluations = stepper_.rhs_evaluations() + trajectory_.sample_evaluations;
    }

  private:
    static constexpr int attempts_per_step = 1000;
    static constexpr bool has_dense_output = requires(S s, double t) { s.sample_inside(t); };

    const Problem& problem_;
    const Settings& settings_;
    S stepper_;
    Trajectory& trajectory_;
    Watch watch_;
    SampleQueue samples_;
    double t_ = 0, h_ = 0;                           // s; h_: the next step
    long rejected_ = 0, evaluations_of_copies_ = 0;  // in this repetition

    static long sample_evaluations_of(const S& s) {
        if constexpr (requires { s.sample_evaluations(); }) return s.sample_evaluations();
        return 0;
    }
    long sample_evaluations() const { return evaluations_of_copies_ + sample_evaluations_of(stepper_); }

    // One repetition; returns false if the run has ended.
    bool run_once(bool recording) {
        stepper_.restart();
        rejected_ = evaluations_of_copies_ = 0;
        watch_.restart();
        samples_ = recording ? sample_queue(problem_, settings_) : SampleQueue();
        t_ = 0, h_ = 0;
        const auto enter = [&](const Segment& segment) {
            stepper_.enter(segment);
            t_ = segment.begin, h_ = segment.end > t_ ? stepper_.first_step(t_) : 0;
            return true;
        };
        const auto show = [&](double at) { return watch_.record(stepper_.sample(at)); };
        return follow(problem_.segments, samples_, enter, show,
                      [&](const Segment& segment) { return run_segment(segment); });
    }

    // Steps to the end of the segment; returns false if the run has ended.
    bool run_segment(const Segment& segment) {
        while (t_ < segment.end) {
            if (!watch_.may_step(stepper_.rhs_evaluations() + sample_evaluations())) return false;
            const bool needs_copy = !has_dense_output && samples_.front() <= t_ + h_ * 1.0000001;
            std::optional<S> before;
            if (needs_copy) before = stepper_;
            const double begin = t_, size = h_;
            if (!advance(stepper_, t_, h_, segment.end)) return false;
            if (!watch_.makes_progress(t_)) return false;
            if (!record_samples(segment, before, begin, size)) return false;
            if (!watch_.stays_bounded([&] { return stepper_.sample(t_); })) return false;
        }
        return true;
    }

    // Advances from t to at most `stop` by one accepted step; returns false if the run has ended.
    bool advance(S& s, double& t, double& h, double stop) {
        for (int i = 0; i < attempts_per_step; ++i) {
            if (!watch_.may_attempt(s.rhs_evaluations() + sample_evaluations())) return false;
            const double left = stop - t;
            // a remainder of a few rounding errors is added to the step
            const bool last = h >= left * (1 - 1e-14);
            // the actual increment of t + h; otherwise the rounding of t adds up to 1e-14 of t in 3000 steps
            const double moved = (t + h) - t;
            double size = last ? left : moved > 0 ? moved : h;
            const double begin = t, tried = size;
            const Attempt outcome = s.attempt(t, size);
            if (outcome == Attempt::accepted) {
                if (last) t = stop;
                h = last && size < h && tried < h ? h : size;
                return true;
            }
            if (&s == &stepper_) ++rejected_;
            h = size;
            if (!(h > 0) || begin + h == begin) return fail_at_smallest_step(s, t, outcome);
        }
        return watch_.fail(Status::tolerance_not_met,
                           std::to_string(attempts_per_step) + " rejected attempts at one step, at " + format_time(t));
    }
    bool fail_at_smallest_step(const S& s, double t, Attempt outcome) {
        if (outcome == Attempt::not_finite)
            return watch_.fail(Status::diverged,
                               "not finite at any step size, at " + format_time(t) + last_state(s.sample(t)));
        return watch_.fail(Status::tolerance_not_met, "step size below the spacing of numbers at " + format_time(t) +
                                                          ": the tolerance is too small for binary64");
    }

    // Records the samples due in the last step. `before`: a copy of the stepper at the start of the step, at time
    // `from` and with step size h; none if the step contains no sample or the stepper has dense output.
    bool record_samples(const Segment& segment, std::optional<S>& before, double from, double h) {
        for (; samples_.due(segment, t_); samples_.pop()) {
            const double at = samples_.front();
            if (at == t_) {
                if (!watch_.record(stepper_.sample(t_))) return false;
                continue;
            }
            if constexpr (has_dense_output) {
                if (!watch_.record(stepper_.sample_inside(at))) return false;
            } else {
                if (!before) return watch_.fail(Status::failed, "internal error: a sample time was skipped");
                const auto evaluations = [&] { return before->rhs_evaluations() + sample_evaluations_of(*before); };
                const long counted = evaluations();
                while (from < at)
                    if (!advance(*before, from, h, at)) return false;
                const auto inside = before->sample(at);
                evaluations_of_copies_ += evaluations() - counted;
                if (!watch_.record(inside)) return false;
            }
        }
        return true;
    }
};

/// Runs tolerance-driven steps. They are cut only at events and at the end, so that they do not depend on the samples.
/// A stepper with dense output has `sample_inside(t)`, the motion at a time inside the last accepted step. For any
/// other stepper, a copy made at the start of the step integrates to the sample; its evaluations are counted as sample
/// evaluations. Optional members:
/// - `long sample_evaluations() const`, if samples cost evaluations: their number since restart(), which
///   rhs_evaluations() does not include.
/// - `long newton_failures() const`, if implicit equations are solved: the number of attempts since restart() that were
///   rejected because Newton's iteration did not converge.
template <ControlledStepper S>
Trajectory march_controlled(const Problem& problem, const Settings& settings, S stepper) {
    Trajectory trajectory;
    ControlledRun<S>(problem, settings, std::move(stepper), trajectory).run();
    return trajectory;
}

}  // namespace polhode
