// Runs programs as child processes: text in, text out, with limits on time and output.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace polhode {

/// Limits of a child process. Beyond them its whole process group is killed.
struct ChildLimits {
    std::chrono::duration<double> time = std::chrono::hours(1);  ///< wall clock
    std::size_t output_bytes = std::size_t(1) << 30;             ///< for standard output and standard error each
};

/// How a child process ended, and its output.
struct ChildRun {
    std::string fault;       ///< why it did not exit by itself with code 0, in one line; else empty
    std::string output;      ///< standard output up to the end of the run
    bool not_found = false;  ///< the program does not exist
    bool timed_out = false;  ///< it was killed at the time limit
    double seconds = 0;      ///< wall clock, from start to end
};

/// Runs the program `arguments[0]` with these arguments and without a shell. A name without a slash is looked up on
/// the PATH. The program reads `input` from its standard input, inherits the environment and the working directory,
/// and leads its own process group. Returns when the program has ended, and kills the rest of its group. `fault`
/// reports a program that could not be started, a nonzero exit code, a signal or an exceeded limit, and quotes the
/// last line written to standard error. Throws only std::bad_alloc.
ChildRun run_child(const std::vector<std::string>& arguments, std::string_view input, const ChildLimits& limits = {});

/// The name by which messages refer to a program: `command` as one line, without its folders, which differ between
/// machines.
std::string program_name(std::string_view command);

/// The last line of the file that is not blank, shortened for quoting.
std::string last_line_of(std::FILE* file);

}  // namespace polhode
