// Penalty contact as a stiff ODE (penalty_model.h), solved by `radau` and by CVODE's BDF.
#include <algorithm>
#include <memory>
#include <span>
#include <string>

#include "integrators/contact_stepping/contact_state.h"
#include "integrators/contact_stepping/penalty_model.h"
#include "integrators/method.h"

namespace polhode {
namespace {

using contact_stepping::PenaltyLaw;

/// Solves the equations to a thousandth of the tolerance that sets their stiffness.
template <PenaltyLaw law>
Trajectory solve_penalty_ode(const Problem& problem, const Settings& settings, const char* solver) {
    constexpr double least = 1e-13, most = 1e-6;
    const double tolerance = settings.tolerance.value_or(default_tolerance);
    const Problem posed = pose_model(std::make_shared<const contact_stepping::PenaltyModel>(problem, law, tolerance),
                                     problem.scene.duration);
    Settings inner = settings;
    inner.tolerance = std::clamp(1e-3 * tolerance, least, most);
    return solve(posed, *find_method(solver), inner);
}
template <PenaltyLaw law>
Trajectory solve_by_radau(const Problem& problem, const Settings& settings) {
    return solve_penalty_ode<law>(problem, settings, "radau");
}
template <PenaltyLaw law>
Trajectory solve_by_bdf(const Problem& problem, const Settings& settings) {
    return solve_penalty_ode<law>(problem, settings, "cvode_bdf");
}

std::string penalty_ode_refusal(const Problem& problem) {
    if (problem.needs.user_torque) return "penalty contact does not support user-defined torques";
    return contact_stepping::contact_refusal(problem);
}

constexpr const char* spring_damper_documentation =
    "Contact as a force, a stiff ODE solved by `radau`: a linear spring and damper that do not pull, with the damping "
    "ratio whose impact has the restitution e, and Coulomb friction regularised below a slip speed. The tolerance R "
    "sets the stiffness k = m g / (R L) for the size L of the hull and g = 9.81 m/s^2, and the slip speed R (g "
    "L)^(1/2); "
    "the equations are solved to R / 1000, at most 1e-6 and at least 1e-13. The motion converges to the rigid one with "
    "1/k while the body slides and rolls, and with k^(-1/2) across impacts. Restitution below R^(1/3) is replaced by "
    "this value. A body that should stick creeps, at most with the slip speed. A disc touches at the lowest point of "
    "its "
    "rim. Without planes: the motion of all 13 variables.";
constexpr const char* hunt_crossley_documentation =
    "`penalty_spring_damper_radau` with Hunt and Crossley's force k s^(3/2) (1 - a u_n) at the depth s, where k = m g "
    "/ "
    "(R L^(3/2)) and a is such that an impact has the restitution e. The approach speed at first touch, on which a "
    "depends, is a component of the state. The motion converges to the rigid one with k^(-2/3) while the body slides "
    "and rolls, and with k^(-2/5) across impacts.";

constexpr const char* spring_damper_source =
    "T. Schwager & T. Poeschel 2007, Coefficient of restitution and linear-dashpot model revisited, Granular Matter 9, "
    "465; J. T. Oden & J. A. C. Martins 1985, Models and computational methods for dynamic friction phenomena, Comput. "
    "Methods Appl. Mech. Eng. 52, 527 (regularised friction)";
constexpr const char* hunt_crossley_source =
    "K. H. Hunt & F. R. E. Crossley 1975, Coefficient of restitution interpreted as damping in vibroimpact, J. Appl. "
    "Mech. 42, 440; D. W. Marhefka & D. E. Orin 1999, A compliant contact model with nonlinear damping for simulation "
    "of robotic systems, IEEE Trans. Syst. Man Cybern. A 29, 566 (a for given e); J. T. Oden & J. A. C. Martins 1985";

constexpr Method penalty_odes_variants[] = {
    {.name = "penalty_spring_damper_radau",
     .documentation = spring_damper_documentation,
     .source = spring_damper_source,
     .solve = solve_by_radau<PenaltyLaw::spring_damper>,
     .family = Family::runge_kutta},
    {.name = "penalty_spring_damper_bdf",
     .documentation = "`penalty_spring_damper_radau` with CVODE's backward differentiation formulas as the solver.",
     .source = spring_damper_source,
     .solve = solve_by_bdf<PenaltyLaw::spring_damper>,
     .family = Family::multistep,
     .library = sundials_library},
    {.name = "penalty_hunt_crossley_radau",
     .documentation = hunt_crossley_documentation,
     .source = hunt_crossley_source,
     .solve = solve_by_radau<PenaltyLaw::hunt_crossley>,
     .family = Family::runge_kutta},
    {.name = "penalty_hunt_crossley_bdf",
     .documentation = "`penalty_hunt_crossley_radau` with CVODE's backward differentiation formulas as the solver.",
     .source = hunt_crossley_source,
     .solve = solve_by_bdf<PenaltyLaw::hunt_crossley>,
     .family = Family::multistep,
     .library = sundials_library},
};

constexpr auto penalty_odes_family = apply_defaults({.conserves = "nothing",
                                                     .control = Control::tolerance,
                                                     .planes = true,
                                                     .formulation = Formulation::full,
                                                     .refusal = penalty_ode_refusal},
                                                    penalty_odes_variants);

}  // namespace

extern const std::span<const Method> penalty_odes_methods{penalty_odes_family};

}  // namespace polhode
