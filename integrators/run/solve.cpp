#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "integrators/method.h"
#include "integrators/run/march.h"

namespace polhode {
namespace {

Trajectory failed(std::string message) {
    Trajectory trajectory;
    trajectory.status = Status::failed, trajectory.message = std::move(message);
    return trajectory;
}

bool positive(const std::optional<double>& value) { return !value || (std::isfinite(*value) && *value > 0); }

}  // namespace

const Method* find_method(std::string_view name) {
    for (const Method* method : methods())
        if (method->name == name) return method;
    return nullptr;
}

bool takes_step(const Method& method) {
    return method.control == Control::fixed_step || method.control == Control::fixed_step_or_tolerance;
}

bool takes_tolerance(const Method& method) {
    return method.control == Control::tolerance || method.control == Control::fixed_step_or_tolerance;
}

Settings with_defaults(const Problem& problem, const Method& method, Settings settings) {
    if (settings.step || settings.tolerance) return settings;
    if (takes_tolerance(method))
        settings.tolerance = 1e-10;
    else if (takes_step(method))
        settings.step = problem.scene.duration / 1e4;
    return settings;
}

Trajectory solve(const Problem& problem, const Method& method, const Settings& settings) {
    if (!positive(settings.step)) return failed("the step is not finite and positive");
    if (!positive(settings.tolerance)) return failed("the tolerance is not finite and positive");
    if (settings.samples < 1) return failed("the number of samples is below 1");
    if (settings.max_steps < 1) return failed("the step limit is below 1");
    if (settings.max_evaluations < 1) return failed("the limit of evaluations is below 1");
    if (!(settings.seconds_limit > 0)) return failed("the limit of seconds is not positive");
    if (settings.repetitions < 1) return failed("the number of repetitions is below 1");
    if (settings.step && settings.tolerance) return failed("both a step and a tolerance: one of them");
    if (settings.step && !takes_step(method)) return failed(fmt::format("{} takes no step", method.name));
    if (settings.tolerance && !takes_tolerance(method))
        return failed(fmt::format("{} takes no tolerance", method.name));
    if (!problem.scene.planes.empty() && !method.planes)
        return unsupported(fmt::format("{} knows no impacts on planes", method.name));
    return method.solve(problem, with_defaults(problem, method, settings));
}

Trajectory solve(const Scene& scene, const Method& method, const Settings& settings) {
    if (!(std::isfinite(scene.duration) && scene.duration > 0))
        return failed("the duration is not finite and positive");
    validate(scene, scene.name);
    return solve(pose(scene, settings.formulation), method, settings);
}

}  // namespace polhode
