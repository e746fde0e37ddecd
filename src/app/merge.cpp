// polhode merge: what several folders hold of one experiment, as one.
#include "experiment/run/merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "app/commands.h"
#include "text/message.h"

namespace polhode {
namespace {

struct MergeOptions {
    std::vector<std::string> directories;
    std::string output;
    int jobs = 0;
    bool quiet = false;
};

int merge_command(const MergeOptions& options) {
    if (options.jobs < 0 || options.jobs > 4096)
        throw UsageError(fmt::format("--jobs is {}; give 1 to 4096", options.jobs));
    if (std::error_code none; std::filesystem::exists(std::filesystem::symlink_status(options.output, none)) &&
                              !std::filesystem::is_directory(options.output, none))
        throw UsageError(fmt::format("--output {} is no directory", one_line(options.output, 200)));
    RunOptions run;
    run.directory = options.output, run.quiet = options.quiet;
    run.jobs = options.jobs > 0 ? options.jobs : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    std::string command_line = "polhode merge";
    for (const std::string& directory : options.directories) command_line += " " + directory;
    const Merged merged = merge_results(options.directories, run, command_line);
    for (const std::string& remark : merged.remarks) fmt::print(stderr, "polhode: {}\n", one_line(remark, 500));
    if (!options.quiet)
        fmt::print(stderr, "{} folders into {}: {} files of cases taken, {} in more than one\n",
                   options.directories.size(), one_line(options.output, 300), merged.taken, merged.repeated);
    bool complete = true;
    for (const MergedExperiment& one : merged.experiments) {
        if (one.missing == 0) continue;
        complete = false;
        fmt::print(stderr, "polhode: {}: {} cases are missing, the first: {}; run their shards again and merge again\n",
                   one.name, one.missing, one_line(one.first_missing, 300));
    }
    return complete ? 0 : 1;
}

}  // namespace

void add_merge(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand(
        "merge",
        "Gathers what the shards of experiments have left in several folders, in any order and number, and "
        "makes the tables of all.");
    const auto options = std::make_shared<MergeOptions>();
    command->add_option("DIR", options->directories, "Folders that `polhode run --shard I/N` has written")->required();
    engines_option(*command);
    outside_option(*command);
    command->add_option("--output", options->output, "Where to: may be one of them, or a new folder")->required();
    command->add_option("--jobs", options->jobs, "Threads (default: all cores)");
    command->add_flag("--quiet", options->quiet, "No summary");
    command->callback([options, &exit_code] { exit_code = merge_command(*options); });
}

}  // namespace polhode
