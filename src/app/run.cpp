// polhode run: experiments into tables and pictures.
#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "app/commands.h"
#include "experiment/kinds/report.h"
#include "experiment/plan/experiment.h"
#include "experiment/plan/pattern.h"
#include "experiment/run/case_store.h"
#include "experiment/run/locks.h"
#include "experiment/run/study.h"
#include "experiment/run/sweep.h"
#include "text/message.h"

namespace polhode {
namespace {

struct Options {
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

RunOptions checked(const Options& options) {
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
    run.directory = !options.output.empty() ? options.output : options.quick ? "build/quick" : "results";
    if (std::filesystem::exists(run.directory) && !std::filesystem::is_directory(run.directory))
        throw UsageError(fmt::format("--output {} is no directory", one_line(run.directory, 200)));
    run.quick = options.quick, run.dry_run = options.dry_run, run.quiet = options.quiet;
    return run;
}

std::string command_line(const Options& options) {
    std::string line = "polhode run";
    for (const std::string& name : options.experiments) line += " " + name;
    if (!options.filter.empty()) line += " --filter '" + options.filter + "'";
    if (options.shard != "1/1") line += " --shard " + options.shard;
    if (options.quick) line += " --quick";
    return line;
}

// An experiment that is one function: done or not, as a whole.
bool run_study(const Plan& plan, const RunOptions& options, const std::string& line) {
    const std::string& name = plan.experiment.name;
    const std::string key = study_key(plan, options.quick);
    const bool done = is_done(options.directory, key);
    if (options.dry_run) {
        const std::optional<double> before = load_duration(options.directory, name);
        if (!done) write_output("", name + (before ? fmt::format("  {:.3g} s last time\n", *before) : "\n"));
        return true;
    }
    const Study& study = *find_study(plan.experiment.study);
    // the first shard has all of one that cannot be cut
    if (done || (options.shard > 1 && !study.resumable)) {
        if (!options.quiet)
            fmt::print(stderr, "{}: {}\n", name, done ? "nothing left to do" : "left to the first shard");
        return true;
    }
    const std::atomic<bool> patient{false};
    StudyResult result;
    double seconds = 0;
    {
        const FileLock alone(machine_lock_file(), FileLock::Kind::exclusive, patient);
        const auto start = std::chrono::steady_clock::now();
        result = study.run(plan, options);
        seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
    if (study.resumable && sweep_interrupted()) {
        fmt::print(stderr, "polhode: {} interrupted; run again to go on\n", name);
        return false;
    }
    const FileLock one_writer(report_lock_file(options.directory), FileLock::Kind::exclusive, patient);
    const std::vector<std::string> remarks = write_study_report(plan, result, options.directory, line, options.quick);
    if (result.complete) save_done(options.directory, key);
    save_duration(options.directory, name, seconds);
    if (!options.quiet)
        fmt::print(stderr, "{}: {} tables, {} pictures in {}, {:.3g} s\n", name, result.tables.size(),
                   result.figures.size(), options.directory, seconds);
    for (const std::string& remark : remarks) fmt::print(stderr, "polhode: {}\n", one_line(remark, 500));
    return true;
}

// One experiment: its rows, tables and pictures. False when it was interrupted.
bool run_one(const Plan& plan, const RunOptions& options, const std::string& line) {
    if (plan.experiment.kind == Kind::study) return run_study(plan, options, line);
    const std::string& name = plan.experiment.name;
    if (options.dry_run) {
        double total = 0;
        long pending = 0, known = 0;
        std::string list;
        for (const PendingCase& one : pending_cases(plan, options)) {
            ++pending;
            if (one.seconds_before) total += *one.seconds_before, ++known;
            list += fmt::format("{}{}\n", one.words,
                                one.seconds_before ? fmt::format("  {:.3g} s last time", *one.seconds_before) : "");
        }
        write_output("", list);
        if (!options.quiet)
            fmt::print(stderr, "{}: {} cases to run; {} of them took {:.3g} s last time, truths aside\n", name, pending,
                       known, total);
        return true;
    }
    const SweepCount count = run_sweep(plan, options);
    if (sweep_interrupted()) {
        fmt::print(stderr, "polhode: {} interrupted after {} cases; run again to go on\n", name, count.run);
        return false;
    }
    // whatever is finished in this directory: other shards and earlier runs included
    const std::atomic<bool> patient{false};
    const FileLock one_writer(report_lock_file(options.directory), FileLock::Kind::exclusive, patient);
    const std::vector<Result> results = finished_results(plan, options.directory);
    const std::vector<std::string> remarks = write_report(plan, results, options.directory, line, options.quick);
    if (!options.quiet)
        fmt::print(stderr, "{}: {} rows in {}, {} run now\n", name, results.size(), options.directory, count.run);
    for (const std::string& remark : remarks) fmt::print(stderr, "polhode: {}\n", one_line(remark, 500));
    return true;
}

int run(const Options& options) {
    const RunOptions checked_options = checked(options);
    // all are read before any is run: a slip in the last must not cost the time of the first
    std::vector<Plan> plans;
    for (const std::string& name : options.experiments)
        plans.push_back(make_plan(find_experiment(name), name, options.quick));
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
    for (const Plan& plan : plans)
        if (!run_one(plan, checked_options, command_line(options))) return 1;
    return 0;
}

}  // namespace

void add_run(CLI::App& program, int& exit_code) {
    CLI::App* command =
        program.add_subcommand("run", "Runs experiments into tables and pictures; goes on where it was interrupted.");
    const auto options = std::make_shared<Options>();
    command->add_option("EXPERIMENT", options->experiments, "Experiments: names (polhode list experiments) or files")
        ->required();
    command->add_option("--filter", options->filter, "Only the cases whose SCENE/METHOD matches this expression");
    command->add_option("--output", options->output, "Directory (default results, with --quick build/quick)");
    command->add_option("--jobs", options->jobs,
                        "Threads for truths and errors (default: all cores); timings run alone");
    command->add_option("--shard", options->shard, "I/N: the I-th of N parts, over the same directory")
        ->capture_default_str();
    command->add_flag("--quick", options->quick, "Every third setting, short runs");
    command->add_flag("--dry-run", options->dry_run, "Only list what would run, and how long it took last time");
    command->add_flag("--quiet", options->quiet, "No progress, no summary");
    command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace polhode
