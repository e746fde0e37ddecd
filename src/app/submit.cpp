// polhode submit: writes scripts that run an experiment in shards with a workflow engine.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "app/commands.h"
#include "app/submit_scripts.h"
#include "experiment/plan/experiment.h"
#include "experiment/run/costs.h"
#include "experiment/run/run_experiment.h"
#include "integrators/engines/engine_methods.h"
#include "table/table.h"
#include "text/message.h"
#include "text/named_file.h"

namespace polhode {
namespace {

namespace fs = std::filesystem;

struct SubmitOptions {
    std::string engine, experiment, output, measured, program;
    std::vector<std::string> engine_files;
    int shards = 0, jobs = 1;
    bool quick = false, allow_outside = false, quiet = false;
};

std::string absolute(const std::string& path) { return fs::absolute(path).lexically_normal().string(); }

std::string program_path() {
    std::error_code none;
    const fs::path path = fs::read_symlink("/proc/self/exe", none);
    return none ? "polhode" : path.string();
}

// Returns the expected time of the longest shard, s.
double longest_shard_seconds(const Plan& plan, const Costs& costs, int shards) {
    std::vector<double> seconds(static_cast<std::size_t>(shards), 0.0);
    const std::vector<std::vector<int>> assignment = assign_shards(plan, costs, shards);
    for (std::size_t s = 0; s < assignment.size(); ++s) {
        std::vector<int> with_truth;
        for (std::size_t c = 0; c < assignment[s].size(); ++c) {
            const int shard = assignment[s][c];
            seconds[static_cast<std::size_t>(shard)] += costs.curve_seconds(plan, plan.scenes[s], plan.curves[c]);
            if (std::find(with_truth.begin(), with_truth.end(), shard) != with_truth.end()) continue;
            with_truth.push_back(shard);
            seconds[static_cast<std::size_t>(shard)] += costs.truth_seconds(plan, plan.scenes[s]);
        }
    }
    return *std::max_element(seconds.begin(), seconds.end());
}

int submit_command(const SubmitOptions& options) {
    constexpr int most_shards = 999'999, most_jobs = 4096;
    require_count("--shards", options.shards, most_shards);
    require_count("--jobs", options.jobs, most_jobs);
    const Plan plan = make_plan(find_experiment(options.experiment), options.experiment, options.quick);
    const std::string output =
        absolute(options.output.empty() ? (options.quick ? "build/quick" : "build/results") : options.output);
    for (const std::string& text : {output, options.experiment, options.program})
        if (std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; }))
            throw UsageError(
                "--output, --program or the experiment's file contains control characters; remove them from the name");
    std::error_code none;
    Submission submission;
    submission.name = plan.experiment.name;
    submission.program = options.program.empty() ? program_path() : options.program;
    submission.experiment = fs::exists(options.experiment, none) ? absolute(options.experiment) : options.experiment;
    submission.output = output;
    submission.plan = (fs::path(output) / (submission.name + ".plan.csv")).string();
    if (options.quick) submission.options.emplace_back("--quick");
    for (const std::string& file : options.engine_files)
        for (std::vector<std::string>* list : {&submission.options, &submission.merge_options})
            list->insert(list->end(), {"--engines", absolute(file)});
    for (std::vector<std::string>* list : {&submission.options, &submission.merge_options})
        if (options.allow_outside) list->emplace_back("--allow-outside");
    submission.shards = options.shards, submission.jobs = options.jobs;
    const Table costs = work_cost_table(plan, options.measured.empty() ? output : options.measured);
    double whole = 0;
    // an experiment that is computed as a whole runs in the first shard
    if (costs.rows.size() == 1) whole = std::get<double>(costs.rows.front()[costs.rows.front().size() - 2]);
    const double dearest =
        std::max(whole, longest_shard_seconds(plan, Costs(parse_csv(csv(costs)), submission.plan), options.shards));
    submission.seconds = std::lround(std::min(1e8, std::ceil(3 * dearest + 600)));
    const std::string path = (fs::path(output) / script_name(options.engine, submission)).string();
    fs::create_directories(output);
    write_output(submission.plan, csv(costs));
    write_output(path, submit_script(options.engine, submission));
    if (!options.quiet)
        fmt::print(stderr, "{}: expected time of the longest of {} shards: {:.3g} s; run {}\n", submission.name,
                   options.shards, dearest,
                   options.engine == "snakemake" ? "snakemake --snakefile " + shell_word(path) + " --cores all"
                                                 : "bash " + shell_word(path));
    return 0;
}

}  // namespace

void add_submit(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand(
        "submit",
        "Writes a script that runs an experiment in shards on a cluster or in many processes and merges the results. "
        "Shards are balanced by measured run times. Nothing is run.");
    command->footer(
        "Examples:\n"
        "  polhode submit slurm contrast --shards 100\n"
        "  polhode submit parallel mine.json --shards 8 --output results\n");
    const auto options = std::make_shared<SubmitOptions>();
    command->add_option("ENGINE", options->engine, "Workflow engine: slurm, parallel (GNU parallel) or snakemake")
        ->required()
        ->check(CLI::IsMember({"slurm", "parallel", "snakemake"}));
    command
        ->add_option("EXPERIMENT", options->experiment,
                     "Experiment: a built-in name (see polhode list experiments) or a file")
        ->required();
    command->add_option("--shards", options->shards, "Number of shards")->required();
    command->add_option("--output", options->output,
                        "Directory for the script, plan, shards and merged tables (default build/results, or "
                        "build/quick with --quick)");
    command->add_option("--measured", options->measured,
                        "Result directory that provides run times for the plan (default: --output)");
    command->add_option("--jobs", options->jobs, "Number of threads of each shard")->capture_default_str();
    command->add_option("--program", options->program,
                        "Path of polhode on the machines that run the shards (default: the path of this program)");
    command->add_flag("--quick", options->quick, "Use every third setting and short runs");
    command
        ->add_option("--engines", options->engine_files,
                     "JSON file of further engines, as for polhode run; also passed to each shard")
        ->each([](const std::string& path) { add_engines(path); });
    command->add_flag("--allow-outside", options->allow_outside,
                      "Allow scene and experiment files to name files outside their directories; also passed to each "
                      "shard");
    command->add_flag("--quiet", options->quiet, "Do not print a summary");
    command->callback([options, &exit_code] {
        if (options->allow_outside) allow_outside_files(true);
        exit_code = submit_command(*options);
    });
}

}  // namespace polhode
