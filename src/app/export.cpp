// polhode export: a scene's truth as golden data for an engine's own unit tests.
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
#include "scene/scene_file.h"
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

int export_command(const ExportOptions& options) {
    require_count("--samples", options.samples, most_golden_samples);
    if (options.duration) require_positive("--duration", *options.duration);
    const Convention convention = convention_option(options.convention);
    require_output(options.output);
    Scene scene = read_scene_with_notes(options.scene);
    require_states(scene, options.samples);
    if (options.duration) scene.duration = *options.duration;
    const Reference truth = reference(scene, options.samples);
    if (!truth.available) {
        std::fputs(("polhode: " + one_line(truth.message, 500) + "\n").c_str(), stderr);
        return 1;
    }
    const Golden data = golden(scene, truth, convention);
    std::string text;
    try {
        text = golden_text(data, golden_formats.at(options.format), options.floats);
    } catch (const std::invalid_argument& error) {
        throw InputError(options.scene, "", "a number cannot be written", error.what());
    }
    write_output(options.output, text);
    std::string told = fmt::format("scene      {}\ntruth      {}\nbound      {:.2e}\n", one_line(scene.name, 100),
                                   truth.message, data.bound);
    for (const GoldenTolerance& t : data.tolerances)
        told += fmt::format("tolerance  {}: {:.4g} ({})\n", t.block, t.value, t.from);
    std::fputs(told.c_str(), stderr);
    return 0;
}

}  // namespace

void add_export(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand(
        "export",
        "Golden data of a scene for an engine's own unit tests: the body and its shape, planes, loads, its start, the "
        "true "
        "motion at N + 1 times, its bound, and what each block may be off (what the scene tolerates, else what check "
        "allows or ten times what rounding the start to binary32 leads to, whichever is more).");
    const auto options = std::make_shared<ExportOptions>();
    command->add_option("SCENE", options->scene, "A built-in scene (polhode list scenes) or a scene file")->required();
    command->add_option("--samples", options->samples, "N: samples at k T/N, k = 0..N")->capture_default_str();
    command
        ->add_option("--format", options->format,
                     "csv, json, c (a header of arrays and a comparison for C99 and C++), cpp (for C++17) or "
                     "cs (a static class for C#)")
        ->check(CLI::IsMember(golden_formats))
        ->capture_default_str();
    command->add_flag("--floats", options->floats, "Numbers of binary32: arrays of float, as short as they can be");
    command->add_option("--duration", options->duration, "T in s, in place of the scene's");
    command->add_option(
        "--convention", options->convention,
        "What to write it in, words as for polhode check: body, planes, loads, start and motion are converted");
    command->add_option("--output", options->output, "File to write, in place of stdout");
    outside_option(*command);
    command->callback([options, &exit_code] { exit_code = export_command(*options); });
}

}  // namespace polhode
