// One tolerance-driven run of a SUNDIALS solver.
#pragma once

#include "integrators/run/solver_run.h"
#include "integrators/sundials/build.h"

namespace polhode {

/// No timing of an unoptimised library is shown without the word.
inline void name_unoptimised_sundials(Trajectory& trajectory) {
    if (sundials_unoptimised())
        trajectory.message += trajectory.message.empty() ? "SUNDIALS unoptimised" : "; SUNDIALS unoptimised";
}

/// A remark before what the message says already.
inline Trajectory remarked(Trajectory trajectory, const char* remark) {
    trajectory.message = trajectory.message.empty() ? remark : remark + ("; " + trajectory.message);
    return trajectory;
}

template <SolverSession Session>
class SundialsRun : private SolverRun<Session> {
  public:
    using SolverRun<Session>::SolverRun;

    Trajectory solve() {
        Trajectory trajectory = SolverRun<Session>::solve();
        name_unoptimised_sundials(trajectory);
        return trajectory;
    }
};
template <SolverSession Session>
SundialsRun(const Problem&, const Settings&, Session&) -> SundialsRun<Session>;

}  // namespace polhode
