// One tolerance-driven run of a library's solver that takes its own steps: events, samples, limits, and what its flags
// mean.
#pragma once

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "integrators/run/march.h"

namespace polhode {

/// Session: CvodeSession, ArkodeSession, GslSession, or one alike.
template <class Session>
class SolverRun {
  public:
    SolverRun(const Problem& problem, const Settings& settings, Session& session)
        : problem_(problem), settings_(settings), bound_(energy_bound(problem)), session_(session) {}

    Trajectory solve() {
        Budget budget(settings_);
        int runs = 0;
        bool going = true;
        const Stopwatch stopwatch;
        while (going && runs < settings_.repetitions) {
            ++runs;
            going = run(settings_.record && runs == settings_.repetitions, budget);
        }
        trajectory_.seconds = stopwatch.seconds() / runs;
        trajectory_.steps = session_.steps();
        trajectory_.rhs_evaluations = session_.rhs_evaluations();
        if constexpr (requires { session_.counts(); }) trajectory_.counts = session_.counts();
        if (!settings_.record && going) record(problem_, session_.sample(), bound_, trajectory_);
        return std::move(trajectory_);
    }

  private:
    bool fail(Status status, std::string message) {
        trajectory_.status = status, trajectory_.message = std::move(message);
        return false;
    }
    bool fail(int flag) {
        const auto failure = session_.failure(flag);
        return fail(failure.status, failure.message);
    }

    bool run(bool recording, Budget& budget) {
        // steps in a row that do not move t before a run is given up
        constexpr int standstill = 100;
        const double T = problem_.scene.duration;
        SampleQueue samples = recording ? SampleQueue(T, settings_.samples) : SampleQueue();
        session_.restart();
        Pace pace(settings_, T, budget.steps());
        const auto enter = [&](const Segment& segment) {
            const int flag = session_.enter(segment);
            return flag >= 0 || fail(flag);
        };
        const auto show = [&](double at) {
            const std::optional<Sample> sample = at == session_.time() ? session_.sample() : session_.sample_inside(at);
            return sample ? record(problem_, *sample, bound_, trajectory_) : fail(session_.inside_flag());
        };
        return follow(problem_.segments, samples, enter, show, [&](const Segment& segment) {
            int still = 0;
            while (session_.time() < segment.end) {
                if (!budget.take(session_.rhs_evaluations())) {
                    budget.stop(trajectory_);
                    return false;
                }
                const double begin = session_.time();
                if (const int flag = session_.step(); flag < 0) return fail(flag);
                const double t = session_.time();
                if (!pace.keeps(budget.steps(), t)) return fail(Status::tolerance_not_met, Pace::message(t));
                still = t > begin ? 0 : still + 1;
                if (still == standstill)
                    return fail(Status::tolerance_not_met,
                                fmt::format("step size below the spacing of numbers at t = {:g} s", t));
                for (; samples.due(segment, t); samples.pop())
                    if (!show(samples.front())) return false;
            }
            return true;
        });
    }

    const Problem& problem_;
    const Settings& settings_;
    double bound_;
    Session& session_;
    Trajectory trajectory_;
};

}  // namespace polhode
