// Where a table came from.
#pragma once

#include <map>
#include <string>

#include "experiment/plan/experiment.h"

namespace polhode {

/// Writes this experiment's entry in DIR/provenance.json: what it is about, its kind, the titles of its tables by the
/// names of their files, versions, compiler, flags, CPU, commit, date, command line, how SUNDIALS was compiled; the
/// other experiments' entries stay. Throws std::runtime_error.
void record_provenance(const std::string& directory, const Experiment& experiment,
                       const std::map<std::string, std::string>& titles, const std::string& command_line, bool quick);

/// Adds the plan's scenes, as they were run, to DIR/scenes.json: canonical JSON by the names that rows have for them.
/// Those that have no file form are left out. Throws std::runtime_error.
void record_scenes(const std::string& directory, const Plan& plan);

}  // namespace polhode
