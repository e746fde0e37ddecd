// Names given on the command line.
#pragma once

#include <string>
#include <vector>

#include "integrators/method.h"

namespace polhode {

/// The method of that name; throws UsageError, with near misses, if there is none.
const Method& method_named(const std::string& name);

std::vector<std::string> method_names();

}  // namespace polhode
