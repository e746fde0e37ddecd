// polhode describe: prints a description of a scene, a method or an experiment.
#include "app/describe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "app/commands.h"
#include "app/lookup.h"
#include "app/polhode_picture.h"
#include "experiment/plan/experiment.h"
#include "integrators/analysis/linear_stability.h"
#include "integrators/engines/engine_methods.h"
#include "scene/builtin.h"
#include "scene/scene_file.h"
#include "text/json_document.h"
#include "text/message.h"

namespace polhode {
namespace {

const char* control_text(Control control) {
    switch (control) {
        case Control::none:
            return "none: takes neither a step nor a tolerance";
        case Control::fixed_step:
            return "a fixed step (--step, --steps)";
        case Control::tolerance:
            return "a tolerance (--tolerance)";
        case Control::fixed_step_or_tolerance:
            break;
    }
    return "a fixed step (--step, --steps) or a tolerance (--tolerance)";
}

// Returns whether a name or file is an experiment. Errors of unreadable files are reported by the reader of scenes.
bool is_experiment(const std::string& name) {
    if (!builtin_experiment_text(name).empty()) return true;
    if (std::error_code none; !std::filesystem::is_regular_file(name, none)) return false;
    try {
        const JsonDocument document(read_text(name), name);
        const JsonNode& root = document.root();
        return root.is_object() && !root.find("body") && !root.find("bodies") && !root.find("import") &&
               (root.find("kind") || root.find("scenes") || root.find("methods"));
    } catch (const InputError&) {
        return false;
    }
}

// "1e-2 to 1e-5 (4)"
std::string describe_curve(const PlannedCurve& curve) {
    if (curve.kind == SettingKind::none) return std::string(curve.method->name);
    const auto [low, high] = std::ranges::minmax(curve.settings);
    return fmt::format("{}, {}s {:.4g} to {:.4g} ({})", curve.method->name,
                       curve.calibrated ? "evaluations per revolution by " + std::string(name_of(curve.kind))
                                        : std::string(name_of(curve.kind)),
                       high, low, curve.settings.size());
}

// Describes the cases of an experiment and where its results go.
std::string describe_experiment(const std::string& name) {
    const Plan plan = make_plan(find_experiment(name), name, false);
    const Experiment& e = plan.experiment;
    std::string text = fmt::format("{}\n\n  {}\n\n  kind     {}\n", e.name, one_line(e.about, 2000), e.kind->name);
    const auto list = [&](const char* title, const std::vector<std::string>& entries) {
        for (std::size_t i = 0; i < entries.size(); ++i)
            text += fmt::format("  {:<7}  {}\n", i == 0 ? title : "", entries[i]);
    };
    std::vector<std::string> scenes, methods;
    for (const PlannedScene& scene : plan.scenes) scenes.push_back(scene.label);
    std::size_t cases = 0;
    for (const PlannedCurve& curve : plan.curves) {
        methods.push_back(describe_curve(curve));
        cases += curve.settings.size() * plan.scenes.size();
    }
    list("scenes", scenes);
    list("methods", methods);
    if (!e.kind->make)
        text += fmt::format("  cases    {}, each repeated at most {} times, at most {:.4g} s per run\n", cases,
                            e.repeats, e.seconds_per_run);
    return text +
           fmt::format("  command  polhode run {}: writes tables and figures to build/results/{}*\n", name, e.name);
}

// Describes an engine: the method, the version of the engine, and its settings.
std::string describe_engine(const EngineMethod& engine) {
    std::string text = describe_method(*engine.method);
    const EngineReport report = engine.inspect(nullptr);
    text += fmt::format("  engine   {}\n", report.fault.empty() ? engine.engine + " " + report.hello.version
                                                                : "not available: " + report.fault);
    for (const auto& [setting, what] : report.hello.settings)
        text += fmt::format("  {:<8} {}{}\n", setting, what, setting == engine.setting ? " (this one)" : "");
    // a program with by_step sends no settings
    if (!report.hello.settings.empty())
        text += fmt::format("  formulas {}\n", report.hello.formulas
                                                   ? "loads given by formulas are evaluated at the start of each step"
                                                   : "loads given by formulas are not supported");
    return text;
}

std::string describe(const std::string& name, description::ConditioningBudget budget) {
    if (name == "auto")
        return "auto\n\n  Selects a method for the scene; polhode describe SCENE prints which and why.\n";
    if (const Method* method = find_method(name)) return describe_method(*method);
    if (const EngineMethod* engine = find_engine(name)) return describe_engine(*engine);
    for (const OmittedMethod& method : omitted_methods())
        if (method.name == name) return fmt::format("{}\n\n  Not included. {}\n", method.name, method.reason);
    if (is_experiment(name)) return describe_experiment(name);
    try {
        return describe_scene(find_scene(name), budget);
    } catch (const InputError&) {
        // if a file or link of this name exists (also a dangling or circular link), report its error
        // otherwise the name may be a misspelt method
        if (std::error_code none; std::filesystem::exists(std::filesystem::symlink_status(name, none))) throw;
        const std::string meant = did_you_mean(name, method_names());
        if (meant.empty() || !did_you_mean(name, builtin_scene_names()).empty()) throw;
        throw UsageError(fmt::format("{} is neither a scene nor a method; {}", name, meant));
    }
}

// an empty value is an error in a script, not a request for the default
std::string not_empty(const std::string& value) { return value.empty() ? "is empty" : ""; }

// Draws the scene's polhode to a file. Returns the exit code.
int draw(const std::string& name, const std::string& path) {
    if (!path.ends_with(".svg") && !path.ends_with(".pdf"))
        throw UsageError(fmt::format("--picture is {}; give a name that ends in .svg or .pdf", path));
    if (name == "auto" || find_method(name) || find_engine(name))
        throw UsageError(fmt::format("--picture draws scenes, and {} is a method; give a scene", name));
    require_output(path);
    const Scene scene = find_scene(name);
    require_one_body(scene, "--picture", "a polhode is drawn for one body");
    const PolhodeCurve polhode = polhode_curve(pose(scene));
    std::string fault = polhode.fault;
    if (fault.empty() && polhode.energy == 0) fault = "the body does not rotate";
    if (fault.empty()) fault = draw_polhode(polhode, one_line(scene.name, 60), path);
    if (fault.empty()) return 0;
    std::fputs(fmt::format("polhode: cannot draw the picture: {}\n", one_line(fault, 500)).c_str(), stderr);
    return 1;
}

// Returns the longest stable steps by linear theory, or why linear theory does not apply.
std::string linear_stability(const Method& method) {
    if (!method.amplification && !method.pendulum_amplification)
        return takes_step(method) ? "linear theory does not apply: a step is not a linear map of the state"
                                  : "linear theory does not apply: the method adapts its steps, and often its order";
    const auto words = [](std::optional<double> length) {
        return *length == 0 ? "never" : std::isinf(*length) ? "always" : fmt::format("up to {:.7g}", *length);
    };
    return fmt::format("in h |lambda|: for lambda < 0 {}, for imaginary lambda {}", words(real_interval(method)),
                       words(imaginary_interval(method)));
}

}  // namespace

std::string describe_method(const Method& method) {
    std::string description = fmt::format("{}\n\n  {}\n\n", method.name, method.documentation);
    const auto line = [&](const char* name, std::string_view value) {
        if (!value.empty()) description += fmt::format("  {:<10}  {}\n", name, value);
    };
    line("control", control_text(method.control));
    line("order", method.order > 0 ? std::to_string(method.order) : "variable, or not defined");
    if (!method.origin.empty()) line("described as", method.origin);
    line("conserves", method.conserves);
    line("stable", linear_stability(method));
    line("source", method.source);
    return description;
}

void add_describe(CLI::App& program, int& exit_code) {
    struct Options {
        std::string name, output, picture;
        bool conditioning = false;
    };
    CLI::App* command = program.add_subcommand("describe",
                                               "Describes a scene (mass properties, joints, system posed, omitted "
                                               "terms, invariants, conditioning, polhode), a "
                                               "method, or an experiment (its cases).");
    command->footer(
        "Examples:\n"
        "  polhode describe lagrange_top\n"
        "  polhode describe free_asymmetric --picture polhode.svg\n"
        "  polhode describe cvode_adams\n");
    const auto options = std::make_shared<Options>();
    command->add_option("NAME", options->name, "A scene or experiment (built-in name or file), or a method")
        ->required();
    add_engines_option(*command);
    add_outside_option(*command);
    command->add_option("--output", options->output, "Output file (default: stdout)")->check(not_empty, "");
    command
        ->add_option("--picture", options->picture,
                     "Draw the scene's polhode on its inertia ellipsoid with gnuplot to this .svg or .pdf file. "
                     "The text is then written only with --output")
        ->check(not_empty, "");
    command->add_flag("--conditioning", options->conditioning,
                      "Compute the scene's conditioning over the whole run. By default it is computed for a fixed "
                      "number of steps, and the time reached is printed");
    command->callback([options, &exit_code] {
        if (!options->picture.empty()) exit_code = draw(options->name, options->picture);
        if (options->picture.empty() || !options->output.empty())
            write_output(options->output,
                         describe(options->name, options->conditioning ? description::ConditioningBudget::whole
                                                                       : description::ConditioningBudget::brief));
    });
}

}  // namespace polhode
