// Mechanisms with limits and friction of joints in binary64.
#pragma once

#include <string>

#include "integrators/contact/joint_events.h"
#include "integrators/method.h"

namespace polhode::contact {

/// Follows a mechanism whose joints have limits or friction, by steps of a method or by Taylor series.
JointRun<double> follow_joints_in_binary64(const Problem& problem, const Settings& settings,
                                           MakeSystemSteps steps = nullptr);

/// The run as a trajectory.
Trajectory solve_joints(const Problem& problem, const Settings& settings, MakeSystemSteps steps);

}  // namespace polhode::contact
