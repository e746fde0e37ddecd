// Where a table came from.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "experiment/plan/experiment.h"

namespace polhode {

/// Writes this experiment's entry in DIR/provenance.json: what it is about, its kind, the titles of its tables by the
/// names of their files, all its files, versions, compiler, flags, CPU, commit, date, command line, how SUNDIALS was
/// compiled, and which machines' times the rows tell; the other experiments' entries stay. Throws std::runtime_error.
void record_provenance(const std::string& directory, const Experiment& experiment,
                       const std::map<std::string, std::string>& titles, const std::vector<std::string>& files,
                       const std::vector<std::string>& machines, const std::string& command_line, bool quick);

/// The files of the experiment's report in the directory, as its entry names them; empty where it has none.
std::vector<std::string> recorded_files(const std::string& directory, const std::string& experiment);

/// Takes over an experiment's entry from another directory. Throws std::runtime_error.
void copy_provenance(const std::string& from, const std::string& directory, const std::string& experiment);

/// Adds the plan's scenes, as they were run, to DIR/scenes.json: canonical JSON by the names that rows have for them.
/// Those that have no file form are left out. Throws std::runtime_error.
void record_scenes(const std::string& directory, const Plan& plan);

}  // namespace polhode
