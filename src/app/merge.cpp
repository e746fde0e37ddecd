// polhode merge: merges the results of shards from several directories.
#include "experiment/run/merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "app/commands.h"
#include "app/ensemble_parts.h"
#include "app/submit_scripts.h"
#include "experiment/run/formats.h"
#include "text/message.h"

namespace polhode {
namespace {

struct MergeOptions {
    std::vector<std::string> directories;
    std::string output, formats = "csv," + Formats().text();
    int jobs = 0;
    bool quiet = false;
};

// Merges parts of ensembles. Returns 0, or 1 if any row failed.
int merge_ensembles(const MergeOptions& options, const std::vector<std::string>& directories) {
    const MergedEnsemble merged = merge_ensemble_parts(directories, options.output);
    if (!options.quiet)
        fmt::print(stderr, "{}: {} rows from {} parts\n", one_line(merged.output, 300), merged.rows, merged.parts);
    if (merged.all_ok()) return 0;
    fmt::print(stderr, "polhode: {}: {} of {} rows failed\n", one_line(merged.output, 300), merged.rows - merged.ok,
               merged.rows);
    return 1;
}

int merge_command(const MergeOptions& options) {
    if (options.jobs < 0 || options.jobs > 4096)
        throw UsageError(fmt::format("--jobs is {}; give 1 to 4096", options.jobs));
    std::vector<std::string> with_parts, with_results;
    for (const std::string& directory : options.directories) {
        if (has_ensemble_parts(directory)) with_parts.push_back(directory);
        if (has_results(directory)) with_results.push_back(directory);
    }
    int ensembles = 0;
    if (!with_parts.empty()) ensembles = merge_ensembles(options, with_parts);
    if (!with_parts.empty() && with_results.empty()) return ensembles;
    if (std::error_code none; std::filesystem::exists(std::filesystem::symlink_status(options.output, none)) &&
                              !std::filesystem::is_directory(options.output, none))
        throw UsageError(
            fmt::format("--output is {}, not a directory; give a directory", one_line(options.output, 200)));
    RunOptions run;
    run.directory = options.output, run.quiet = options.quiet;
    run.formats = as_usage([&] { return parse_formats(options.formats); }, "--formats: ");
    run.jobs = options.jobs > 0 ? options.jobs : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    std::string command_line = "polhode merge";
    for (const std::string& directory : options.directories) command_line += " " + shell_word(directory);
    command_line += " --output " + shell_word(options.output);
    const MergeResult merged = merge_results(options.directories, run, command_line);
    for (const std::string& remark : merged.remarks) fmt::print(stderr, "polhode: {}\n", one_line(remark, 500));
    if (!options.quiet)
        fmt::print(stderr, "{} directories merged into {}: {} case files, {} of them in more than one directory\n",
                   options.directories.size(), one_line(options.output, 300), merged.taken, merged.repeated);
    bool complete = true;
    for (const ExperimentMerge& one : merged.experiments) {
        if (one.missing == 0) continue;
        complete = false;
        fmt::print(stderr, "polhode: {}: {} cases are missing, first {}; rerun their shards and merge again\n",
                   one.name, one.missing, one_line(one.first_missing, 300));
    }
    return complete && ensembles == 0 ? 0 : 1;
}

}  // namespace

void add_merge(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand(
        "merge",
        "Merges the results of shards from any number of directories, in any order, and writes the tables and figures. "
        "The exit code is 1 if cases are missing.");
    command->footer(
        "Examples:\n"
        "  polhode merge shards/1 shards/2 shards/3 --output results\n"
        "  polhode merge parts --output out.npy\n");
    const auto options = std::make_shared<MergeOptions>();
    command
        ->add_option("DIR", options->directories,
                     "Directories written by polhode run --shard I/N or polhode ensemble --shard I/N")
        ->required();
    add_engines_option(*command);
    add_outside_option(*command);
    command
        ->add_option("--output", options->output,
                     "Output directory: a new one or one of DIR. For ensembles an output file or its directory")
        ->required();
    command->add_option("--jobs", options->jobs, "Number of threads (default: all cores)");
    command->add_option("--formats", options->formats, "Formats of tables and figures. CSV is always written")
        ->capture_default_str();
    command->add_flag("--quiet", options->quiet, "Do not print a summary");
    command->callback([options, &exit_code] { exit_code = merge_command(*options); });
}

}  // namespace polhode
