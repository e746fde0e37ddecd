// Writes the results of an experiment to files.
#pragma once

#include <string>
#include <vector>

#include "experiment/plan/experiment.h"
#include "experiment/run/findings.h"
#include "experiment/run/formats.h"

namespace polhode {

/// Writes tables, page, figures and this experiment's entry in provenance.json to the directory. Tables are written as
/// CSV and in the selected formats. Returns remarks for the user, for example about a figure that could not be drawn.
/// Throws std::runtime_error.
std::vector<std::string> write_report(const Plan& plan, const Findings& findings, const std::string& directory,
                                      const std::string& command_line, bool quick, const Formats& formats = {});

}  // namespace polhode
