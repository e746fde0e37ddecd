// IDA on mechanisms in maximal coordinates.
#include "integrators/contact/solve_joints.h"
#include "integrators/sundials/ida_mode_steps.h"
#include "integrators/sundials/ida_session.h"
#include "integrators/sundials/sundials_run.h"
#include "scene/scene_formulas.h"

namespace polhode {
namespace {

constexpr MakeSystemSteps ida_index1_steps{make_ida_index1_steps, StepCoordinates::bodies};
constexpr MakeSystemSteps ida_index2_steps{make_ida_index2_steps, StepCoordinates::bodies};

Trajectory solve_ida(const Problem& problem, const Settings& settings, maximal::Index index) {
    // switches of formulas are events too
    if (contact::has_joint_events(problem.scene) || has_formula_loads(problem.scene))
        return contact::solve_joints(problem, settings,
                                     index == maximal::Index::one ? ida_index1_steps : ida_index2_steps);
    IdaSession session(problem, index, *settings.tolerance);
    return run_sundials(problem, settings, session);
}

std::string ida_refusal(const Problem& problem) {
    const bool has_formulas = problem.needs.system == SystemKind::mechanism_with_formulas;
    if (!has_formulas && !std::holds_alternative<MechanismSystem>(problem.system))
        return "this method supports only scenes of several bodies";
    for (const Load& load : problem.scene.loads)
        if (std::holds_alternative<UserTorque>(load)) return "user-defined torques have no Jacobian";
    return "";
}

constexpr Method ida_variants[] = {
    {.name = "ida_index1",
     .documentation =
         "IDA's backward differentiation formulas of order 1 to 5 on a mechanism in maximal coordinates. Attitude, "
         "position and both momenta of every body are differential unknowns, the joints' forces and torques are "
         "algebraic unknowns, and the constraints are imposed on accelerations (index 1). Positions are not corrected, "
         "so joints drift apart as errors accumulate. Couplings of joint coordinates are further constraints. The "
         "torques of armatures and of the inertia that massless bodies need in this form are algebraic unknowns too. "
         "Newton's method with the exact Jacobian and a sparse LU factorisation. Relative tolerance R, absolute "
         "tolerance R times the component's scale; the multipliers are excluded from the error test. Loop constraints "
         "that are redundant at the start are removed. Limits, friction and prescribed motions of joints, and switches "
         "of formulas, are followed from event to event: joints that are held or driven are constraints, friction of a "
         "moving joint is a constant force, and events are located on IDA's interpolating polynomial. After each event "
         "positions and velocities are projected onto the constraints, and the history restarts.",
     .conserves = "nothing",
     .solve = [](const Problem& p, const Settings& s) { return solve_ida(p, s, maximal::Index::one); },
     .steps = ida_index1_steps},
    {.name = "ida_index2",
     .documentation =
         "`ida_index1` in the stabilised form of index 2: the constraints are imposed on positions and on velocities, "
         "with a second set of multipliers that corrects positions and a third that keeps quaternions at unit length. "
         "Joints stay closed and coupled to the tolerance of the nonlinear solver.",
     .source = "C. W. Gear, B. Leimkuhler & G. K. Gupta 1985, J. Comput. Appl. Math. 12-13, 77-90; IDA: Hindmarsh et "
               "al. 2005, ACM Trans. Math. Softw. 31, 363-396",
     .conserves = "joints closed, |q| = 1, to the tolerance",
     .solve = [](const Problem& p, const Settings& s) { return solve_ida(p, s, maximal::Index::two); },
     .steps = ida_index2_steps},
};

constexpr auto ida_family = apply_defaults(
    {.source = "Hindmarsh, Brown, Grant, Lee, Serban, Shumaker & Woodward 2005, SUNDIALS: suite of nonlinear "
               "and differential/algebraic equation solvers, ACM Trans. Math. Softw. 31, 363-396",
     .control = Control::tolerance,
     .general_systems = true,
     .family = Family::multistep,
     .library = sundials_library,
     .refusal = ida_refusal},
    ida_variants);

}  // namespace

extern const std::span<const Method> ida_methods{ida_family};

}  // namespace polhode
