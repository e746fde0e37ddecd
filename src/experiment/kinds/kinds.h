// The functions of all kinds of experiments. Each is in its own file and is listed in kinds.cpp.
#pragma once

#include <vector>

#include "experiment/plan/experiment.h"
#include "experiment/run/findings.h"
#include "experiment/run/result.h"
#include "experiment/run/sweep.h"

namespace polhode {

// `conclude` of the kinds: findings from the rows of a sweep
Findings conclude_sweep(const Plan& plan, const std::vector<Result>& rows);
Findings conclude_convergence(const Plan& plan, const std::vector<Result>& rows);
Findings conclude_drift(const Plan& plan, const std::vector<Result>& rows);
Findings conclude_tolerance(const Plan& plan, const std::vector<Result>& rows);
Findings conclude_leave_out(const Plan& plan, const std::vector<Result>& rows);
Findings conclude_conservation(const Plan& plan, const std::vector<Result>& rows);
Findings conclude_engines(const Plan& plan, const std::vector<Result>& rows);
Findings conclude_engine_joints(const Plan& plan, const std::vector<Result>& rows);
Findings conclude_engine_contact(const Plan& plan, const std::vector<Result>& rows);
Findings conclude_speed(const Plan& plan, const std::vector<Result>& rows);
Findings conclude_contact(const Plan& plan, const std::vector<Result>& rows);
Findings conclude_contact_stiffness(const Plan& plan, const std::vector<Result>& rows);
Findings conclude_joints(const Plan& plan, const std::vector<Result>& rows);

/// The follow-up of `speed`: its motions with a closed form over T, 10 T and 100 T, by polhode's methods at their
/// finest tolerance.
Plan long_runs(const Plan& plan);

// `make` of the kinds: compute their own rows
Findings run_gimbal_lock(const Plan& plan, const RunOptions& options);
Findings run_collisions(const Plan& plan, const RunOptions& options);
Findings run_contact_anisotropy(const Plan& plan, const RunOptions& options);
Findings run_inertia(const Plan& plan, const RunOptions& options);
Findings run_inertia_shortcuts(const Plan& plan, const RunOptions& options);
Findings run_mechanism_cost(const Plan& plan, const RunOptions& options);
Findings run_ensembles(const Plan& plan, const RunOptions& options);
Findings run_mechanism_truth(const Plan& plan, const RunOptions& options);
Findings run_event_truth(const Plan& plan, const RunOptions& options);
Findings run_orientation(const Plan& plan, const RunOptions& options);
Findings run_point_bodies(const Plan& plan, const RunOptions& options);
Findings run_stability(const Plan& plan, const RunOptions& options);

}  // namespace polhode
