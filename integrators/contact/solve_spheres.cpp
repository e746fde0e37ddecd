#include "integrators/contact/solve_spheres.h"

#include "integrators/contact/cluster_form.h"
#include "integrators/contact/driver_trajectory.h"
#include "integrators/contact/reduced_form.h"
#include "motion/mechanism.h"

namespace polhode::contact {

SphereRun<double> follow_spheres_in_binary64(const Problem& problem, const Settings& settings, MakeSystemSteps steps) {
    return SphereDriver<double, ReducedForm<double>, ClusterForm<double>, ClosedFormImpact>(
               problem.scene, times_of_samples(problem, settings), driver_settings<ContactSettings>(settings, steps))
        .run();
}

Trajectory solve_spheres(const Problem& problem, const Settings& settings, MakeSystemSteps steps) {
    return solve_by_driver(problem, settings, steps, &follow_spheres_in_binary64);
}

}  // namespace polhode::contact
