// Selects the method that `auto` uses.
#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <iterator>

#include "integrators/contact/joint_events.h"
#include "integrators/method.h"
#include "integrators/own/exact.h"
#include "integrators/own/record_system.h"
#include "integrators/run/stiffness.h"
#include "motion/formula_model.h"
#include "motion/numbers.h"
#include "motion/systems.h"
#include "scene/sphere_contacts.h"

namespace polhode {
namespace {

// Returns whether the right-hand side is long enough for extrapolation to be faster than Taylor series. The work of a
// series grows as the square of its order, and its coefficients depend on each other, most of all in quotients. A
// long right-hand side is faster to evaluate for eight columns side by side. Measured on all trees and loops of the
// catalogue at errors of 1e-6, 1e-9 and 1e-12: extrapolation is faster from about 100 operations on (300 below a
// tolerance of 3e-12), a quotient counted as 25. It does not reach the smallest errors on chaotic motions.
bool favors_extrapolation(const Problem& problem, double tolerance) {
    constexpr std::ptrdiff_t min_operations = 100, min_operations_if_tight = 300, quotient = 25;
    constexpr double tight = 3e-12,
                     least = 1e-14;  // below it only rounding error remains, which series sum more carefully
    if (std::holds_alternative<OneBody>(problem.system) || tolerance < least) return false;
    ErasedSystem system(problem);
    Numbers<run_time> y(system.size());
    system.initial(y.data());
    if (!problem.segments.empty()) system.enter(problem.segments.front(), y.data());
    const auto nodes = record_system<double>(system).tape.nodes;
    using Node = TapeNode<double>;
    const auto quotients =
        std::ranges::count_if(nodes, [](const Node& node) { return node.kind == Node::Kind::quotient; });
    return std::ssize(nodes) + (quotient - 1) * quotients >=
           (tolerance < tight ? min_operations_if_tight : min_operations);
}

}  // namespace

Choice choose_method(const Problem& problem, double tolerance) {
    if (has_sphere_contacts(problem.scene)) return {find_method("taylor"), "contacts of spheres, by their modes"};
    const auto has_friction = [](const Plane& plane) { return plane.friction > 0; };
    if (std::ranges::any_of(problem.scene.planes, has_friction))
        if (const Method* method = find_method("taylor"); method && refusal(*method, problem).empty())
            return {method, "contact with friction, by its modes"};
    if (std::ranges::any_of(problem.scene.joints, [](const Joint& joint) { return !joint.motion.empty(); }))
        return {find_method("taylor"), "prescribed motions of joints"};
    if (contact::has_joint_events(problem.scene))
        return {find_method("taylor"), "friction and limits of joints, located as events"};
    if (!problem.scene.planes.empty()) return {find_method("cvode_impacts"), "impacts on planes, located as events"};
    if (const Method* method = find_method("exact"); method && has_closed_form(problem))
        return {method, "the motion has a closed form"};
    if (is_stiff(problem))
        if (const Method* method = find_method("radau"))
            return {method, "the motion is stiff: it damps far faster than it rotates"};
    if (has_switches(problem))
        return {find_method("taylor"),
                "a load given by a formula switches: a Taylor series locates the switching points"};
    if (has_variable_roots(problem))
        return {find_method("taylor"),
                "a load given by a formula has a square root: a Taylor series locates where its argument vanishes"};
    if (favors_extrapolation(problem, tolerance))
        return {find_method("extrapolation"),
                "the equations are long: evaluating eight right-hand sides in parallel is the fastest"};
    if (!problem.needs.user_torque)
        return {find_method("taylor"), "the motion is smooth and not stiff: a Taylor series gives the smallest error"};
    return {find_method("dop853"),
            "user-defined torques have no Taylor coefficients and may not be smooth: a Runge-Kutta pair of high order"};
}

Choice choose_method(const Problem& problem, const Settings& settings) {
    const Choice best = choose_method(problem, settings.tolerance.value_or(default_tolerance));
    if ((!settings.step || takes_step(*best.method)) && (!settings.tolerance || takes_tolerance(*best.method)))
        return best;
    const auto first = [&](std::initializer_list<const char*> names, std::string_view why) -> Choice {
        for (const char* name : names)
            if (const Method* method = find_method(name); method && refusal(*method, problem).empty())
                return {method, why};
        return best;
    };
    if (settings.step)
        return first({"splitting8", "munthe_kaas4", "odeint_rk4", "impact_halving"},
                     "the most accurate method for this scene that takes a step");
    return is_stiff(problem)
               ? first({"radau"}, "the most accurate method for this scene that takes a tolerance: the motion is stiff")
               : first({"taylor", "dop853"}, "the most accurate method for this scene that takes a tolerance");
}

}  // namespace polhode
