// The GNU Scientific Library's solvers. GSL is under the GPL. They are built only with POLHODE_PEERS_GPL, are linked
// only into the programs of the build tree, and are never installed. Without them the list is empty.
#pragma once

#include <span>
#include <string>

#include "integrators/method.h"

namespace polhode {

extern const std::span<const Method> gsl_methods;

/// Version reported by the linked library; empty if it is absent.
std::string gsl_library_version();

}  // namespace polhode
