// polhode run: experiments into tables and pictures.
#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "app/commands.h"
#include "experiment/plan/experiment.h"
#include "experiment/plan/pattern.h"
#include "experiment/run/run_experiment.h"
#include "text/message.h"

namespace polhode {
namespace {

struct RunCommandOptions {
    std::vector<std::string> experiments;
    std::string filter, output, shard = "1/1";
    int jobs = 0;
    bool quick = false, dry_run = false, quiet = false;
};

// The first Ctrl-C stops after the case at hand; the second ends the program as usual.
extern "C" void on_interrupt(int) {
    interrupt_sweep();
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
}

RunOptions checked(const RunCommandOptions& options) {
    RunOptions run;
    run.filter = options.filter;
    try {
        const Pattern pattern(options.filter);
    } catch (const std::invalid_argument& error) {
        throw UsageError(
            fmt::format("--filter {}: {}; give a POSIX extended regular expression", options.filter, error.what()));
    }
    if (!Pattern("^[0-9]{1,6}/[0-9]{1,6}$").matches(options.shard))
        throw UsageError(fmt::format("--shard is {}; give I/N, such as 1/3", options.shard));
    run.shard = std::stoi(options.shard), run.shards = std::stoi(options.shard.substr(options.shard.find('/') + 1));
    if (run.shard < 1 || run.shard > run.shards)
        throw UsageError(fmt::format("--shard is {}; I goes from 1 to N", options.shard));
    if (options.jobs < 0 || options.jobs > 4096)
        throw UsageError(fmt::format("--jobs is {}; give 1 to 4096", options.jobs));
    run.jobs = options.jobs > 0 ? options.jobs : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    run.directory = !options.output.empty() ? options.output : options.quick ? "build/quick" : "build/results";
    if (std::error_code none; std::filesystem::exists(std::filesystem::symlink_status(run.directory, none)) &&
                              !std::filesystem::is_directory(run.directory, none))
        throw UsageError(fmt::format("--output {} is no directory", one_line(run.directory, 200)));
    run.quick = options.quick, run.quiet = options.quiet;
    return run;
}

std::string command_line(const RunCommandOptions& options) {
    std::string line = "polhode run";
    for (const std::string& name : options.experiments) line += " " + name;
    if (!options.filter.empty()) line += " --filter '" + options.filter + "'";
    if (options.shard != "1/1") line += " --shard " + options.shard;
    if (options.quick) line += " --quick";
    return line;
}

// On standard output what would run, one line each.
void list_pending(const Plan& plan, const RunOptions& options) {
    double total = 0;
    long known = 0;
    std::string list;
    const std::vector<PendingCase> pending = pending_work(plan, options);
    for (const PendingCase& one : pending) {
        if (one.seconds_before) total += *one.seconds_before, ++known;
        list += fmt::format("{}{}\n", one.words,
                            one.seconds_before ? fmt::format("  {:.3g} s last time", *one.seconds_before) : "");
    }
    write_output("", list);
    if (!options.quiet)
        fmt::print(stderr, "{}: {} cases to run; {} of them took {:.3g} s last time, truths aside\n",
                   plan.experiment.name, pending.size(), known, total);
}

int run_command(const RunCommandOptions& options) {
    const RunOptions checked_options = checked(options);
    // all are read before any is run: a slip in the last must not cost the time of the first
    std::vector<Plan> plans;
    for (const std::string& name : options.experiments)
        plans.push_back(make_plan(find_experiment(name), name, options.quick));
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
    for (const Plan& plan : plans) {
        if (options.dry_run)
            list_pending(plan, checked_options);
        else if (!run_experiment(plan, checked_options, command_line(options)))
            return 128 + SIGINT;  // as a shell says of a program that Ctrl-C ended
    }
    return 0;
}

}  // namespace

void add_run(CLI::App& program, int& exit_code) {
    CLI::App* command =
        program.add_subcommand("run", "Runs experiments into tables and pictures; goes on where it was interrupted.");
    const auto options = std::make_shared<RunCommandOptions>();
    command->add_option("EXPERIMENT", options->experiments, "Experiments: names (polhode list experiments) or files")
        ->required();
    engines_option(*command);
    outside_option(*command);
    command->add_option("--filter", options->filter, "Only the cases whose SCENE/METHOD matches this expression");
    command->add_option("--output", options->output,
                        "Directory (default build/results, with --quick build/quick; published tables are overwritten "
                        "only where it says so)");
    command->add_option("--jobs", options->jobs,
                        "Threads for truths and errors (default: all cores); timings run alone");
    command->add_option("--shard", options->shard, "I/N: the I-th of N parts, over the same directory")
        ->capture_default_str();
    command->add_flag("--quick", options->quick, "Every third setting, short runs");
    command->add_flag("--dry-run", options->dry_run, "Only list what would run, and how long it took last time");
    command->add_flag("--quiet", options->quiet, "No progress, no summary");
    command->callback([options, &exit_code] { exit_code = run_command(*options); });
}

}  // namespace polhode
