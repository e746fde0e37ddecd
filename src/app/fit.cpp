// polhode fit: fits numbers of a scene to measured motion.
#include "integrators/fit/fit.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "app/commands.h"
#include "app/lookup.h"
#include "motion/mechanism_motion.h"
#include "scene/scene_file.h"
#include "text/decimal.h"
#include "text/message.h"
#include "text/named_file.h"

namespace polhode {
namespace {

constexpr std::size_t largest_data = std::size_t{1} << 30;  // bytes
constexpr long most_fit_evaluations = 10'000;

struct FitOptions {
    std::string scene, data, output, covariance;
    std::vector<std::string> parameters, columns;
    std::vector<double> deviations;
    double tolerance = FitSettings{}.tolerance, max_seconds = std::numeric_limits<double>::infinity();
    long max_evaluations = FitSettings{}.max_evaluations;
};

void require_valid(const FitOptions& options) {
    require_positive("--tolerance", options.tolerance);
    require_count("--max-evaluations", options.max_evaluations, most_fit_evaluations);
    for (const double deviation : options.deviations) require_positive("--deviation", deviation);
    for (std::size_t i = 0; i < options.parameters.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            if (options.parameters[i] == options.parameters[k])
                throw UsageError(
                    fmt::format("--parameter {} is given twice; remove one", one_line(options.parameters[i], 80)));
    require_output(options.output);
    require_output(options.covariance);
    if (!options.output.empty() && options.output == options.covariance)
        throw UsageError("--output and --covariance name the same file; give two files");
}

FitSettings fit_settings(const FitOptions& options, const FitData& data) {
    FitSettings settings;
    settings.tolerance = options.tolerance;
    settings.max_evaluations = static_cast<int>(options.max_evaluations);
    settings.seconds_limit = options.max_seconds;
    settings.deviations = options.deviations;
    if (options.deviations.size() == 1) settings.deviations.assign(data.columns.size(), options.deviations[0]);
    if (!settings.deviations.empty() && settings.deviations.size() != data.columns.size())
        throw UsageError(fmt::format("--deviation has {} numbers; give 1, or one for each of the {} columns",
                                     settings.deviations.size(), data.columns.size()));
    return settings;
}

std::string covariance_csv(const FitOptions& options, const Fit& fit) {
    const std::size_t n = options.parameters.size();
    std::string text = "parameter,value,error";
    for (const std::string& name : options.parameters) text += "," + name;
    for (std::size_t i = 0; i < n; ++i) {
        text += fmt::format("\n{},{},{}", options.parameters[i], shortest_decimal(fit.values[i]),
                            shortest_decimal(fit.errors[i]));
        for (std::size_t k = 0; k < n; ++k) text += "," + shortest_decimal(fit.covariance[i * n + k]);
    }
    return text + "\n";
}

// Returns the correlations beyond 0.9, one per line.
std::string strong_correlations(const FitOptions& options, const Fit& fit) {
    const std::size_t n = options.parameters.size();
    std::string text;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = 0; k < i; ++k) {
            const double correlation = fit.covariance[i * n + k] / (fit.errors[i] * fit.errors[k]);
            if (std::abs(correlation) > 0.9)
                text += fmt::format("related   {} and {}: correlation {:.4f}\n", one_line(options.parameters[k], 80),
                                    one_line(options.parameters[i], 80), correlation);
        }
    return text;
}

std::string fit_summary(const FitOptions& options, const SceneNumbers& scene, const FitData& data, const Fit& fit) {
    const auto count = [](std::size_t n, const char* noun) {
        return fmt::format("{} {}{}", n, noun, n == 1 ? "" : "s");
    };
    std::string text = fmt::format("fit       {}, {} at {}\n", count(options.parameters.size(), "number"),
                                   count(data.columns.size(), "column"), count(data.times.size(), "time"));
    for (std::size_t i = 0; i < options.parameters.size(); ++i) {
        const std::string& name = options.parameters[i];
        text += fmt::format("number    {} = {:.12g}", one_line(name, 80), fit.values[i]);
        if (i < fit.errors.size()) text += fmt::format(" +- {:.2g}", fit.errors[i]);
        text += fmt::format(" (guess {:.6g})\n", scene.number(name));
    }
    for (std::size_t c = 0; c < fit.residuals.size(); ++c)
        text += fmt::format("residual  {} {:.3g}\n", one_line(data.columns[c].name, 80), fit.residuals[c]);
    if (!fit.errors.empty()) text += strong_correlations(options, fit);
    return text + fmt::format("status    {}{}{}, {}\n", name_of(fit.status), fit.message.empty() ? "" : ": ",
                              one_line(fit.message, 500),
                              count(static_cast<std::size_t>(fit.evaluations), "evaluation"));
}

int fit_command(const FitOptions& options) {
    require_valid(options);
    const Scene scene = read_scene_with_notes(options.scene);
    const FitData data = as_usage([&] {
        return parse_fit_data(read_whole_file(options.data, options.data, largest_data,
                                              "give a CSV file of measured motion", FileKinds::streamed),
                              options.data, body_names(scene), options.columns);
    });
    const SceneNumbers numbers(scene, options.scene);
    const FitSettings settings = fit_settings(options, data);
    const Fit fit = fit_numbers(numbers, options.parameters, data, settings);
    std::fputs(fit_summary(options, numbers, data, fit).c_str(), stderr);
    if (fit.status != Status::ok) return 1;
    if (!options.covariance.empty()) write_output(options.covariance, covariance_csv(options, fit));
    write_output(options.output, write_scene(numbers.replace(options.parameters, fit.values)));
    return 0;
}

}  // namespace

void add_fit(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand(
        "fit",
        "Fits numbers of a scene to measured motion by least squares: writes the scene with the fitted numbers to "
        "stdout or a file, and the numbers with their standard errors to stderr.");
    command->footer(
        "Columns of DATA: t (s), and any of\n"
        "  qw,qx,qy,qz     attitude, body to world\n"
        "  wx,wy,wz        angular velocity in world axes, rad/s\n"
        "  wx_B,wy_B,wz_B  angular velocity in body axes, rad/s, as a gyroscope measures it\n"
        "  px,py,pz        position of the centre of mass, m\n"
        "  vx,vy,vz        velocity of the centre of mass, m/s\n"
        "With several bodies each follows a body's name and a point: lower.px.\n"
        "\n"
        "The scene's numbers are the first guess. The scene is written without comments.\n"
        "\n"
        "Example:\n"
        "  polhode fit satellite.json gyroscope.csv --parameter /body/inertia/0 /body/inertia/1 \\\n"
        "      --columns wx_B wy_B wz_B --deviation 1e-4 --output fitted.json\n");
    const auto options = std::make_shared<FitOptions>();
    command->add_option("SCENE", options->scene, "A built-in scene (polhode list scenes) or a scene file")->required();
    command->add_option("DATA", options->data, "Measured motion (CSV)")->required();
    command
        ->add_option("--parameter", options->parameters,
                     "JSON pointers of the numbers to fit, such as /body/mass or /initial/angular_velocity/2")
        ->required();
    command->add_option("--columns", options->columns, "Columns to use (default: all that are known)");
    command->add_option("--deviation", options->deviations,
                        "Standard deviation of the noise: one number, or one per column. Without it, all columns have "
                        "the same weight and the deviation is estimated from the residuals");
    command->add_option("--tolerance", options->tolerance, "Relative tolerance of the motion and its derivatives")
        ->capture_default_str();
    command
        ->add_option("--max-evaluations", options->max_evaluations,
                     "Fail after this many evaluations of the motion and its derivatives")
        ->capture_default_str();
    command->add_option("--max-seconds", options->max_seconds, "Fail if an evaluation takes longer, s of CPU time");
    command->add_option("--covariance", options->covariance,
                        "CSV file: numbers, standard errors and covariances of the fitted numbers");
    command->add_option("--output", options->output, "Output file of the scene (default: stdout)");
    add_outside_option(*command);
    command->callback([options, &exit_code] { exit_code = fit_command(*options); });
}

}  // namespace polhode
