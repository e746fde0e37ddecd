// Driver of library solvers that choose their own steps: events, samples, limits and error flags.
#pragma once

#include <fmt/format.h>

#include <concepts>
#include <optional>
#include <string>
#include <utility>

#include "integrators/run/watch.h"

namespace polhode {

/// Status and message of a run that ended early.
struct SolverFailure {
    Status status;
    std::string message;
};

/// A library solver and its state for one problem. Flags below zero mean that it cannot continue; failure() explains
/// them. Optional members:
/// - `SolverCounts counts()`: counts of rejected steps and failures.
/// - `current_motion()`: the current motion, if sample() changes the counts; current_motion() must not.
/// - `long sample_evaluations() const`, if samples inside a step cost evaluations: their number since restart, which
///   rhs_evaluations() does not include.
template <class S>
concept SolverSession = requires(S s, const Segment& segment, double t, int flag) {
    s.restart();                                             // returns to t = 0, resets all counts
    { s.enter(segment) } -> std::same_as<int>;               // an event: impulses, then the loads from here on; a flag
    { s.step() } -> std::same_as<int>;                       // one step of the solver, cut at the segment's end; a flag
    { s.time() } -> std::convertible_to<double>;             // current time, s
    { s.sample() } -> std::convertible_to<Bodies>;           // the motion at time()
    { *s.sample_inside(t) } -> std::convertible_to<Bodies>;  // the motion at t within the last step; may be empty
    { s.inside_flag() } -> std::same_as<int>;                // flag that explains an empty sample_inside()
    { s.failure(flag) } -> std::same_as<SolverFailure>;
    { s.steps() } -> std::convertible_to<long>;  // since restart
    { s.rhs_evaluations() } -> std::convertible_to<long>;
};

/// Runs one session.
template <SolverSession Session>
class SolverRun {
  public:
    /// The arguments must outlive this object.
    SolverRun(const Problem& problem, const Settings& settings, Session& session)
        : problem_(problem), settings_(settings), session_(session), watch_(problem, settings, trajectory_) {}
    SolverRun(const SolverRun&) = delete;
    SolverRun& operator=(const SolverRun&) = delete;

    Trajectory solve() {
        const bool complete = repeat(settings_, trajectory_, [&](bool recording) { return run(recording); });
        trajectory_.steps = session_.steps();
        trajectory_.sample_evaluations = sample_evaluations();
        trajectory_.rhs_evaluations = session_.rhs_evaluations() + trajectory_.sample_evaluations;
        if constexpr (requires { session_.counts(); }) trajectory_.counts = session_.counts();
        if (!settings_.record && complete) watch_.record(session_.sample());
        return std::move(trajectory_);
    }

  private:
    bool fail(int flag) {
        const SolverFailure failure = session_.failure(flag);
        return watch_.fail(failure.status, failure.message);
    }
    long sample_evaluations() const {
        if constexpr (requires { session_.sample_evaluations(); }) return session_.sample_evaluations();
        return 0;
    }
    auto current_motion() {
        if constexpr (requires { session_.current_motion(); }) return session_.current_motion();
        return session_.sample();
    }

    bool run(bool recording) {
        // consecutive steps that do not advance t before the run is ended
        constexpr int standstill = 100;
        SampleQueue samples = recording ? sample_queue(problem_, settings_) : SampleQueue();
        session_.restart();
        watch_.restart();
        const auto enter = [&](const Segment& segment) {
            const int flag = session_.enter(segment);
            return flag >= 0 || fail(flag);
        };
        const auto show = [&](double at) {
            const auto sample = at == session_.time() ? std::optional(session_.sample()) : session_.sample_inside(at);
            return sample ? watch_.record(*sample) : fail(session_.inside_flag());
        };
        return follow(problem_.segments, samples, enter, show, [&](const Segment& segment) {
            int still = 0;
            while (session_.time() < segment.end) {
                if (!watch_.may_step(session_.rhs_evaluations() + sample_evaluations())) return false;
                const double begin = session_.time();
                if (const int flag = session_.step(); flag < 0) return fail(flag);
                const double t = session_.time();
                if (!watch_.makes_progress(t)) return false;
                still = t > begin ? 0 : still + 1;
                if (still == standstill)
                    return watch_.fail(Status::tolerance_not_met,
                                       fmt::format("step size below the spacing of numbers at t = {:g} s", t));
                for (; samples.due(segment, t); samples.pop())
                    if (!show(samples.front())) return false;
                if (!watch_.stays_bounded([&] { return current_motion(); })) return false;
            }
            return true;
        });
    }

    const Problem& problem_;
    const Settings& settings_;
    Session& session_;
    Trajectory trajectory_;
    Watch watch_;
};

}  // namespace polhode
