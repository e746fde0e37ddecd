// The GNU Scientific Library's solvers. It is under the GPL: they are built with POLHODE_PEERS_GPL alone, are linked
// into the programs of the build tree alone, and are never installed. Without them the list is empty.
#pragma once

#include <span>
#include <string>

#include "integrators/method.h"

namespace polhode {

extern const std::span<const Method> gsl_methods;

/// As the library linked says of itself; empty where it is absent.
std::string gsl_library_version();

}  // namespace polhode
