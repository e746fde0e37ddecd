#include "integrators/contact/solve_spheres.h"

#include <chrono>

#include "integrators/contact/reduced_form.h"
#include "integrators/contact/solve_contacts.h"
#include "motion/mechanism.h"

namespace polhode::contact {

SphereRun<double> follow_spheres_in_binary64(const Problem& problem, const Settings& settings) {
    const std::vector<double> times =
        settings.times.empty() ? sample_times(problem.scene.duration, settings.samples) : settings.times;
    return SphereDriver<double, ReducedForm<double>, ClosedFormImpact>(problem.scene, times,
                                                                       driver_settings<ContactSettings>(settings))
        .run();
}

Trajectory solve_spheres(const Problem& problem, const Settings& settings) {
    Trajectory trajectory;
    const auto start = std::chrono::steady_clock::now();
    const SphereRun<double> run = follow_spheres_in_binary64(problem, settings);
    trajectory.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    trajectory.steps = trajectory.rhs_evaluations = run.steps;
    trajectory.bodies = static_cast<int>(problem.scene.bodies.size());
    const std::size_t count = run.motions.size(), first = settings.record || count == 0 ? 0 : count - 1;
    for (std::size_t i = first; i < count; ++i) {
        const double t = settings.times.empty()
                             ? sample_time(problem.scene.duration, static_cast<long>(i), settings.samples)
                             : settings.times[i];
        const Moment moment{samples_of_bodies(t, run.motions[i]), {}};
        trajectory.append(moment);
    }
    set_status(trajectory, run.fault);
    return trajectory;
}

}  // namespace polhode::contact
