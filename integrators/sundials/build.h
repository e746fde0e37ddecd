// Which SUNDIALS this build stands on, and how it was compiled: for provenance, and for the word beside every timing.
#pragma once

#include <string>

namespace polhode {

/// As the library linked says of itself, e.g. "6.4.1".
std::string sundials_version();

/// How SUNDIALS was compiled: "6.4.1, built from source at -O3", "6.4.1, packaged library, unoptimised" or
/// "6.4.1, installed, flags unknown".
std::string sundials_build();

/// Whether it is a binary known to be compiled without optimisation: its timings speak of the package.
bool sundials_unoptimised();

}  // namespace polhode
