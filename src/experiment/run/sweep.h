// Runs the cases of a plan: errors first, then timings, interleaved over the methods.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/plan/pattern.h"
#include "experiment/run/result.h"

namespace polhode {

struct RunOptions {
    std::string filter;     ///< a regular expression on SCENE/METHOD; empty: all
    std::string directory;  ///< where tables and finished cases go
    int jobs = 1;           ///< threads for truths and errors; timings always run alone
    int shard = 1, shards = 1;
    bool quick = false, quiet = false;
};

/// Whether this shard and the filter take a curve on a scene, given by its place in the plan.
bool is_asked_for(const Plan& plan, std::size_t scene, const PlannedCurve& curve, const Pattern& filter,
                  const RunOptions& options);

struct SweepCount {
    long cases = 0, run = 0;  ///< asked for by the options; run now (the others were there already)
};

/// Asks a running sweep to stop after the case at hand (async-signal-safe).
void interrupt_sweep();
bool sweep_interrupted();
/// Sweeps after an interrupted one may run.
void allow_sweeps();

/// Runs what is not there yet. Failures of methods are rows; throws std::runtime_error where results cannot be stored.
SweepCount run_sweep(const Plan& plan, const RunOptions& options);

/// All finished cases of the plan in this directory, whoever ran them, in the plan's order: scene, curve, setting.
std::vector<Result> finished_results(const Plan& plan, const std::string& directory);

struct PendingCase {
    std::string words;                     ///< experiment, scene, method, setting
    std::optional<double> seconds_before;  ///< how long it took when it last ran in this directory, truth aside
};

/// What run_sweep() would run.
std::vector<PendingCase> pending_cases(const Plan& plan, const RunOptions& options);

}  // namespace polhode
