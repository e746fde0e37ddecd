// polhode report: writes a result directory as one HTML page.
#include "report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <thread>

#include "app/commands.h"
#include "check/check_files.h"
#include "report/lessons.h"
#include "text/message.h"

namespace polhode {
namespace {

struct ReportOptions {
    ReportRequest request;
    std::string convention, lesson;
    bool without_motions = false, quiet = false;
};

void print_summary(const ReportSummary& made) {
    for (const std::string& remark : made.remarks) fmt::print(stderr, "{}\n", one_line(remark, 500));
    fmt::print(stderr, "{}: {:.1f} MB\n", one_line(made.path, 300), static_cast<double>(made.bytes) / 1e6);
}

int report_lesson(const ReportOptions& options) {
    const ReportRequest& request = options.request;
    if (!request.directory.empty() || !request.against.empty() || !request.trajectories.empty() ||
        !request.scene.empty() || !options.convention.empty() || options.without_motions)
        throw UsageError("--lesson makes a page of a lesson only; give just --output and --quiet with it");
    const ReportSummary made = write_lesson_page(options.lesson, request.output);
    if (!options.quiet) print_summary(made);
    return 0;
}

int report_command(ReportOptions options) {
    ReportRequest& request = options.request;
    if (!request.output.empty() && !request.output.ends_with(".html"))
        throw UsageError("--output must end in .html; give NAME.html");
    require_output(request.output);
    if (!options.lesson.empty()) return report_lesson(options);
    if (request.directory.empty()) throw UsageError("DIR is missing; give a result directory, or --lesson NAME");
    request.convention = parse_convention_option(options.convention);
    if (request.trajectories.empty() && !(request.scene.empty() && options.convention.empty()))
        throw UsageError("--scene and --convention require --trajectory; give --trajectory FILE.csv");
    if (request.jobs < 0 || request.jobs > 4096)
        throw UsageError(fmt::format("--jobs is {}; give 1 to 4096", request.jobs));
    if (request.jobs == 0) request.jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    request.motions = !options.without_motions;
    try {
        const ReportSummary made = write_report_page(request);
        if (!options.quiet) print_summary(made);
    } catch (const TruthUnavailable& fault) {
        std::fputs(("polhode: " + one_line(fault.what(), 500) + "\n").c_str(), stderr);
        return 1;
    }
    return 0;
}

}  // namespace

void add_report(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand(
        "report",
        "Writes a result directory as one interactive HTML page that works offline: zoomable curves, sortable "
        "tables, animated motions.");
    command->footer(
        "Examples:\n"
        "  polhode report build/results\n"
        "  polhode report new --against old --output comparison.html\n"
        "  polhode report build/results --trajectory mine.csv --scene lagrange_top\n"
        "  polhode report --lesson spinning_top\n");
    const auto options = std::make_shared<ReportOptions>();
    command->add_option("DIR", options->request.directory, "Result directory written by polhode run");
    add_engines_option(*command);
    add_outside_option(*command);
    command->add_option("--output", options->request.output, "Output file F.html (default: report.html in DIR)");
    command->add_option("--against", options->request.against,
                        "Second result directory of the same experiments, from another machine or version, to compare "
                        "run times and errors with");
    command->add_option("--trajectory", options->request.trajectories,
                        "Trajectory files to compare with the truth, as polhode check does, and to animate beside it");
    command->add_option("--scene", options->request.scene,
                        "Scene of the trajectory files (default: the scene in DIR that the first file is named after, "
                        "or the only scene in DIR)");
    command->add_option("--convention", options->convention,
                        "Convention of the trajectory files (see polhode check --help)");
    command->add_option("--jobs", options->request.jobs, "Number of threads (default: all cores)");
    command->add_option("--lesson", options->lesson,
                        "Make a page of one live lesson instead, F.html or NAME.html: " +
                            join_with_commas(builtin_lesson_names()) + ", or a lesson file");
    command->add_flag("--without-motions", options->without_motions, "Do not solve scenes: omit the animated motions");
    command->add_flag("--quiet", options->quiet, "Do not print a summary");
    command->callback([options, &exit_code] { exit_code = report_command(*options); });
}

}  // namespace polhode
