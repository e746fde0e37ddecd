// Curves whose settings are sought out: what is run next follows from what the runs before it found.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiment/plan/experiment.h"
#include "experiment/run/sweep.h"
#include "table/table.h"

namespace polhode {

/// All runs of one curve on one scene: rows that are kept together, under one key.
struct Search {
    std::size_t scene;  ///< its place in the plan
    const PlannedCurve* curve;
    std::string key;
    std::optional<Table> rows;  ///< empty: not run yet
};

/// Of each scene and each curve of the plan, in this order, with the rows that the directory has.
std::vector<Search> find_searches(const Plan& plan, const std::string& directory);

/// Runs and stores what is without rows and asked for by filter and shard, `jobs` at a time: `prepare` is called once
/// for each scene, told whether any of its searches will run, and then `run` with each place in `searches`. An
/// interrupted search is not stored. Throws std::runtime_error where results cannot be stored.
void run_searches(const Plan& plan, const RunOptions& options, std::vector<Search>& searches,
                  const std::function<void(std::size_t scene, bool needed)>& prepare,
                  const std::function<Table(std::size_t search)>& run);

}  // namespace polhode
