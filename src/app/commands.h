// The commands of the program, one file per command. To add one, write the file, declare it here and list it in
// run_laboratory().
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "check/convention.h"
#include "scene/scene.h"

namespace polhode {

/// Adds a command to the program. Its callback runs the command and sets `exit_code`: 0 done, 1 the run ended in a
/// named failure. It throws UsageError or InputError for bad usage or input.
using AddCommand = void (*)(CLI::App& program, int& exit_code);

/// Computes one trajectory (solve.cpp).
void add_solve(CLI::App& program, int& exit_code);
/// Describes a scene, a method or an experiment (describe.cpp).
void add_describe(CLI::App& program, int& exit_code);
/// Runs experiments and writes tables and figures (run.cpp).
void add_run(CLI::App& program, int& exit_code);
/// Merges the results of shards from several directories (merge.cpp).
void add_merge(CLI::App& program, int& exit_code);
/// Writes scripts for workflow engines that run shards (submit.cpp).
void add_submit(CLI::App& program, int& exit_code);
/// Computes the reference trajectory (truth.cpp).
void add_truth(CLI::App& program, int& exit_code);
/// Compares trajectories from any program with the truth (check.cpp).
void add_check(CLI::App& program, int& exit_code);
/// Plots trajectories (plot.cpp).
void add_plot(CLI::App& program, int& exit_code);
/// Writes an animated picture of a motion (animate.cpp).
void add_animate(CLI::App& program, int& exit_code);
/// Prints the JSON of a scene (show.cpp).
void add_show(CLI::App& program, int& exit_code);
/// Lists scenes, methods, experiments and other names (list.cpp).
void add_list(CLI::App& program, int& exit_code);
/// Exports golden data for the unit tests of an engine (export.cpp).
void add_export(CLI::App& program, int& exit_code);
/// Fits numbers of a scene to measured motion (fit.cpp).
void add_fit(CLI::App& program, int& exit_code);
/// Solves a scene for many bodies or initial states (ensemble_command.cpp).
void add_ensemble(CLI::App& program, int& exit_code);
/// Writes a result directory as one HTML page (report.cpp).
void add_report(CLI::App& program, int& exit_code);

/// Bad usage, reported in one line on stderr with exit code 2.
class UsageError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Returns f(). Rethrows its std::invalid_argument as UsageError, with `before` prepended to the message.
template <class F>
auto as_usage(const F& f, std::string_view before = "") {
    try {
        return f();
    } catch (const std::invalid_argument& error) {
        throw UsageError(std::string(before) + error.what());
    }
}

/// Parses the command line, runs the command given and turns every exception into one line on stderr and an exit code:
/// 2 for bad usage or input, 1 for all other errors.
int run_program(int argc, const char* const* argv, std::span<const AddCommand> commands);

/// Lets the program end with a message if memory is exhausted, also where an exception cannot be thrown or caught.
void set_memory_handlers() noexcept;

/// Prints that memory is exhausted, unless another thread has printed it. Returns the exit code. Does not allocate.
int print_memory_error();

/// Writes data to stdout, or atomically to `path` if it is not empty. Throws std::runtime_error.
void write_output(const std::string& path, std::string_view text);

/// Throws UsageError if write_output() could not write to `path`.
void require_output(const std::string& path);

/// Throws UsageError, naming `option`, unless `value` is finite and positive.
void require_positive(const char* option, double value);

/// Parses the value of --convention. An empty value is polhode's convention. Throws UsageError.
Convention parse_convention_option(const std::string& words);

/// Checks the files of --reactions and --joints, which may be empty. Throws UsageError if the scene has no joints for
/// them, or if two of the files, `output` included, have the same name.
void require_joint_files(const Scene& scene, const std::string& reactions, const std::string& joints,
                         const std::string& output);

/// Throws UsageError if the scene has several bodies. `option` needs a scene of one body; `reason` says why.
void require_one_body(const Scene& scene, const std::string& option, const std::string& reason);

/// Writes a trajectory table like write_output(). In files, a comment states the frames and points of the columns.
void write_trajectory_output(const std::string& path, std::string text);

/// Appends the columns of trajectory files, and then the text `further`, to the command's help.
void describe_columns(CLI::App& command, std::string_view further);

/// Throws UsageError unless 1 <= count <= most.
void require_count(const char* option, long count, long most);

/// Adds --allow-outside, which allows scene and experiment files to name files outside their directories.
void add_outside_option(CLI::App& command);

/// Throws UsageError if samples times bodies exceeds the limit of states in memory.
void require_states(const Scene& scene, long samples);

/// Adds --engines FILE, a list of user-defined engines.
void add_engines_option(CLI::App& command);

}  // namespace polhode
