// The program's commands, one file each. Adding one is one file, its declaration here and its name in main.cpp.
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "check/convention.h"
#include "scene/scene.h"

namespace polhode {

/// Adds a command to the program. Its callback runs when the command is given, and sets `exit_code`: 0 done, 1 the run
/// ended in a named failure. Bad usage or input is thrown: UsageError, InputError.
using AddCommand = void (*)(CLI::App& program, int& exit_code);

/// One trajectory (solve.cpp).
void add_solve(CLI::App& program, int& exit_code);
/// All that is known of a scene or a method before solving (describe.cpp).
void add_describe(CLI::App& program, int& exit_code);
/// Experiments into tables and pictures (run.cpp).
void add_run(CLI::App& program, int& exit_code);
/// What several folders hold of one experiment, as one (merge.cpp).
void add_merge(CLI::App& program, int& exit_code);
/// Text for the engines that run shards (submit.cpp).
void add_submit(CLI::App& program, int& exit_code);
/// The reference trajectory (truth.cpp).
void add_truth(CLI::App& program, int& exit_code);
/// Trajectories of anyone's making against the truth (check.cpp).
void add_check(CLI::App& program, int& exit_code);
/// Pictures of trajectories (plot.cpp).
void add_plot(CLI::App& program, int& exit_code);
/// A scene as it is written (show.cpp).
void add_show(CLI::App& program, int& exit_code);
/// What there is (list.cpp).
void add_list(CLI::App& program, int& exit_code);
/// Golden data for an engine's unit tests (export.cpp).
void add_export(CLI::App& program, int& exit_code);
/// A scene for many bodies (ensemble_command.cpp).
void add_ensemble(CLI::App& program, int& exit_code);
/// A folder of results as one page (report.cpp).
void add_report(CLI::App& program, int& exit_code);

/// Bad usage: one line on stderr, exit code 2.
class UsageError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// f(), whose std::invalid_argument is bad usage: thrown as UsageError, `before` in front of its words.
template <class F>
auto as_usage(const F& f, std::string_view before = "") {
    try {
        return f();
    } catch (const std::invalid_argument& error) {
        throw UsageError(std::string(before) + error.what());
    }
}

/// Parses the command line, runs the command given and turns every exception into one line on stderr and an exit code:
/// 2 for bad usage or input, 1 for whatever else went wrong.
int run_program(int argc, const char* const* argv, std::span<const AddCommand> commands);

/// Writes data to stdout, or atomically to `path` where it is not empty. Throws std::runtime_error.
void write_output(const std::string& path, std::string_view text);

/// Throws UsageError where write_output could not write to `path`.
void require_output(const std::string& path);

/// Throws UsageError unless `value` is finite and positive; `option` is named in the message.
void require_positive(const char* option, double value);

/// What --convention says; ours where it is empty. Throws UsageError.
Convention convention_option(const std::string& words);

/// Throws UsageError where a scene has no joints whose reactions could go to `path`, or `path` is that of another
/// output.
void require_joints(const Scene& scene, const std::string& path, const std::string& other);

/// Throws UsageError if the scene has several bodies. `option` needs a scene of one body; `reason` says why.
void require_one_body(const Scene& scene, const std::string& option, const std::string& reason);

/// As write_output, of a table of trajectories: a file also says in a comment which frames and which point its columns
/// are of.
void write_trajectory_output(const std::string& path, std::string text);

/// Appends the columns of trajectory files, and then the text `further`, to the command's help.
void tell_columns(CLI::App& command, std::string_view further);

/// Throws UsageError unless 1 <= count <= most.
void require_count(const char* option, long count, long most);

/// Adds --allow-outside: scene and experiment files may name files outside their own folders.
void outside_option(CLI::App& command);

/// Throws UsageError where samples times bodies are more than a program holds in memory.
void require_states(const Scene& scene, long samples);

/// Adds --engines FILE: engines of the user's own beside those that come with the program.
void engines_option(CLI::App& command);

}  // namespace polhode
