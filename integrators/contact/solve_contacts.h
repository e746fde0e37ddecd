// Contacts of one body with planes in binary64, for methods and descriptions.
#pragma once

#include <string>

#include "integrators/contact/contact_record.h"
#include "integrators/method.h"

namespace polhode::contact {

/// Follows the body with Taylor series to the tolerance of `settings`. The samples are those of `settings`.
Run<double> follow_in_binary64(const Problem& problem, const Settings& settings);

/// Why torsional and rolling friction of the scene's planes is not supported; empty if it is or if no plane has it.
std::string rotation_friction_refusal(const Scene& scene);

/// Why the contact modes do not support the scene's planes or loads; empty if they do or if there are no planes.
std::string contact_refusal(const Scene& scene);

/// The trajectory of follow_in_binary64(), as a method returns it.
Trajectory solve_contacts(const Problem& problem, const Settings& settings);

}  // namespace polhode::contact
