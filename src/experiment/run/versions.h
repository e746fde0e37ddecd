// What this build stands on: for --version, for provenance, and for the word beside every timing of SUNDIALS.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace polhode {

/// Name and version of every library in use: SUNDIALS, Boost, Eigen, MPFR, GMP, Arb, fmt, JSON for Modern C++, and GSL
/// in a program that has it.
std::vector<std::pair<std::string, std::string>> library_versions();

/// The name that this machine's processor gives itself, which timings are to be told with; where it gives none, its
/// architecture, the number of processors and the operating system.
std::string processor_name();

}  // namespace polhode
