// Runs gnuplot, without a shell.
#pragma once

#include <chrono>
#include <string>

namespace polhode {

struct GnuplotRun {
    std::string output;  ///< what it wrote to standard output
    std::string fault;   ///< empty, or why the output is not to be used: its own message where it has one
};

/// Gives the script to the first gnuplot on the PATH as standard input. It reads no start-up file, and is killed after
/// the time limit. Throws nothing: what goes wrong is in `fault`.
GnuplotRun run_gnuplot(const std::string& script, std::chrono::milliseconds time_limit);

/// Runs a script that draws one picture by the terminal "svg" or "pdf", as run_gnuplot() does. A picture that is not
/// whole is a fault, and a PDF's date of creation becomes the epoch, so that the same script gives the same bytes.
GnuplotRun gnuplot_picture(const std::string& script, const std::string& terminal,
                           std::chrono::milliseconds time_limit);

}  // namespace polhode
