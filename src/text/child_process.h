// Programs run as child processes: text in, text out, and an end in any case.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace polhode {

/// How far a child process may go before it is killed, with all that it has started in its process group.
struct ChildLimits {
    std::chrono::duration<double> time = std::chrono::hours(1);  ///< wall clock
    std::size_t output_bytes = std::size_t(1) << 30;             ///< of standard output; standard error likewise
};

/// How a child process ended and what it wrote.
struct ChildRun {
    std::string fault;             ///< why it did not end by itself with exit code 0, in one line; else empty
    std::string output;            ///< standard output, as far as it came
    bool was_not_found = false;    ///< there is no such program
    bool was_out_of_time = false;  ///< it was killed at the limit of time
    double seconds = 0;            ///< wall clock from its start to its end
};

/// Runs the program `arguments[0]`, looked up on the PATH where its name has no slash, with these arguments and no
/// shell in between. It reads `input` from its standard input, inherits the environment and the working directory, and
/// leads a process group of its own. Returns once it has ended; whatever is left of its group is killed then. `fault`
/// tells of a program that could not be started, of an exit code other than 0, of a signal and of a limit reached; the
/// last line that the program wrote to standard error is quoted in it. Nothing is thrown but std::bad_alloc.
ChildRun run_child(const std::vector<std::string>& arguments, std::string_view input, const ChildLimits& limits = {});

/// What messages call a program that runs: `command`, one line, without its folders, which differ by machine.
std::string program_name(std::string_view command);

/// The last line of a file that is not blank, short enough to be quoted.
std::string last_line_of(std::FILE* file);

}  // namespace polhode
