// polhode export: exports the truth of a scene as golden data for the unit tests of an engine.
#include <fmt/format.h>

#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "app/commands.h"
#include "app/lookup.h"
#include "check/golden.h"
#include "integrators/contact/solve_contacts.h"
#include "scene/joint_motions.h"
#include "scene/scene_file.h"
#include "scene/scene_formulas.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr long most_golden_samples = 100'000;

struct ExportOptions {
    std::string scene, format = "csv", output, convention;
    std::optional<double> duration;
    long samples = 100;
    bool floats = false;
};

const std::map<std::string, GoldenFormat> golden_formats{{"csv", GoldenFormat::csv},
                                                         {"json", GoldenFormat::json},
                                                         {"c", GoldenFormat::c},
                                                         {"cpp", GoldenFormat::cpp},
                                                         {"cs", GoldenFormat::csharp}};

// Formulas are exported as text. Throws InputError if they would have to be code or converted.
void require_representable(const ExportOptions& options, const Scene& scene, const Convention& convention) {
    const bool has_loads = has_formula_loads(scene);
    if (!has_loads && !has_joint_motions(scene)) return;
    const std::string place = has_loads ? "/loads" : "/joints", part = has_loads ? "formula" : "prescribed motion";
    if (options.format != "json" && options.format != "csv")
        throw InputError(options.scene, place,
                         fmt::format("contain a {}, which the format {} cannot represent", part, options.format),
                         "give --format json, which contains it as text, or --format csv");
    if (convention.axes != Axes::z_up_right || convention.length_unit != 1)
        throw InputError(options.scene, place,
                         fmt::format("contain a {}, which cannot be converted to other axes or units", part),
                         "remove axes and lengths from --convention");
}

int export_command(const ExportOptions& options) {
    require_count("--samples", options.samples, most_golden_samples);
    if (options.duration) require_positive("--duration", *options.duration);
    const Convention convention = parse_convention_option(options.convention);
    require_output(options.output);
    Scene scene = read_scene_with_notes(options.scene);
    require_states(scene, options.samples);
    if (options.duration) scene.duration = *options.duration;
    require_representable(options, scene, convention);
    const Reference truth = reference(scene, options.samples);
    if (!truth.available) {
        std::fputs(("polhode: " + one_line(truth.message, 500) + "\n").c_str(), stderr);
        return 1;
    }
    std::vector<DecimalContactEvent> events;
    if (contact::has_events(scene)) events = decimal_reference(scene, options.samples).contact_events;
    const Golden data = golden(scene, truth, convention, events);
    std::string text;
    try {
        text = golden_text(data, golden_formats.at(options.format), options.floats);
    } catch (const std::invalid_argument& error) {
        throw InputError(options.scene, "", "a number cannot be exported", error.what());
    }
    write_output(options.output, text);
    std::string summary = fmt::format("scene      {}\ntruth      {}\nbound      {:.2e}\n", one_line(scene.name, 100),
                                      truth.message, data.bound);
    for (const GoldenTolerance& t : data.tolerances)
        summary += fmt::format("tolerance  {}: {:.4g} ({})\n", t.block, t.value, t.from);
    if (!data.events.empty())
        summary += fmt::format("events     {}, tolerance {:.4g} s (a step at 60 Hz)\n", data.events.size(),
                               golden_event_tolerance);
    std::fputs(summary.c_str(), stderr);
    return 0;
}

}  // namespace

void add_export(CLI::App& program, int& exit_code) {
    CLI::App* command =
        program.add_subcommand("export",
                               "Exports golden data of a scene for the unit tests of an engine: body, shape, planes, "
                               "loads, initial state, the "
                               "truth at N + 1 times with its error bound, its events at contacts and joints, and a "
                               "tolerance for each block.");
    command->footer(
        "The tolerance of a block is the scene's \"tolerated\". If there is none, it is the larger of the default of\n"
        "polhode check and ten times the error caused by rounding the initial state to binary32.\n"
        "\n"
        "Examples:\n"
        "  polhode export t_handle --format cpp --output t_handle.h\n"
        "  polhode export lagrange_top --format cs --floats --convention unity --output Top.cs\n");
    const auto options = std::make_shared<ExportOptions>();
    command->add_option("SCENE", options->scene, "A built-in scene (polhode list scenes) or a scene file")->required();
    command->add_option("--samples", options->samples, "Number of sample intervals N: samples at k T/N, k = 0..N")
        ->capture_default_str();
    command
        ->add_option("--format", options->format,
                     "Output format: csv, json, c (header with arrays and a comparison function, C99 and C++), cpp "
                     "(header for C++17) or cs (static class for C#)")
        ->check(CLI::IsMember(golden_formats))
        ->capture_default_str();
    command->add_flag("--floats", options->floats, "Write binary32 numbers in their shortest form, and float arrays");
    command->add_option("--duration", options->duration, "Duration T in s (default: the scene's)");
    command->add_option("--convention", options->convention,
                        "Convention to convert all data to (words: see polhode check --help)");
    command->add_option("--output", options->output, "Output file (default: stdout)");
    add_outside_option(*command);
    command->callback([options, &exit_code] { exit_code = export_command(*options); });
}

}  // namespace polhode
