// Runs the cases of a plan: errors first, then timings with the methods in turn.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiment/plan/pattern.h"
#include "experiment/run/costs.h"
#include "experiment/run/formats.h"
#include "experiment/run/result.h"

namespace polhode {

struct RunOptions {
    std::string filter;     ///< a regular expression on SCENE/METHOD; empty: all
    std::string directory;  ///< for tables and finished cases
    int jobs = 1;           ///< threads for truths and errors; timings always run alone
    int shard = 1, shards = 1;
    bool quick = false, quiet = false;
    std::shared_ptr<const Costs> costs{};  ///< distributes cases over shards; null: each shard takes every N-th scene
    Formats formats{};                     ///< of tables and figures, in addition to CSV
    bool only_gather = false;              ///< runs no cases; writes tables of the finished ones
};

/// Whether shard and filter select a curve on a scene.
class CaseSelection {
  public:
    /// The plan must outlive this object. Throws std::invalid_argument if the filter is not a regular expression.
    CaseSelection(const Plan& plan, const RunOptions& options);
    /// Takes the indices of scene and curve in the plan.
    bool contains(std::size_t scene, std::size_t curve) const;

  private:
    const Plan& plan_;
    Pattern filter_;
    int shard_, shards_;
    bool is_empty_;
    std::vector<std::vector<int>> shard_of_curve_;  // shard by scene and curve; empty without costs
};

struct SweepCount {
    long cases = 0, run = 0;  ///< cases selected by the options; cases run now (the others were finished)
};

/// Requests a running sweep to stop after the current case. Async-signal-safe.
void interrupt_sweep();
bool sweep_interrupted();
/// Clears the request of interrupt_sweep().
void allow_sweeps();

/// Runs the missing cases. A failure of a method is a row. Throws std::runtime_error if results cannot be stored.
SweepCount run_sweep(const Plan& plan, const RunOptions& options);

/// All finished cases of the plan in this directory, from all processes, in the order scene, curve, setting.
std::vector<Result> finished_results(const Plan& plan, const std::string& directory);

struct PendingCase {
    std::string description;               ///< experiment, scene, method, setting
    std::optional<double> seconds_before;  ///< time of its last run in this directory, without the truth
};

/// The cases that run_sweep() would run.
std::vector<PendingCase> pending_cases(const Plan& plan, const RunOptions& options);

}  // namespace polhode
