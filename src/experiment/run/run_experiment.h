// The engine: one experiment, of whatever kind, from its plan to its files.
#pragma once

#include <string>
#include <vector>

#include "experiment/plan/experiment.h"
#include "experiment/run/findings.h"
#include "experiment/run/result.h"
#include "experiment/run/sweep.h"

namespace polhode {

/// The table of the rows, and what the plan's kind concludes from them.
Findings conclude(const Plan& plan, const std::vector<Result>& rows);

/// The same of the rows that stand in the directory, and behind it what the kind's sequel concludes.
Findings conclude_finished(const Plan& plan, const std::string& directory);

struct GatheredExperiment {
    long missing = 0;           ///< cases that are not there
    std::string first_missing;  ///< the words of one
};

/// Makes tables, pictures and provenance of the cases that stand in the directory and runs none that is missing. Of a
/// kind that makes its rows itself: only of a resumable one. Throws std::runtime_error where results cannot be stored.
GatheredExperiment gather_experiment(const Plan& plan, const RunOptions& options, const std::string& command_line);

/// Whether what the plan's kind makes as a whole stands in the directory; and remembers that it does.
bool is_whole_done(const Plan& plan, const std::string& directory);
void save_whole_done(const Plan& plan, const std::string& directory);

/// cost_table() of the plan and of what follows from it.
Table costs_of_work(const Plan& plan, const std::string& measured);

/// What run_experiment() would run: cases, or the experiment as a whole where its kind makes the rows itself.
std::vector<PendingCase> pending_work(const Plan& plan, const RunOptions& options);

/// Runs what is not in the directory yet, then gathers whatever is finished there, other shards' and earlier runs'
/// included, and writes tables, pictures and provenance. Tells on standard error what it did. False where it was
/// interrupted. Failures of methods are rows; throws std::runtime_error where results cannot be stored.
bool run_experiment(const Plan& plan, const RunOptions& options, const std::string& command_line);

}  // namespace polhode
