// Trajectories of event drivers of several bodies in binary64.
#pragma once

#include <chrono>
#include <cstddef>
#include <vector>

#include "integrators/contact/solve_contacts.h"
#include "motion/mechanism.h"

namespace polhode::contact {

/// The trajectory of a run, as a method returns it. `follow`: computes the run, whose `motions` are those of all bodies
/// at the samples of `settings`.
template <class BodiesRun>
Trajectory solve_by_driver(const Problem& problem, const Settings& settings, MakeSystemSteps steps,
                           BodiesRun (*follow)(const Problem&, const Settings&, MakeSystemSteps)) {
    Trajectory trajectory;
    const auto start = std::chrono::steady_clock::now();
    const BodiesRun run = follow(problem, settings, steps);
    trajectory.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    trajectory.steps = run.steps, trajectory.rhs_evaluations = run.evaluations;
    trajectory.bodies = static_cast<int>(problem.scene.bodies.size());
    const std::vector<double> times = times_of_samples(problem, settings);
    const std::size_t count = run.motions.size(), first = settings.record || count == 0 ? 0 : count - 1;
    for (std::size_t i = first; i < count; ++i) {
        Moment moment{samples_of_bodies(times[i], run.motions[i]), {}};
        if constexpr (requires { run.reactions; })
            if (problem.reactions) moment.reactions = run.reactions[i];
        trajectory.append(moment);
    }
    set_status(trajectory, run.fault);
    return trajectory;
}

}  // namespace polhode::contact
