// Versions of the libraries in use, and the processor, for --version and provenance.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace polhode {

/// Name and version of every library in use: SUNDIALS, Boost, Eigen, MPFR, GMP, Arb, fmt, JSON for Modern C++, and GSL
/// if it is linked.
std::vector<std::pair<std::string, std::string>> library_versions();

/// The model name of the processor, to be reported with timings. If the system gives none: architecture, number of
/// processors and operating system.
std::string processor_name();

}  // namespace polhode
