// Finished cases of a sweep, one file each under DIR/.cases, so that an interrupted run goes on from where it was and
// several processes may share a folder. A case is found by a key of program, scene, experiment and setting, never by
// its name. Each file is sealed (text/sealed.h): one that is damaged is told of and counts as none.
#pragma once

#include <optional>
#include <string>

#include "experiment/run/result.h"

namespace polhode {

/// The identity of polhode's code: changes with any source file, compiler or flag.
const char* program_key();

/// The identity of the program that runs: polhode's code, and where there are methods from outside the tree the whole
/// executable, since nobody else knows when they change.
std::string running_program_key();

/// The key of one case.
std::string case_key(const Plan& plan, const PlannedScene& scene, const PlannedCurve& curve, double setting);

/// The stored result, if there is a whole one. A file that cannot be read counts as none.
std::optional<Result> load_case(const std::string& directory, const std::string& key);

/// Stores a finished case: temporary, synced, renamed. Throws std::runtime_error.
void save_case(const std::string& directory, const std::string& key, const std::string& experiment,
               const Result& result);

/// Several rows under one key, as one file: what it takes more than one run to find.
std::optional<Table> load_rows(const std::string& directory, const std::string& key);
void save_rows(const std::string& directory, const std::string& key, const Table& rows);

/// Remembers that all that stands under this key is done, and asks for it.
void save_done(const std::string& directory, const std::string& key);
bool is_done(const std::string& directory, const std::string& key);

/// How long a case took, by the words that name it, whatever program ran it: what a dry run tells.
void save_duration(const std::string& directory, const std::string& words, double seconds);
std::optional<double> load_duration(const std::string& directory, const std::string& words);

}  // namespace polhode
