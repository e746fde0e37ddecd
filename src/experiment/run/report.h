// What an experiment found, as files.
#pragma once

#include <string>
#include <vector>

#include "experiment/plan/experiment.h"
#include "experiment/run/findings.h"

namespace polhode {

/// Writes the tables (.csv, .md, .tex, .json), the page, the pictures and this experiment's entry in provenance.json
/// into the directory. Returns remarks for the user (a picture that could not be drawn). Throws std::runtime_error.
std::vector<std::string> write_report(const Plan& plan, const Findings& findings, const std::string& directory,
                                      const std::string& command_line, bool quick);

}  // namespace polhode
