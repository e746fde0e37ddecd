// polhode animate: writes an animated picture of a motion. The Python module draws it.
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/commands.h"
#include "app/lookup.h"
#include "scene/scene_file.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr long most_frames = 10'000;

constexpr const char* start_of_module = R"(import sys
try:
    from polhode._animate_command import main
except ModuleNotFoundError as error:
    print(f"polhode: animate: {error}; install python3-polhode and python3-numpy, or set PYTHONPATH", file=sys.stderr)
    sys.exit(2)
sys.exit(main()))";

struct AnimateOptions {
    std::string scene, method = "auto", beside, output;
    std::optional<double> step, tolerance, duration;
    long frames = 100;
    double fps = 25;
    bool outside = false;  ///< whether the scene may name files outside its folder
};

void require_valid(const AnimateOptions& options) {
    require_count("--frames", options.frames, most_frames);
    if (options.frames < 2) throw UsageError("--frames is 1; give at least 2");
    require_positive("--fps", options.fps);
    if (options.step) require_positive("--step", *options.step);
    if (options.tolerance) require_positive("--tolerance", *options.tolerance);
    if (options.duration) require_positive("--duration", *options.duration);
    const std::string ending = std::filesystem::path(options.output).extension().string();
    if (ending != ".gif" && ending != ".png" && ending != ".mp4")
        throw UsageError(fmt::format("--output {}: unknown ending; give NAME.gif, NAME.png or NAME.mp4",
                                     one_line(options.output, 200)));
    require_output(options.output);
}

// Replaces this process by Python. Returns only if there is none.
int animate_command(const AnimateOptions& options) {
    require_valid(options);
    read_scene_with_notes(options.scene);
    std::vector<std::string> words{"python3", "-c", start_of_module, options.scene, "--method", options.method};
    const auto add_number = [&](const char* name, const std::optional<double>& number) {
        if (number) words.insert(words.end(), {name, shortest_decimal(*number)});
    };
    if (!options.beside.empty()) words.insert(words.end(), {"--beside", options.beside});
    add_number("--step", options.step);
    add_number("--tolerance", options.tolerance);
    add_number("--duration", options.duration);
    add_number("--fps", options.fps);
    words.insert(words.end(), {"--frames", std::to_string(options.frames), "--output", options.output});
    if (options.outside) words.emplace_back("--allow-outside");
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ::execvp(arguments[0], arguments.data());
    throw UsageError(fmt::format("animate needs Python with the module polhode ({}); install python3-polhode",
                                 std::strerror(errno)));
}

}  // namespace

void add_animate(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand(
        "animate",
        "Solves a scene and writes an animated picture of its bodies: GIF, animated PNG, or MP4 if ffmpeg is "
        "installed. Needs the Python module polhode and matplotlib.");
    command->footer(
        "Examples:\n"
        "  polhode animate t_handle --output t_handle.gif\n"
        "  polhode animate t_handle_parts --beside article_as_written --step 0.0078125 --output beside.gif\n");
    const auto options = std::make_shared<AnimateOptions>();
    command->add_option("SCENE", options->scene, "A built-in scene (polhode list scenes) or a scene file")->required();
    command->add_option("--method", options->method, "Method (polhode list methods)")->capture_default_str();
    command->add_option(
        "--beside", options->beside,
        "Draw the motion of this method beside that of --method; --step and --tolerance apply to this method");
    command->add_option("--step", options->step, "Fixed step, s");
    command->add_option("--tolerance", options->tolerance, "Relative tolerance");
    command->add_option("--duration", options->duration, "Duration, s (default: the scene's)");
    command->add_option("--frames", options->frames, "Number of pictures, at equal times")->capture_default_str();
    command->add_option("--fps", options->fps, "Pictures per second")->capture_default_str();
    command->add_option("--output", options->output, "NAME.gif, NAME.png or NAME.mp4")->required();
    add_outside_option(*command);
    command->callback([options, command, &exit_code] {
        options->outside = command->count("--allow-outside") > 0;
        exit_code = animate_command(*options);
    });
}

}  // namespace polhode
