// Runs gnuplot, without a shell.
#pragma once

#include <chrono>
#include <string>

namespace polhode {

/// The result of running gnuplot.
struct GnuplotRun {
    std::string output;  ///< standard output of gnuplot
    std::string fault;   ///< why the output is unusable (gnuplot's own message if it has one), or empty
};

/// Runs the first gnuplot on the PATH with the script as standard input. No start-up file is read. The process is
/// killed after the time limit. Throws nothing: errors are in `fault`.
GnuplotRun run_gnuplot(const std::string& script, std::chrono::milliseconds time_limit);

/// Runs a script that draws one picture with the terminal "svg" or "pdf", like run_gnuplot(). An incomplete picture
/// is a fault. A PDF's creation date is replaced by the epoch, so that the same script gives the same bytes.
GnuplotRun gnuplot_picture(const std::string& script, const std::string& terminal,
                           std::chrono::milliseconds time_limit);

}  // namespace polhode
