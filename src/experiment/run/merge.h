// Merges result directories of one experiment into one directory.
#pragma once

#include <string>
#include <vector>

#include "experiment/run/sweep.h"

namespace polhode {

/// Records the experiment in the directory of its cases, so that merge_results() needs no experiment argument. Throws
/// std::runtime_error.
void record_experiment(const Plan& plan, const std::string& directory);

/// Whether the directory has a record written by record_experiment().
bool has_results(const std::string& directory);

struct ExperimentMerge {
    std::string name;
    long missing = 0;           ///< cases that are in no directory
    std::string first_missing;  ///< description of one of them
};

struct MergeResult {
    std::vector<ExperimentMerge> experiments;
    long taken = 0;     ///< case files copied
    long repeated = 0;  ///< case files found in more than one directory
    std::vector<std::string> remarks;
};

/// Copies the finished cases of all directories to `options.directory`, which may contain results, and writes tables,
/// figures and provenance of every experiment. The output does not depend on the number and order of directories, and
/// repeating the merge does not change it. If rows of one case differ only in their times, the fastest is kept.
/// Directories without results are listed in the remarks. Throws InputError before writing anything if a directory is
/// missing, no directory has results, two experiments have the same name, results are from another build of the
/// program, or rows of one case differ in anything but times and machine; the message then shows both. Throws
/// std::runtime_error if results cannot be stored.
MergeResult merge_results(const std::vector<std::string>& directories, const RunOptions& options,
                          const std::string& command_line);

}  // namespace polhode
