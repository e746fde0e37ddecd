// What several folders hold of one experiment, as one folder.
#pragma once

#include <string>
#include <vector>

#include "experiment/run/sweep.h"

namespace polhode {

/// Remembers in the directory which experiment its cases are of, so that they can be gathered without being told.
/// Throws std::runtime_error.
void record_experiment(const Plan& plan, const std::string& directory);

/// Whether the directory holds what record_experiment() leaves.
bool has_results(const std::string& directory);

struct MergedExperiment {
    std::string name;
    long missing = 0;           ///< cases that no folder has
    std::string first_missing;  ///< the words of one of them
};

struct Merged {
    std::vector<MergedExperiment> experiments;
    long taken = 0;     ///< files of cases that were copied
    long repeated = 0;  ///< files that stood in more than one folder
    std::vector<std::string> remarks;
};

/// Gathers the finished cases of all folders in `options.directory`, which may hold some itself, and makes tables,
/// pictures and provenance of each experiment that they are of: the same bytes for any number and order of folders, and
/// when done again. Of rows of one case that differ in their times alone the fastest stands. A folder that is there
/// and holds nothing is told in the remarks. Throws InputError before anything is written: a folder that is not there;
/// none that holds results; two experiments of one name; results of another build of the program; rows of one case that
/// differ in anything but times and machine, both shown. Throws std::runtime_error where results cannot be stored.
Merged merge_results(const std::vector<std::string>& directories, const RunOptions& options,
                     const std::string& command_line);

}  // namespace polhode
