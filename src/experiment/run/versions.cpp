#include "experiment/run/versions.h"

#include <fmt/format.h>
#include <gmp.h>
#include <mpfr.h>
#include <sys/utsname.h>

#include <boost/version.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "integrators/gsl/gsl.h"
#include "integrators/series/linear_algebra.h"
#include "integrators/sundials/build.h"
#include "integrators/truth/balls/certified.h"

namespace polhode {

std::vector<std::pair<std::string, std::string>> library_versions() {
    const std::string arb = ball_arithmetic_version();
    std::vector<std::pair<std::string, std::string>> versions{
        {"SUNDIALS", sundials_build()},
        {"Boost", fmt::format("{}.{}.{}", BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000, BOOST_VERSION % 100)},
        {"Eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
        {"MPFR", mpfr_get_version()},
        {"GMP", gmp_version},
        {"Arb", arb.empty() ? "not available (no certified truth)" : arb},
        {"fmt", fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100)},
        {"JSON for Modern C++", fmt::format("{}.{}.{}", NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR,
                                            NLOHMANN_JSON_VERSION_PATCH)},
    };
    if (const std::string gsl = gsl_library_version(); !gsl.empty()) versions.emplace_back("GSL (GPL)", gsl);
    return versions;
}

std::string processor_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name") && line.find(": ") != line.npos) return line.substr(line.find(": ") + 2);
    // without /proc, or on processors without a model name
    struct utsname machine {};
    if (::uname(&machine) != 0) return "unknown";
    return fmt::format("{}, {} processors, {} {}", machine.machine, std::thread::hardware_concurrency(),
                       machine.sysname, machine.release);
}

}  // namespace polhode
