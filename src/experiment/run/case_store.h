// Stores finished cases of a sweep, one file per case in DIR/.cases, so that interrupted runs can continue and several
// processes can share a directory. The key of a case is a hash of program, scene, experiment and setting. Each file
// ends in a checksum (text/sealed.h). Corrupted files are reported and treated as missing.
#pragma once

#include <optional>
#include <string>

#include "experiment/run/result.h"

namespace polhode {

/// Identifies polhode's code. Changes with any source file, the compiler and the flags.
const char* program_key();

/// Identifies the running program: program_key(), plus a hash of the executable if it has user-defined methods.
std::string running_program_key();

/// The key of one case.
std::string case_key(const Plan& plan, const PlannedScene& scene, const PlannedCurve& curve, double setting);

/// Loads a stored result. Returns nothing if the file is missing, incomplete or unreadable.
std::optional<Result> load_case(const std::string& directory, const std::string& key);

/// Stores a finished case: writes a temporary file, syncs it and renames it. Throws std::runtime_error.
void save_case(const std::string& directory, const std::string& key, const std::string& experiment,
               const Result& result);

/// Load and store the rows of a search, which consists of several runs, as one file under one key.
std::optional<Table> load_rows(const std::string& directory, const std::string& key);
void save_rows(const std::string& directory, const std::string& key, const Table& rows);

/// Mark the work under this key as finished, and query this mark.
void save_done(const std::string& directory, const std::string& key);
bool is_done(const std::string& directory, const std::string& key);

/// Store and load the run time of a case, in s, under its description describe_case(). It is shared by all builds of
/// the program, for the estimates of a dry run.
void save_duration(const std::string& directory, const std::string& description, double seconds);
std::optional<double> load_duration(const std::string& directory, const std::string& description);

}  // namespace polhode
