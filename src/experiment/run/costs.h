// Expected run times of the cases of a plan, and their distribution over shards.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "experiment/plan/experiment.h"
#include "table/table.h"

namespace polhode {

/// Expected seconds of cases, by experiment, scene, method, formulation and setting.
class Costs {
  public:
    /// The columns of cost_table(), which has one row per case. Rows with the method `truth` are the references that
    /// all cases of a scene need first.
    static const std::vector<std::string>& columns();

    /// Reads a table written by `polhode run --dry-run --plan FILE`. Throws InputError, with `file` and the line, if a
    /// column is missing, expected_seconds is not a number >= 0, or a case is repeated.
    Costs(const Table& table, const std::string& file);

    /// Seconds for the truth of a scene; 0 if it is not in the table.
    double truth_seconds(const Plan& plan, const PlannedScene& scene) const;
    /// Seconds for all settings of a curve; cases that are not in the table count 0.
    double curve_seconds(const Plan& plan, const PlannedScene& scene, const PlannedCurve& curve) const;

  private:
    std::map<std::string, double> seconds_;
};

/// Stores the time for a scene's truth in the directory, unless a longer time is stored. A truth from the cache takes
/// no time, but another machine has to compute it.
void save_truth_duration(const std::string& directory, const Plan& plan, const PlannedScene& scene, double seconds);

/// The expected seconds of every case of the plan, finished or not: the time of its last run in the result directory
/// `measured`, else the median there over the same method and setting, else over the same method, else over all cases,
/// else 1 s. The last column gives the source. A kind with `make` that is not resumable is one row without a scene.
Table cost_table(const Plan& plan, const std::string& measured);

/// Returns the shard (from 0) of each curve on each scene: [scene][curve]. Assigns the longest work first, always to
/// the shard with the least work (R. L. Graham 1969: no shard gets more than 4/3 of the optimum). The curves of a scene
/// stay together, so that one machine times the methods in turn. If they exceed an even share, they are divided into as
/// few parts as needed; each part needs the truth.
std::vector<std::vector<int>> assign_shards(const Plan& plan, const Costs& costs, int shards);

}  // namespace polhode
