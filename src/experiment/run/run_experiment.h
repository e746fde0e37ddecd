// Runs an experiment of any kind, from its plan to its files.
#pragma once

#include <string>
#include <vector>

#include "experiment/plan/experiment.h"
#include "experiment/run/findings.h"
#include "experiment/run/result.h"
#include "experiment/run/sweep.h"

namespace polhode {

/// Returns the table of the rows and the findings of the plan's kind.
Findings conclude(const Plan& plan, const std::vector<Result>& rows);

/// Returns the findings from the finished rows in the directory, followed by the findings of the kind's follow-up.
Findings conclude_finished(const Plan& plan, const std::string& directory);

struct GatherResult {
    long missing = 0;           ///< cases that are not in the directory
    std::string first_missing;  ///< description of one of them
};

/// Writes tables, figures and provenance from the finished cases in the directory, without running missing cases.
/// A kind with `make` must be resumable. Throws std::runtime_error if results cannot be stored.
GatherResult gather_results(const Plan& plan, const RunOptions& options, const std::string& command_line);

/// Query and set the mark that the directory has the results of a kind with `make`.
bool is_study_done(const Plan& plan, const std::string& directory);
void save_study_done(const Plan& plan, const std::string& directory);

/// cost_table() of the plan and of its follow-up.
Table work_cost_table(const Plan& plan, const std::string& measured);

/// What run_experiment() would run: cases, or the whole experiment if its kind has `make`.
std::vector<PendingCase> pending_work(const Plan& plan, const RunOptions& options);

/// Runs the cases that are missing in the directory. Then writes tables, figures and provenance from all finished
/// cases there, including those of other shards and earlier runs. Reports on standard error. Returns false if it was
/// interrupted. A failure of a method is a row. Throws std::runtime_error if results cannot be stored.
bool run_experiment(const Plan& plan, const RunOptions& options, const std::string& command_line);

}  // namespace polhode
