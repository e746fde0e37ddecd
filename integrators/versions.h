// What this build stands on: for --version, for provenance, and for the word beside every timing of SUNDIALS.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace polhode {

/// As the library linked says of itself, e.g. "6.4.1".
std::string sundials_version();

/// How SUNDIALS was compiled: "6.4.1, built from source at -O3", "6.4.1, packaged library, unoptimised" or
/// "6.4.1, installed, flags unknown".
std::string sundials_build();

/// Whether it is a binary known to be compiled without optimisation: its timings speak of the package.
bool sundials_unoptimised();

/// Name and version of every library in use: SUNDIALS, Boost, Eigen, MPFR, GMP, Arb, fmt, JSON for Modern C++, and GSL
/// in a program that has it.
std::vector<std::pair<std::string, std::string>> library_versions();

}  // namespace polhode
