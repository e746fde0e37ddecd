#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "integrators/method.h"
#include "integrators/run/watch.h"
#include "scene/scene_formulas.h"
#include "scene/sphere_contacts.h"

namespace polhode {
namespace {

Trajectory failed_trajectory(std::string message) {
    Trajectory trajectory;
    trajectory.status = Status::failed, trajectory.message = std::move(message);
    return trajectory;
}

/// A method with the texts and the function that its descriptor refers to.
struct OwnedMethod {
    std::array<std::string, 8> texts;
    std::function<Trajectory(const Problem&, const Settings&)> solve;
    Method method;
};

Trajectory solve_owned(const void* context, const Problem& problem, const Settings& settings) {
    return static_cast<const OwnedMethod*>(context)->solve(problem, settings);
}

bool is_positive(const std::optional<double>& value) { return !value || (std::isfinite(*value) && *value > 0); }

// Why these sample times are invalid; empty if they are valid or there are none.
std::string find_time_fault(const std::vector<double>& times, double duration) {
    for (std::size_t i = 0; i < times.size(); ++i) {
        if (!(times[i] >= 0 && times[i] <= duration))
            return fmt::format(
                "sample time {:.17g} s is out of range; times must lie between 0 and the duration, {:.17g} s", times[i],
                duration);
        if (i > 0 && !(times[i] > times[i - 1]))
            return fmt::format("sample time {:.17g} s is not after the previous one; times must increase", times[i]);
    }
    return "";
}

}  // namespace

const Method* find_method(std::string_view name) {
    for (const Method* method : methods())
        if (method->name == name) return method;
    return nullptr;
}

std::shared_ptr<const Method> make_method(const Method& description,
                                          std::function<Trajectory(const Problem&, const Settings&)> solve) {
    const auto owned = std::make_shared<OwnedMethod>();
    owned->solve = std::move(solve), owned->method = description;
    Method& m = owned->method;
    std::size_t i = 0;
    for (std::string_view* text :
         {&m.name, &m.documentation, &m.source, &m.origin, &m.conserves, &m.library, &m.binary64_name, &m.identity}) {
        owned->texts[i] = *text, *text = owned->texts[i];
        ++i;
    }
    m.solve = nullptr, m.solve_in = solve_owned, m.context = owned.get();
    return {owned, &m};
}

namespace {

// The first contact law beyond restitution and Coulomb friction that a plane of the scene has; empty if none has one.
std::string special_contact_law(const Scene& scene) {
    for (const Plane& plane : scene.planes) {
        if (plane.torsional_friction > 0) return "torsional friction of a plane";
        if (plane.rolling_friction > 0) return "rolling friction of a plane";
        if (plane.restitution_law == RestitutionLaw::poisson && plane.friction > 0)
            return "the law of restitution \"poisson\" with friction";
    }
    return "";
}

}  // namespace

// Why a method cannot follow joints with friction, limits or prescribed motions; empty if it can. Engines have their
// own list of the laws of joints that they support, and so have the refusals of updates of games for several bodies.
static std::string joint_law_refusal(const Method& method, const Scene& scene) {
    const bool is_joint_solver = method.family == Family::engine_update && method.general_systems;
    if (!follows_events(method) && method.family != Family::reference && method.family != Family::engine)
        for (const Joint& joint : scene.joints) {
            if ((joint.friction != 0 || joint.limits.any()) && !is_joint_solver)
                return fmt::format("{} does not support friction and limits of joints", method.name);
            if (!joint.motion.empty())
                return fmt::format("{} does not support prescribed motions of joints", method.name);
        }
    return "";
}

bool follows_events(const Method& method) { return method.steps || method.family == Family::series; }

bool follows_contacts(const Method& method) {
    return follows_events(method) && method.steps.coordinates() == StepCoordinates::joints;
}

std::string refusal(const Method& method, const Problem& problem) {
    if (std::string why = joint_law_refusal(method, problem.scene); !why.empty()) return why;
    const bool has_contact_modes = follows_contacts(method) || method.family == Family::reference;
    if (has_sphere_contacts(problem.scene) && !has_contact_modes && method.family != Family::engine)
        return fmt::format("{} does not support contacts of several bodies; use taylor or truth", method.name);
    if (!problem.scene.planes.empty() && !method.planes && !has_contact_modes)
        return fmt::format("{} does not support impacts on planes", method.name);
    if (!problem.scene.planes.empty() && !has_contact_modes && method.family != Family::engine &&
        has_formula_loads(problem.scene))
        return fmt::format("{} does not support formulas together with planes", method.name);
    if (!has_contact_modes)
        if (const std::string law = special_contact_law(problem.scene); !law.empty())
            return fmt::format("{} does not support {}", method.name, law);
    if (!method.general_systems && std::holds_alternative<MechanismSystem>(problem.system))
        return fmt::format("{} supports only scenes of one body; this scene has several bodies with joints",
                           method.name);
    if (!method.general_systems && has_formula_loads(problem.scene))
        return fmt::format("{} does not support loads given by formulas", method.name);
    if (!method.general_systems && std::holds_alternative<UserSystem>(problem.system))
        return fmt::format("{} supports only rigid bodies, not user-defined systems", method.name);
    return method.refusal ? method.refusal(problem) : "";
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
        settings.tolerance = default_tolerance;
    else if (takes_step(method))
        settings.step = problem.scene.duration / 1e4;
    return settings;
}

Trajectory solve(const Problem& problem, const Method& method, const Settings& settings) {
    if (!is_positive(settings.step)) return failed_trajectory("the step must be finite and > 0");
    if (!is_positive(settings.tolerance)) return failed_trajectory("the tolerance must be finite and > 0");
    if (settings.samples < 1) return failed_trajectory("the number of samples must be at least 1");
    if (const std::string fault = find_time_fault(settings.times, problem.scene.duration); !fault.empty())
        return failed_trajectory(fault);
    if (settings.max_steps < 1) return failed_trajectory("the step limit must be at least 1");
    if (settings.max_evaluations < 1) return failed_trajectory("the limit of evaluations must be at least 1");
    if (!(settings.seconds_limit > 0)) return failed_trajectory("the limit of seconds must be > 0");
    if (settings.repetitions < 1) return failed_trajectory("the number of repetitions must be at least 1");
    if (settings.step && settings.tolerance)
        return failed_trajectory("both a step and a tolerance are set; set only one");
    if (settings.step && !takes_step(method))
        return failed_trajectory(fmt::format("{} does not take a step", method.name));
    if (settings.tolerance && !takes_tolerance(method))
        return failed_trajectory(fmt::format("{} does not take a tolerance", method.name));
    if (std::string why = refusal(method, problem); !why.empty()) return unsupported(std::move(why));
    if (!settings.times.empty() && method.family == Family::engine)
        return unsupported("engines support only equally spaced samples; set a number of samples instead of times");
    const Settings complete = with_defaults(problem, method, settings);
    if (method.solve_in) return method.solve_in(method.context, problem, complete);
    if (method.formulation && problem.formulation != *method.formulation)
        return method.solve(pose(problem.scene, *method.formulation), complete);
    return method.solve(problem, complete);
}

Trajectory solve(const Scene& scene, const Method& method, const Settings& settings) {
    if (!(std::isfinite(scene.duration) && scene.duration > 0))
        return failed_trajectory("the duration must be finite and > 0");
    validate(scene, scene.name);
    return solve(pose(scene, settings.formulation), method, settings);
}

}  // namespace polhode
