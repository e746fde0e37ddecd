#include "integrators/contact/solve_joints.h"

#include "integrators/contact/constrained_joint_form.h"
#include "integrators/contact/driver_trajectory.h"
#include "integrators/contact/follow_joints.h"
#include "integrators/contact/joint_tree_form.h"
#include "motion/formula_mechanism.h"

namespace polhode::contact {

// In maximal coordinates, for methods that solve differential-algebraic equations.
static JointRun<double> follow_in_maximal_coordinates(const Problem& problem, const Settings& settings,
                                                      MakeSystemSteps steps) {
    const JointTreeForm<double> tree(problem.scene);
    const std::vector<double> start = tree.initial();
    ConstrainedJointForm form(problem.scene, problem.scales, tree.motion(start.data()),
                              tree.joint_coordinates(start.data()));
    std::vector<Block> blocks = form.blocks(problem.scales);
    return JointDriver<double, ConstrainedJointForm>(problem.scene, problem.scales, std::move(form), std::move(blocks),
                                                     times_of_samples(problem, settings),
                                                     driver_settings<JointSettings>(settings, steps))
        .run();
}

JointRun<double> follow_joints_in_binary64(const Problem& problem, const Settings& settings, MakeSystemSteps steps) {
    if (steps.coordinates() == StepCoordinates::bodies) return follow_in_maximal_coordinates(problem, settings, steps);
    JointTreeForm<double> form(problem.scene);
    std::vector<Block> blocks = form.blocks(tree_scales(problem));
    return JointDriver<double, JointTreeForm<double>>(problem.scene, problem.scales, std::move(form), std::move(blocks),
                                                      times_of_samples(problem, settings),
                                                      driver_settings<JointSettings>(settings, steps))
        .run();
}

Trajectory solve_joints(const Problem& problem, const Settings& settings, MakeSystemSteps steps) {
    return solve_by_driver(problem, settings, steps, &follow_joints_in_binary64);
}

}  // namespace polhode::contact
