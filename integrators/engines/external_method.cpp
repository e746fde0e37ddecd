#include "integrators/engines/external_method.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <optional>
#include <string_view>

#include "integrators/run/march.h"
#include "motion/trajectory_csv.h"
#include "scene/scene_file.h"
#include "text/child_process.h"
#include "text/message.h"

namespace polhode {
namespace {

std::string user_torque_refusal(const Problem& problem) {
    return problem.needs.user_torque ? "a user-defined torque cannot be passed to another process" : "";
}

void replace_all(std::string& text, std::string_view word, const std::string& value) {
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += value.size())
        text.replace(at, word.size(), value);
}

std::vector<std::string> make_arguments(const EngineCommand& command, const Scene& scene, const Settings& settings) {
    std::vector<std::string> arguments = command.arguments;
    const auto& appended = settings.step ? command.by_step : command.by_tolerance;
    if (settings.step || settings.tolerance) arguments.insert(arguments.end(), appended.begin(), appended.end());
    const auto text = [](const std::optional<double>& value) { return value ? fmt::format("{}", *value) : ""; };
    for (std::string& argument : arguments) {
        replace_all(argument, "{samples}", fmt::format("{}", settings.samples));
        replace_all(argument, "{step}", text(settings.step));
        replace_all(argument, "{tolerance}", text(settings.tolerance));
        replace_all(argument, "{directory}", scene.directory.empty() ? "." : scene.directory);
    }
    return arguments;
}

// Why the file is not valid for the run; empty if it is. Times that are correct up to rounding are made exact.
std::string find_fault(TrajectoryFile& file, const Problem& problem, const Settings& settings) {
    const double duration = problem.scene.duration;
    if (!file.has_angular_velocity) return "its output has no columns wx, wy, wz";
    if (!problem.body.pivoted && !(file.has_position || file.has_origin))
        return "its output has no columns px, py, pz or ox, oy, oz";
    if (!problem.body.pivoted && !file.has_velocity) return "its output has no columns vx, vy, vz";
    const std::size_t expected = static_cast<std::size_t>(settings.samples) + 1;
    if (file.rows.size() != expected)
        return fmt::format("its output has {} samples instead of {}", file.rows.size(), expected);
    for (std::size_t k = 0; k < expected; ++k) {
        const double t = sample_time(duration, static_cast<long>(k), settings.samples);
        if (!(std::abs(file.rows[k].t - t) <= 1e-12 * duration))
            return fmt::format("its sample {} is at t = {} s instead of {} s", k, file.rows[k].t, t);
        file.rows[k].t = t;
    }
    return "";
}

Trajectory run_command(const EngineCommand& command, const Problem& problem, const Settings& settings) {
    Trajectory trajectory;
    trajectory.status = Status::failed;
    const auto arguments = make_arguments(command, problem.scene, settings);
    ChildRun child;
    for (int i = 0; i < settings.repetitions && child.fault.empty(); ++i) {
        const double remaining = settings.seconds_limit - trajectory.seconds;
        child = run_child(arguments, write_scene(problem.scene),
                          {.time = std::chrono::duration<double>(remaining), .output_bytes = command.most_bytes});
        trajectory.seconds += child.seconds;
    }
    trajectory.seconds /= settings.repetitions;
    trajectory.message = child.fault, trajectory.limit_reached = child.timed_out;
    if (!child.fault.empty()) return trajectory;
    try {
        const std::string name = one_line(arguments.front(), 100);
        TrajectoryFile file = parse_trajectory(child.output, name);
        trajectory.message = find_fault(file, problem, settings);
        if (!trajectory.message.empty()) return trajectory;
        trajectory.samples = samples_of(file, problem.scene.body.center_of_mass);
    } catch (const InputError& error) {
        trajectory.message = fmt::format("its output is not a trajectory: {}", error.what());
        return trajectory;
    }
    if (!settings.record) trajectory.samples.erase(trajectory.samples.begin(), trajectory.samples.end() - 1);
    trajectory.status = Status::ok;
    return trajectory;
}

}  // namespace

std::shared_ptr<const Method> external_method(const Method& description, const EngineCommand& command) {
    Method method = description;
    const bool step = !command.by_step.empty(), tolerance = !command.by_tolerance.empty();
    method.control = step && tolerance ? Control::fixed_step_or_tolerance
                     : step            ? Control::fixed_step
                     : tolerance       ? Control::tolerance
                                       : Control::none;
    if (!method.refusal) method.refusal = user_torque_refusal;
    return make_method(method, [command](const Problem& problem, const Settings& settings) {
        return run_command(command, problem, settings);
    });
}

}  // namespace polhode
