#include "integrators/contact/solve_contacts.h"

#include <algorithm>
#include <chrono>

#include "integrators/contact/follow_contacts.h"
#include "integrators/contact/reduced_form.h"
#include "integrators/contact/solve_joints.h"
#include "integrators/contact/solve_spheres.h"
#include "scene/sphere_contacts.h"

namespace polhode::contact {

std::string event_refusal(const Problem& problem) {
    if (problem.needs.user_torque && !problem.scene.planes.empty())
        return "user-defined torques are not supported together with planes";
    return "";
}

Run<double> follow_in_binary64(const Problem& problem, const Settings& settings, MakeSystemSteps steps) {
    return ContactDriver<double, ReducedForm<double>>(problem.scene, times_of_samples(problem, settings),
                                                      driver_settings<ContactSettings>(settings, steps))
        .run();
}

Record<double> record_contacts(const Problem& problem, const Settings& settings, MakeSystemSteps steps) {
    if (has_sphere_contacts(problem.scene))
        return merge_records(follow_spheres_in_binary64(problem, settings, steps).records);
    return follow_in_binary64(problem, settings, steps).record;
}

static Trajectory solve_contacts(const Problem& problem, const Settings& settings, MakeSystemSteps steps) {
    Trajectory trajectory;
    const auto start = std::chrono::steady_clock::now();
    const Run<double> run = follow_in_binary64(problem, settings, steps);
    trajectory.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    trajectory.steps = run.steps, trajectory.rhs_evaluations = run.evaluations;
    const std::vector<double> times = times_of_samples(problem, settings);
    for (std::size_t i = 0; i < run.motions.size(); ++i) trajectory.samples.emplace_back(times[i], run.motions[i]);
    if (!settings.record && trajectory.samples.size() > 1)
        trajectory.samples.erase(trajectory.samples.begin(), trajectory.samples.end() - 1);
    for (const Event<double>& event : run.record.events)
        if (event.kind == EventKind::impact || event.kind == EventKind::lands)
            trajectory.impact_times.push_back(event.t);
    set_status(trajectory, run.fault);
    return trajectory;
}

bool has_events(const Scene& scene) {
    return has_sphere_contacts(scene) || !scene.planes.empty() || has_joint_events(scene);
}

Trajectory solve_events(const Problem& problem, const Settings& settings, MakeSystemSteps steps) {
    if (has_sphere_contacts(problem.scene)) return solve_spheres(problem, settings, steps);
    if (!problem.scene.planes.empty()) return solve_contacts(problem, settings, steps);
    return solve_joints(problem, settings, steps);
}

}  // namespace polhode::contact
