// Searches: curves whose next setting depends on the results of the runs before it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiment/plan/experiment.h"
#include "experiment/run/sweep.h"
#include "table/table.h"

namespace polhode {

/// All runs of one curve on one scene. Their rows are stored together under one key.
struct Search {
    std::size_t scene;  ///< index in plan.scenes
    const PlannedCurve* curve;
    std::string key;
    std::optional<Table> rows;  ///< empty: not run yet
};

/// The searches of all scenes and curves of the plan, scene by scene, with the rows stored in the directory.
std::vector<Search> find_searches(const Plan& plan, const std::string& directory);

/// Runs and stores the searches without rows that filter and shard select, `jobs` at a time. Calls `prepare` once for
/// each scene; `needed` is true if any of its searches will run. Then calls `run` with the index of each search. Does
/// not store interrupted searches. Throws std::runtime_error if results cannot be stored.
void run_searches(const Plan& plan, const RunOptions& options, std::vector<Search>& searches,
                  const std::function<void(std::size_t scene, bool needed)>& prepare,
                  const std::function<Table(std::size_t search)>& run);

}  // namespace polhode
