// Driver of steppers that choose their own steps by a tolerance. Samples lie inside steps and do not cut them.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

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

/// A system whose right-hand side switches where one of its switch_values() falls to zero, for the side that
/// cross_switch() selects.
template <class SystemType>
concept SwitchingSystem = requires(SystemType s, double* y, std::size_t which) {
    { s.switch_values(y) } -> std::same_as<std::vector<double>>;
    { s.cross_switch(which, y) } -> std::same_as<std::string>;
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
        trajectory_.rhs_evaluations = stepper_.rhs_evaluations() + trajectory_.sample_evaluations + search_evaluations_;
    }

  private:
    static constexpr int attempts_per_step = 1000;
    static constexpr bool has_dense_output = requires(S s, double t) { s.sample_inside(t); };
    static constexpr bool locates_switches = requires(S s, std::size_t which) {
        s.switch_values();
        s.cross_switch(which);
    };
    struct Crossing {
        double t = std::numeric_limits<double>::infinity();  ///< s; infinite: none
        std::size_t which = 0;                               ///< index of the switch value

        bool exists() const { return t < std::numeric_limits<double>::infinity(); }
    };

    const Problem& problem_;
    const Settings& settings_;
    S stepper_;
    Trajectory& trajectory_;
    Watch watch_;
    SampleQueue samples_;
    double t_ = 0, h_ = 0;                           // s; h_: the next step
    long rejected_ = 0, evaluations_of_copies_ = 0;  // in this repetition
    long search_evaluations_ = 0;                    // of steps that were repeated to locate switches
    long crossings_ = 0;

    static long sample_evaluations_of(const S& s) {
        if constexpr (requires { s.sample_evaluations(); }) return s.sample_evaluations();
        return 0;
    }
    long sample_evaluations() const { return evaluations_of_copies_ + sample_evaluations_of(stepper_); }

    // One repetition; returns false if the run has ended.
    bool run_once(bool recording) {
        stepper_.restart();
        rejected_ = evaluations_of_copies_ = search_evaluations_ = crossings_ = 0;
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
        Crossing crossing;
        while (t_ < segment.end) {
            if (!watch_.may_step(evaluations())) return false;
            const bool needs_copy = locates_switches || (!has_dense_output && samples_.front() <= t_ + h_ * 1.0000001);
            std::optional<S> before;
            if (needs_copy) before = stepper_;
            const double begin = t_, size = h_;
            if (!advance(stepper_, t_, h_, std::min(crossing.t, segment.end))) return false;
            if constexpr (locates_switches) {
                if (!crossing.exists()) {
                    if (!find_crossing(*before, begin, size, crossing)) return false;
                    if (crossing.exists()) {
                        // repeats the step up to the crossing
                        search_evaluations_ += evaluations_of(stepper_) - evaluations_of(*before);
                        stepper_ = *before, t_ = begin, h_ = size;
                        if (crossing.t > begin) continue;
                    }
                }
            }
            if (t_ > begin && !watch_.makes_progress(t_)) return false;
            if (!record_samples(segment, before, begin, size)) return false;
            if (!watch_.stays_bounded([&] { return stepper_.sample(t_); })) return false;
            if constexpr (locates_switches)
                if (t_ == crossing.t && !cross(crossing)) return false;
        }
        return true;
    }
    static long evaluations_of(const S& s) { return s.rhs_evaluations() + sample_evaluations_of(s); }
    long evaluations() const { return stepper_.rhs_evaluations() + sample_evaluations() + search_evaluations_; }

    // Finds the first switch value that is negative after a step from `begin`, at whose start the stepper was `before`
    // with the next step size `size`. Returns false if the run has ended.
    bool find_crossing(const S& before, double begin, double size, Crossing& first) {
        const std::vector<double> from = before.switch_values(), to = stepper_.switch_values();
        for (std::size_t i = 0; i < to.size(); ++i) {
            if (!(to[i] < 0)) continue;
            Crossing found{begin, i};
            // a value that is not positive at the start has been crossed there, up to rounding
            if (from[i] > 0 && !locate(before, begin, size, from[i], to[i], found)) return false;
            if (found.t < first.t) first = found;
        }
        return true;
    }
    // Locates a crossing between found.t and t_, where the switch has the values `positive` and `negative`, by the
    // Illinois variant of regula falsi (Dowell & Jarratt 1971, BIT 11, 168). Each trial integrates from `before`.
    bool locate(const S& before, double begin, double size, double positive, double negative, Crossing& found) {
        constexpr int most_trials = 100;
        double a = begin, b = t_;
        int side = 0;
        for (int i = 0; i < most_trials && b - a > 4e-16 * b; ++i) {
            double middle = a + (b - a) * (positive / (positive - negative));
            if (!(middle > a && middle < b)) middle = a + (b - a) / 2;
            if (!(middle > a && middle < b)) break;
            S copy = before;
            for (double t = begin, h = size; t < middle;)
                if (!advance(copy, t, h, middle)) return false;
            search_evaluations_ += evaluations_of(copy) - evaluations_of(before);
            const double value = copy.switch_values()[found.which];
            if (value > 0) {
                a = middle, positive = value;
                if (side > 0) negative /= 2;
                side = 1;
            } else {
                b = middle, negative = value;
                if (value == 0) break;
                if (side < 0) positive /= 2;
                side = -1;
            }
        }
        found.t = b;
        return true;
    }
    // Changes the equations at a crossing. Returns false if the run has ended.
    bool cross(Crossing& crossing) {
        constexpr long most_crossings = 100'000;
        std::string fault = stepper_.cross_switch(crossing.which);
        if (++crossings_ > most_crossings) fault = "too many switches";
        if (!fault.empty()) return watch_.fail(Status::failed, fault + ", at " + format_time(t_));
        crossing = {};
        h_ = stepper_.first_step(t_);
        return true;
    }

    // Advances from t to at most `stop` by one accepted step; returns false if the run has ended.
    bool advance(S& s, double& t, double& h, double stop) {
        for (int i = 0; i < attempts_per_step; ++i) {
            if (!watch_.may_attempt(s.rhs_evaluations() + sample_evaluations() + search_evaluations_)) return false;
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
                const long counted = evaluations_of(*before);
                while (from < at)
                    if (!advance(*before, from, h, at)) return false;
                const auto inside = before->sample(at);
                evaluations_of_copies_ += evaluations_of(*before) - counted;
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
/// - `std::vector<double> switch_values() const` and `std::string cross_switch(std::size_t which)`, if the right-hand
/// side
///   switches where one of these values falls to zero: a step in which this happens is repeated up to that time, where
///   cross_switch() changes the equations. Its result is why the motion cannot go on, or empty. Two crossings of one
///   switch within a step are not found.
/// - `long newton_failures() const`, if implicit equations are solved: the number of attempts since restart() that were
///   rejected because Newton's iteration did not converge.
template <ControlledStepper S>
Trajectory march_controlled(const Problem& problem, const Settings& settings, S stepper) {
    Trajectory trajectory;
    ControlledRun<S>(problem, settings, std::move(stepper), trajectory).run();
    return trajectory;
}

}  // namespace polhode
