#include "integrators/contact_stepping/contact_state.h"

namespace polhode::contact_stepping {

std::string contact_refusal(const Problem& problem) {
    for (const Plane& plane : problem.scene.planes)
        if (plane.torsional_friction > 0 || plane.rolling_friction > 0)
            return "time-stepping contact methods do not support torsional and rolling friction";
    return "";
}

}  // namespace polhode::contact_stepping
