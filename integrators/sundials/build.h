// SUNDIALS version and build flags, for provenance and for the remark on every timing.
#pragma once

#include <string>

namespace polhode {

/// Version reported by the linked library, for example "6.4.1".
std::string sundials_version();

/// How SUNDIALS was compiled: "6.4.1, built from source at -O3", "6.4.1, packaged library, unoptimised" or
/// "6.4.1, installed, flags unknown".
std::string sundials_build();

/// True if the library is a binary known to be compiled without optimisation, so that its timings reflect the package.
bool sundials_unoptimised();

}  // namespace polhode
