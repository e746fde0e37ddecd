#include "integrators/sundials/build.h"

#include <fmt/format.h>
#include <sundials/sundials_version.h>

namespace polhode {

std::string sundials_version() {
    int major = 0, minor = 0, patch = 0;
    char label[32] = "";
    if (SUNDIALSGetVersionNumber(&major, &minor, &patch, label, static_cast<int>(sizeof label)) != 0) return "unknown";
    return fmt::format("{}.{}.{}{}{}", major, minor, patch, *label ? "-" : "", label);
}

std::string sundials_build() { return POLHODE_SUNDIALS_BUILD; }

bool sundials_unoptimised() { return POLHODE_SUNDIALS_UNOPTIMISED != 0; }

}  // namespace polhode
