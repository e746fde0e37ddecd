// Runs the cases of a plan: errors first, then timings, interleaved over the methods.
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
    std::string directory;  ///< where tables and finished cases go
    int jobs = 1;           ///< threads for truths and errors; timings always run alone
    int shard = 1, shards = 1;
    bool quick = false, quiet = false;
    std::shared_ptr<const Costs> costs{};  ///< by which shards share the cases out; none: every N-th scene to each
    Formats formats{};                     ///< of tables and pictures, beside CSV
    bool only_gather = false;              ///< runs no case: tables are made of what stands in the directory
};

/// Which curves on which scenes the shard and the filter of the options take.
class AskedFor {
  public:
    /// The plan must outlive it. Throws std::invalid_argument where the filter is no regular expression.
    AskedFor(const Plan& plan, const RunOptions& options);
    /// By the places of scene and curve in the plan.
    bool operator()(std::size_t scene, std::size_t curve) const;

  private:
    const Plan& plan_;
    Pattern filter_;
    int shard_, shards_;
    bool none_;
    std::vector<std::vector<int>> dealt_;  // by costs, where they are known
};

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
