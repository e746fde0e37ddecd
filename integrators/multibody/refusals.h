// Reasons for which methods for mechanisms refuse a problem: values of Method::refuses.
#pragma once

#include <string>

#include "motion/problem.h"

namespace polhode::multibody {

/// Of any of them: what is no scene of several bodies.
std::string needs_a_mechanism(const Problem& problem);

/// Of those that move each body by the inverse of its own mass and tensor: also bodies without them.
std::string needs_inertia_of_each_body(const Problem& problem);

/// Why binary32 cannot hold a mechanism: a mass, a moment or a place out of its range. Empty where it
/// can, and of what is no mechanism.
std::string beyond_binary32(const Problem& problem);

}  // namespace polhode::multibody
