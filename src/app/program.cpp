#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <new>
#include <sstream>

#include "app/commands.h"
#include "experiment/run/versions.h"
#include "motion/trajectory_columns.h"
#include "scene/scene.h"
#include "scene/scene_formulas.h"
#include "scene/sphere_contacts.h"
#include "text/atomic_file.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr int bad_usage = 2, failed = 1;

int print_error(int exit_code, std::string_view message) {
    std::fputs(("polhode: " + one_line(message, 1500) + "\n").c_str(), stderr);
    return exit_code;
}

std::string versions() {
    std::string text = "polhode " POLHODE_VERSION;
    for (const auto& [name, version] : library_versions()) text += fmt::format("\n{} {}", name, version);
    return text + "\nCLI11 " CLI11_VERSION;
}

// Reports unknown commands with similar names; CLI11 only reports that a command is required.
void require_command(const CLI::App& program, int argc, const char* const* argv) {
    if (argc < 2 || argv[1][0] == '-') return;
    std::vector<std::string> names;
    for (const CLI::App* command : program.get_subcommands({})) names.push_back(command->get_name());
    if (std::find(names.begin(), names.end(), argv[1]) != names.end()) return;
    const std::string meant = did_you_mean(argv[1], names);
    throw UsageError(fmt::format("there is no command {}; {}", argv[1],
                                 meant.empty() ? "commands: " + join_with_commas(names) : meant));
}

}  // namespace

int print_memory_error() {
    static std::mutex mutex;
    static bool printed = false;
    const std::lock_guard lock(mutex);
    if (!printed) std::fputs("polhode: out of memory\n", stderr);
    printed = true;
    return failed;
}

void require_positive(const char* option, double value) {
    if (!(std::isfinite(value) && value > 0))
        throw UsageError(fmt::format("{} is {}; give a finite number > 0", option, shortest_decimal(value)));
}

void require_count(const char* option, long count, long most) {
    if (count < 1 || count > most) throw UsageError(fmt::format("{} is {}; give 1 to {}", option, count, most));
}

void write_trajectory_output(const std::string& path, std::string text) {
    if (!path.empty()) text += trajectory_comment;
    write_output(path, text);
}

void describe_columns(CLI::App& command, std::string_view further) {
    std::string text = "Columns:\n";
    for (const TrajectoryColumns& c : trajectory_columns())
        text += fmt::format("  {:<12} {}{}{}\n", c.names, c.unit, c.unit.empty() ? "" : ": ", c.meaning);
    command.footer(text.append("\n").append(further));
}

Convention parse_convention_option(const std::string& words) {
    if (words.empty()) return {};
    return as_usage([&] { return parse_convention(words); }, "--convention: ");
}

void write_output(const std::string& path, std::string_view text) {
    if (!path.empty()) {
        const std::string folder = std::filesystem::path(path).parent_path().string();
        remove_abandoned(folder.empty() ? "." : folder);
        write_atomically(path, text);
        return;
    }
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
        throw std::runtime_error(fmt::format("stdout cannot be written: {}", std::strerror(errno)));
}

void require_output(const std::string& path) {
    if (path.empty()) return;
    try {
        require_writable(path);
    } catch (const std::runtime_error& error) {
        throw UsageError(error.what());
    }
}

void require_joint_files(const Scene& scene, const std::string& reactions, const std::string& joints,
                         const std::string& output) {
    if (!reactions.empty() && scene.joints.empty() && scene.loops.empty() && scene.planes.empty())
        throw UsageError("--reactions: the scene has neither joints nor loops nor planes; remove the option");
    if (!reactions.empty() && has_sphere_contacts(scene))
        throw UsageError("--reactions: not available for contacts of several bodies; use --events");
    if (!joints.empty() && scene.joints.empty())
        throw UsageError("--joints: the scene has no joints; remove the option");
    const auto require_two = [](const std::string& first, const char* one, const std::string& second, const char* two) {
        if (!first.empty() && first == second)
            throw UsageError(fmt::format("{} and {} name the same file; give two files", one, two));
    };
    require_two(reactions, "--reactions", output, "--output");
    require_two(joints, "--joints", output, "--output");
    require_two(joints, "--joints", reactions, "--reactions");
}

void require_one_body(const Scene& scene, const std::string& option, const std::string& reason) {
    if (is_mechanism(scene))
        throw UsageError(fmt::format("{}: {}, and {} has several; remove the option, or give a scene of one body",
                                     option, reason, one_line(scene.name, 60)));
}

namespace {

// Prints help and versions through a string stream, so that failed writes to stdout are reported.
int print_help(const CLI::App& program, const CLI::ParseError& request) {
    std::ostringstream text;
    const int exit_code = program.exit(request, text, text);
    try {
        write_output("", text.str());
    } catch (const std::runtime_error& error) {
        return print_error(failed, error.what());
    }
    return exit_code;
}

}  // namespace

namespace {

int run_command(int argc, const char* const* argv, std::span<const AddCommand> commands) {
    CLI::App program{
        "polhode: simulates rigid bodies and mechanisms and measures the error and run time of each "
        "integration method.",
        "polhode"};
    program.set_version_flag("--version", versions, "Print the versions of the program and of the libraries in use");
    program.require_subcommand(1);
    program.failure_message(CLI::FailureMessage::simple);
    int exit_code = 0;
    for (const AddCommand add : commands) add(program, exit_code);
    // an empty value is an error in a script, not a request for the default
    for (CLI::App* command : program.get_subcommands({}))
        for (CLI::Option* option : command->get_options())
            if (option->get_expected_max() > 0)
                option->check([](const std::string& value) { return value.empty() ? "is empty" : std::string(); }, "");
    try {
        require_command(program, argc, argv);
        program.parse(argc, argv);
        return exit_code;
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return print_help(program, error);
        return print_error(bad_usage, fmt::format("{}; see polhode --help", error.what()));
    } catch (const UsageError& error) {
        return print_error(bad_usage, error.what());
    } catch (const InputError& error) {
        return print_error(bad_usage, error.what());
    } catch (const std::bad_alloc&) {
        return print_memory_error();
    } catch (const std::exception& error) {
        return print_error(failed, error.what());
    }
}

}  // namespace

int run_program(int argc, const char* const* argv, std::span<const AddCommand> commands) {
    // memory may run out before the command line is parsed or while an error is reported
    try {
        return run_command(argc, argv, commands);
    } catch (const std::bad_alloc&) {
        return print_memory_error();
    } catch (const std::exception& error) {
        std::fprintf(stderr, "polhode: %s\n", error.what());
        return failed;
    }
}

}  // namespace polhode
