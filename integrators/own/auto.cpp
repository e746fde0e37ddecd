// Which method `auto` stands for.
#include "integrators/method.h"
#include "integrators/own/exact.h"
#include "integrators/run/stiffness.h"

namespace polhode {

Choice choose_method(const Problem& problem) {
    if (!problem.scene.planes.empty()) return {find_method("cvode_impacts"), "impacts on planes, located as events"};
    if (const Method* method = find_method("exact"); method && has_closed_form(problem))
        return {method, "the motion has a closed form"};
    if (is_stiff(problem))
        if (const Method* method = find_method("radau"))
            return {method, "the motion is stiff: it damps far faster than the body turns"};
    if (!problem.needs.user_torque)
        return {find_method("taylor"), "smooth motion without stiffness: a Taylor series comes nearest to round-off"};
    return {find_method("dop853"),
            "a torque of the user's own has no Taylor coefficients and may be rough: a Runge-Kutta pair of high order"};
}

}  // namespace polhode
