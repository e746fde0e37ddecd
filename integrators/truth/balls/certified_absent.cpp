// Replaces the certified reference in programs built without Arb.
#include "integrators/truth/balls/certified.h"

namespace polhode {

CertifiedReference certified_reference(const Scene&, long, int digits, double) {
    CertifiedReference result;
    result.requested_digits = digits;
    result.message =
        "no certified truth: this program was built without Arb; install libflint-arb-dev and libflint-dev, and "
        "rebuild";
    return result;
}

CertifiedReference certified_reference(const Scene& scene, const std::vector<double>& times, int digits,
                                       double seconds_limit) {
    return certified_reference(scene, static_cast<long>(times.size()), digits, seconds_limit);
}

std::string ball_arithmetic_version() { return ""; }

}  // namespace polhode
