// Provenance of result tables.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "experiment/plan/experiment.h"

namespace polhode {

/// Writes this experiment's entry in DIR/provenance.json: description, kind, table titles by file name, all files,
/// versions, compiler, flags, CPU, commit, date, command line, the build of SUNDIALS, and the machines that measured
/// the times. Keeps the entries of other experiments. Throws std::runtime_error.
void record_provenance(const std::string& directory, const Experiment& experiment,
                       const std::map<std::string, std::string>& titles, const std::vector<std::string>& files,
                       const std::vector<std::string>& machines, const std::string& command_line, bool quick);

/// The files listed in the experiment's entry; empty if there is no entry.
std::vector<std::string> recorded_files(const std::string& directory, const std::string& experiment);

/// Copies an experiment's entry from another directory. Throws std::runtime_error.
void copy_provenance(const std::string& from, const std::string& directory, const std::string& experiment);

/// Adds the plan's scenes to DIR/scenes.json: their canonical JSON, by the names used in the rows. Omits scenes that
/// cannot be written as a file. Throws std::runtime_error.
void record_scenes(const std::string& directory, const Plan& plan);

}  // namespace polhode
