// What an experiment found, as files.
#pragma once

#include <string>
#include <vector>

#include "experiment/plan/experiment.h"
#include "experiment/run/findings.h"
#include "experiment/run/formats.h"

namespace polhode {

/// Writes the tables, the page, the pictures and this experiment's entry in provenance.json into the directory, tables
/// as .csv and in those formats. Returns remarks for the user (a picture that could not be drawn). Throws
/// std::runtime_error.
std::vector<std::string> write_report(const Plan& plan, const Findings& findings, const std::string& directory,
                                      const std::string& command_line, bool quick, const Formats& formats = {});

}  // namespace polhode
