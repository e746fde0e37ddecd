// polhode run: runs experiments and writes tables and figures.
#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "app/commands.h"
#include "app/submit_scripts.h"
#include "experiment/plan/experiment.h"
#include "experiment/plan/pattern.h"
#include "experiment/run/costs.h"
#include "experiment/run/formats.h"
#include "experiment/run/run_experiment.h"
#include "table/table.h"
#include "text/json_document.h"
#include "text/message.h"

namespace polhode {
namespace {

struct RunCommandOptions {
    std::vector<std::string> experiments;
    std::string filter, output, shard = "1/1", plan, measured, formats = "csv," + Formats().text();
    int jobs = 0;
    bool quick = false, dry_run = false, quiet = false;
};

// The first Ctrl-C stops after the current case; the second ends the program.
extern "C" void on_interrupt(int) {
    interrupt_sweep();
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
}

Costs read_plan(const std::string& path) {
    constexpr std::size_t largest_plan_file = std::size_t{1} << 30;
    const std::string text =
        read_text(path, largest_plan_file, "a plan that `polhode run --dry-run --plan FILE` wrote");
    try {
        return {parse_csv(text), one_line(path, 300)};
    } catch (const std::invalid_argument& fault) {
        throw InputError(one_line(path, 300), "", one_line(fault.what(), 200),
                         "give a plan that `polhode run --dry-run --plan FILE` wrote");
    }
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
        throw UsageError(fmt::format("--shard is {}; give I/N with 1 <= I <= N", options.shard));
    if (options.jobs < 0 || options.jobs > 4096)
        throw UsageError(fmt::format("--jobs is {}; give 1 to 4096", options.jobs));
    run.jobs = options.jobs > 0 ? options.jobs : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    run.directory = !options.output.empty() ? options.output : options.quick ? "build/quick" : "build/results";
    if (std::error_code none; std::filesystem::exists(std::filesystem::symlink_status(run.directory, none)) &&
                              !std::filesystem::is_directory(run.directory, none))
        throw UsageError(
            fmt::format("--output is {}, not a directory; give a directory", one_line(run.directory, 200)));
    run.quick = options.quick, run.quiet = options.quiet;
    run.formats = as_usage([&] { return parse_formats(options.formats); }, "--formats: ");
    if (!options.plan.empty() && options.dry_run) {
        require_output(options.plan);
    } else if (!options.plan.empty()) {
        if (run.shards == 1) throw UsageError("--plan requires --shard I/N or --dry-run; give one of them");
        run.costs = std::make_shared<const Costs>(read_plan(options.plan));
    }
    if (!options.measured.empty() && !(options.dry_run && !options.plan.empty()))
        throw UsageError("--measured requires --dry-run --plan FILE; give both");
    return run;
}

std::string command_line(const RunCommandOptions& options) {
    std::string line = "polhode run";
    for (const std::string& name : options.experiments) line += " " + shell_word(name);
    if (!options.filter.empty()) line += " --filter " + shell_word(options.filter);
    if (options.shard != "1/1") line += " --shard " + options.shard;
    if (!options.plan.empty()) line += " --plan " + shell_word(options.plan);
    if (options.formats != RunCommandOptions().formats) line += " --formats " + shell_word(options.formats);
    if (options.quick) line += " --quick";
    return line;
}

// Lists the pending cases on standard output, one per line.
void list_pending(const Plan& plan, const RunOptions& options) {
    double total = 0;
    long known = 0;
    std::string list;
    const std::vector<PendingCase> pending = pending_work(plan, options);
    for (const PendingCase& one : pending) {
        if (one.seconds_before) total += *one.seconds_before, ++known;
        list += fmt::format("{}{}\n", one.description,
                            one.seconds_before ? fmt::format("  {:.3g} s in the last run", *one.seconds_before) : "");
    }
    write_output("", list);
    if (!options.quiet)
        fmt::print(stderr, "{}: {} cases to run; {} of them took {:.3g} s in the last run, without truths\n",
                   plan.experiment.name, pending.size(), known, total);
}

void print_costs(const Table& costs, const std::string& path) {
    double total = 0;
    std::size_t measured = 0;
    for (const std::vector<Cell>& row : costs.rows) {
        total += std::get<double>(row[row.size() - 2]);
        measured += text_of(row.back()) == "measured" ? 1 : 0;
    }
    fmt::print(stderr, "{}: {} cases and truths, {:.3g} s in total; {} of them measured\n", one_line(path, 300),
               costs.rows.size(), total, measured);
}

int run_command(const RunCommandOptions& options) {
    const RunOptions checked_options = checked(options);
    // read all experiments before running one, so that an error in the last is found at once
    std::vector<Plan> plans;
    for (const std::string& name : options.experiments)
        plans.push_back(make_plan(find_experiment(name), name, options.quick));
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
    if (options.dry_run && !options.plan.empty()) {
        const std::string& measured = options.measured.empty() ? checked_options.directory : options.measured;
        Table costs{Costs::columns(), {}};
        for (const Plan& plan : plans)
            for (std::vector<Cell>& row : work_cost_table(plan, measured).rows) costs.rows.push_back(std::move(row));
        write_output(options.plan, csv(costs));
        if (!options.quiet) print_costs(costs, options.plan);
        return 0;
    }
    for (const Plan& plan : plans) {
        if (options.dry_run)
            list_pending(plan, checked_options);
        else if (!run_experiment(plan, checked_options, command_line(options)))
            return 128 + SIGINT;  // the exit code of a shell for a program ended by Ctrl-C
    }
    return 0;
}

}  // namespace

void add_run(CLI::App& program, int& exit_code) {
    CLI::App* command =
        program.add_subcommand("run", "Runs experiments and writes tables and figures. Continues an interrupted run.");
    command->footer(
        "Examples:\n"
        "  polhode run convergence --quick\n"
        "  polhode run mine.json --output results --jobs 4\n"
        "  polhode run contrast --shard 1/3 --output shards/1\n");
    const auto options = std::make_shared<RunCommandOptions>();
    command
        ->add_option("EXPERIMENT", options->experiments,
                     "Experiments: built-in names (see polhode list experiments) or files")
        ->required();
    add_engines_option(*command);
    add_outside_option(*command);
    command->add_option("--filter", options->filter,
                        "Run only cases whose SCENE/METHOD matches this POSIX extended regular expression");
    command->add_option("--output", options->output,
                        "Output directory (default build/results, or build/quick with --quick)");
    command->add_option("--jobs", options->jobs,
                        "Threads for truths and errors (default: all cores). Timed runs run one at a time");
    command
        ->add_option("--shard", options->shard,
                     "I/N: run part I of N. Shards may share a directory or use separate ones (see polhode merge)")
        ->capture_default_str();
    command->add_option("--plan", options->plan,
                        "With --dry-run: write all cases and their expected seconds to this CSV file. "
                        "With --shard: distribute the cases by this file, which must be the same for all shards");
    command->add_option("--measured", options->measured,
                        "With --dry-run --plan: result directory that provides run times (default: --output)");
    command->add_option("--formats", options->formats, "Formats of tables and figures. CSV is always written")
        ->capture_default_str();
    command->add_flag("--quick", options->quick, "Use every third setting and short runs");
    command->add_flag("--dry-run", options->dry_run, "Only list the cases to run and their time in the last run");
    command->add_flag("--quiet", options->quiet, "Print neither progress nor a summary");
    command->callback([options, &exit_code] { exit_code = run_command(*options); });
}

}  // namespace polhode
