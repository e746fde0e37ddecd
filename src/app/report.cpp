// polhode report: a folder of results as one page.
#include "report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <thread>

#include "app/commands.h"
#include "check/check_files.h"
#include "text/message.h"

namespace polhode {
namespace {

struct ReportOptions {
    ReportRequest request;
    std::string convention;
    bool without_motions = false, quiet = false;
};

int report_command(ReportOptions options) {
    ReportRequest& request = options.request;
    request.convention = convention_option(options.convention);
    if (request.trajectories.empty() && !(request.scene.empty() && options.convention.empty()))
        throw UsageError("--scene and --convention are of trajectories; give --trajectory FILE.csv as well");
    if (!request.output.empty() && !request.output.ends_with(".html"))
        throw UsageError("--output: is no name of an HTML file; give NAME.html");
    require_output(request.output);
    if (request.jobs < 0 || request.jobs > 4096)
        throw UsageError(fmt::format("--jobs is {}; give 1 to 4096", request.jobs));
    if (request.jobs == 0) request.jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    request.motions = !options.without_motions;
    try {
        const ReportMade made = write_report_page(request);
        if (!options.quiet) {
            for (const std::string& remark : made.remarks) fmt::print(stderr, "{}\n", one_line(remark, 500));
            fmt::print(stderr, "{}: {:.1f} MB\n", one_line(made.path, 300), static_cast<double>(made.bytes) / 1e6);
        }
    } catch (const NoTruth& fault) {
        std::fputs(("polhode: " + one_line(fault.what(), 500) + "\n").c_str(), stderr);
        return 1;
    }
    return 0;
}

}  // namespace

void add_report(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand(
        "report",
        "Writes one page (HTML, to be opened from disk, without a network) of all that a folder tells: curves "
        "to zoom into, tables to sort, motions to watch.");
    const auto options = std::make_shared<ReportOptions>();
    command->add_option("DIR", options->request.directory, "A folder that `polhode run` has written")->required();
    engines_option(*command);
    outside_option(*command);
    command->add_option("--output", options->request.output, "F.html (default: report.html in that folder)");
    command->add_option("--against", options->request.against,
                        "A second folder of the same experiments, from another machine or version: how run times and "
                        "errors compare");
    command->add_option("--trajectory", options->request.trajectories,
                        "Trajectory files of your own, to be judged as `polhode check` does and to be watched beside "
                        "the truth");
    command->add_option("--scene", options->request.scene,
                        "Their scene (default: the one of the folder that the first file is named after, or its only "
                        "one)");
    command->add_option("--convention", options->convention, "What they are written in; see polhode check --help");
    command->add_option("--jobs", options->request.jobs, "Threads (default: all cores)");
    command->add_flag("--without-motions", options->without_motions, "Solve nothing: no bodies to watch");
    command->add_flag("--quiet", options->quiet, "No summary");
    command->callback([options, &exit_code] { exit_code = report_command(*options); });
}

}  // namespace polhode
