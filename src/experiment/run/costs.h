// What the cases of a plan are expected to cost, and how shards share them out.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "experiment/plan/experiment.h"
#include "table/table.h"

namespace polhode {

/// Expected seconds of cases, by what a reader knows them by: experiment, scene, method, formulation and setting.
class Costs {
  public:
    /// The columns of cost_table(): a row a case; method `truth` is what all cases of its scene need first.
    static const std::vector<std::string>& columns();

    /// A table that `polhode run --dry-run --plan FILE` wrote. Throws InputError, which names `file` and the line,
    /// where a column is missing, a number of seconds is none or negative, or a case stands there twice.
    Costs(const Table& table, const std::string& file);

    /// s; what the table does not have costs nothing that anybody knows of.
    double of_truth(const Plan& plan, const PlannedScene& scene) const;
    /// s, over all settings of the curve.
    double of_curve(const Plan& plan, const PlannedScene& scene, const PlannedCurve& curve) const;

  private:
    std::map<std::string, double> seconds_;
};

/// Keeps in the directory how long a scene's truth took, if no other time did it take longer: one that is in the cache
/// takes no time, and what it would take elsewhere is to be known.
void save_truth_duration(const std::string& directory, const Plan& plan, const PlannedScene& scene, double seconds);

/// What each case of the plan is expected to take, done or not: as long as it took when it last ran in `measured`, a
/// folder of results; otherwise as long as the median of what stands there of its method at its setting, else of its
/// method, else of all, else a second. The last column says which. What is made as a whole is one row without a scene.
Table cost_table(const Plan& plan, const std::string& measured);

/// Which shard, from 0, runs a curve on a scene: [scene][curve]. Longest first, each to the shard that has least to do
/// so far (Graham's rule: no shard gets more than 4/3 of the least possible). A scene's curves stay together, so that
/// its methods are timed in turn on one machine, unless they cost more than an even share: then they are cut into as
/// few parts as are needed, each of which needs the truth.
std::vector<std::vector<int>> deal_out(const Plan& plan, const Costs& costs, int shards);

}  // namespace polhode
