#include "integrators/contact/solve_joints.h"

#include <chrono>

#include "integrators/contact/follow_joints.h"
#include "integrators/contact/joint_tree_form.h"
#include "integrators/contact/solve_contacts.h"
#include "motion/mechanism.h"

namespace polhode::contact {

JointRun<double> follow_joints_in_binary64(const Problem& problem, const Settings& settings) {
    const std::vector<double> times =
        settings.times.empty() ? sample_times(problem.scene.duration, settings.samples) : settings.times;
    JointTreeForm<double> form(problem.scene);
    std::vector<Block> blocks = form.blocks(mechanism_of(problem).scales());
    return JointDriver<double, JointTreeForm<double>>(problem.scene, problem.scales, std::move(form), std::move(blocks),
                                                      times, driver_settings<JointSettings>(settings))
        .run();
}

Trajectory solve_joints(const Problem& problem, const Settings& settings) {
    Trajectory trajectory;
    const auto start = std::chrono::steady_clock::now();
    const JointRun<double> run = follow_joints_in_binary64(problem, settings);
    trajectory.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    trajectory.steps = trajectory.rhs_evaluations = run.steps;
    trajectory.bodies = static_cast<int>(problem.scene.bodies.size());
    const std::size_t count = run.motions.size(), first = settings.record || count == 0 ? 0 : count - 1;
    for (std::size_t i = first; i < count; ++i) {
        const double t = settings.times.empty()
                             ? sample_time(problem.scene.duration, static_cast<long>(i), settings.samples)
                             : settings.times[i];
        Moment moment{samples_of_bodies(t, run.motions[i]), {}};
        if (problem.reactions) moment.reactions = run.reactions[i];
        trajectory.append(moment);
    }
    set_status(trajectory, run.fault);
    return trajectory;
}

}  // namespace polhode::contact
