// One tolerance-driven run of a SUNDIALS solver.
#pragma once

#include "integrators/run/solver_run.h"
#include "integrators/sundials/build.h"

namespace polhode {

/// Appends a remark to the message of every run if the library is unoptimised, because this affects timings.
inline void append_unoptimised_remark(Trajectory& trajectory) {
    if (sundials_unoptimised())
        trajectory.message += trajectory.message.empty() ? "SUNDIALS unoptimised" : "; SUNDIALS unoptimised";
}

/// Prepends a remark to the message.
inline Trajectory prepend_remark(Trajectory trajectory, const char* remark) {
    trajectory.message = trajectory.message.empty() ? remark : remark + ("; " + trajectory.message);
    return trajectory;
}

/// Runs one session.
template <SolverSession Session>
Trajectory run_sundials(const Problem& problem, const Settings& settings, Session& session) {
    Trajectory trajectory = SolverRun(problem, settings, session).solve();
    append_unoptimised_remark(trajectory);
    return trajectory;
}

}  // namespace polhode
