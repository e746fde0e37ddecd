// Contacts of several spheres in binary64, for methods and descriptions.
#pragma once

#include "integrators/contact/follow_spheres.h"
#include "integrators/method.h"

namespace polhode::contact {

/// Follows the spheres to the tolerance of `settings`, at their samples, by steps of a method or by Taylor series.
SphereRun<double> follow_spheres_in_binary64(const Problem& problem, const Settings& settings,
                                             MakeSystemSteps steps = nullptr);

/// The trajectory of follow_spheres_in_binary64(), as a method returns it.
Trajectory solve_spheres(const Problem& problem, const Settings& settings, MakeSystemSteps steps);

}  // namespace polhode::contact
