// Driver of steppers that choose their own steps by a tolerance. Samples lie inside steps and do not cut them.
#pragma once

#include <concepts>
#include <optional>
#include <string>

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
    constexpr int attempts_per_step = 1000;
    Trajectory trajectory;
    const double T = problem.scene.duration;
    constexpr bool has_dense_output = requires { stepper.sample_inside(T); };
    long rejected = 0, beside = 0;  // `beside`: evaluations of copies
    Watch watch(problem, settings, trajectory);
    const auto sampling = [](const S& s) {
        if constexpr (requires { s.sample_evaluations(); }) return s.sample_evaluations();
        return 0L;
    };
    const auto sample_evaluations = [&] { return beside + sampling(stepper); };
    // advances from t to at most `stop` by one accepted step; returns false if the run has ended
    const auto advance = [&](S& s, double& t, double& h, double stop) {
        for (int i = 0; i < attempts_per_step; ++i) {
            if (!watch.may_attempt(s.rhs_evaluations() + sample_evaluations())) return false;
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
            if (&s == &stepper) ++rejected;
            h = size;
            if (!(h > 0) || begin + h == begin) {
                if (outcome == Attempt::not_finite)
                    return watch.fail(Status::diverged,
                                      "not finite at any step size, at " + format_time(t) + last_state(s.sample(t)));
                return watch.fail(Status::tolerance_not_met, "step size below the spacing of numbers at " +
                                                                 format_time(t) +
                                                                 ": the tolerance is too small for binary64");
            }
        }
        return watch.fail(Status::tolerance_not_met,
                          std::to_string(attempts_per_step) + " rejected attempts at one step, at " + format_time(t));
    };
    const auto run = [&](bool recording) {
        stepper.restart();
        rejected = beside = 0;
        watch.restart();
        SampleQueue samples = recording ? sample_queue(problem, settings) : SampleQueue();
        double t = 0, h = 0;
        const auto enter = [&](const Segment& segment) {
            stepper.enter(segment);
            t = segment.begin, h = segment.end > t ? stepper.first_step(t) : 0;
            return true;
        };
        const auto show = [&](double at) { return watch.record(stepper.sample(at)); };
        return follow(problem.segments, samples, enter, show, [&](const Segment& segment) {
            while (t < segment.end) {
                if (!watch.may_step(stepper.rhs_evaluations() + sample_evaluations())) return false;
                const bool looking = !has_dense_output && samples.front() <= t + h * 1.0000001;
                std::optional<S> before;
                if (looking) before = stepper;
                double from = t, side_step = h;
                if (!advance(stepper, t, h, segment.end)) return false;
                if (!watch.makes_progress(t)) return false;
                for (; samples.due(segment, t); samples.pop()) {
                    const double at = samples.front();
                    if (at == t) {
                        if (!show(t)) return false;
                        continue;
                    }
                    if constexpr (has_dense_output) {
                        if (!watch.record(stepper.sample_inside(at))) return false;
                    } else {
                        if (!before) return watch.fail(Status::failed, "internal error: a sample time was skipped");
                        const auto evaluations = [&] { return before->rhs_evaluations() + sampling(*before); };
                        const long counted = evaluations();
                        while (from < at)
                            if (!advance(*before, from, side_step, at)) return false;
                        const auto inside = before->sample(at);
                        beside += evaluations() - counted;
                        if (!watch.record(inside)) return false;
                    }
                }
                if (!watch.stays_bounded([&] { return stepper.sample(t); })) return false;
            }
            return true;
        });
    };
    repeat(settings, trajectory, run);
    trajectory.steps = watch.steps() / settings.repetitions;
    trajectory.counts.rejected_steps = rejected;
    if constexpr (requires { stepper.newton_failures(); }) {
        trajectory.counts.newton_failures = stepper.newton_failures();
        trajectory.counts.rejected_steps = rejected - stepper.newton_failures();
    }
    if (!settings.record && trajectory.status == Status::ok) watch.record(stepper.sample(T));
    trajectory.sample_evaluations = sample_evaluations();
    trajectory.rhs_evaluations = stepper.rhs_evaluations() + trajectory.sample_evaluations;
    return trajectory;
}

}  // namespace polhode
