// Where a table came from.
#pragma once

#include <string>

namespace polhode {

/// Writes this experiment's entry in DIR/provenance.json: versions, compiler, flags, CPU, commit, date, command line,
/// how SUNDIALS was compiled; the other experiments' entries stay. Throws std::runtime_error.
void record_provenance(const std::string& directory, const std::string& experiment, const std::string& command_line,
                       bool quick);

}  // namespace polhode
