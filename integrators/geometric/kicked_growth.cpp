#include "integrators/geometric/kicked_growth.h"

#include <algorithm>
#include <cmath>

#include "integrators/geometric/composition.h"
#include "integrators/geometric/kick.h"
#include "integrators/run/amplification.h"

namespace polhode {

double kicked_pendulum_growth(int order, double damping, double stiffness) {
    // The factors exp(-c g) of the stages multiply to exp(-c), and theta is unchanged. Large factors would lose this
    // in binary64.
    if (stiffness == 0) return std::max(1.0, std::exp(-damping));
    // Columns: images of (1, 0) and (0, 1).
    double theta[2] = {1, 0}, v[2] = {0, 1};
    const auto kick = [&](double length) {
        const double factor = length * mean_decay(damping * length);
        for (int i = 0; i < 2; ++i) v[i] -= factor * (stiffness * theta[i] + damping * v[i]);
    };
    double before = 0;
    for (const double g : composition(order)) {
        kick(0.5 * (before + g));
        for (int i = 0; i < 2; ++i) theta[i] += g * v[i];
        before = g;
    }
    kick(0.5 * before);
    return spectral_radius(theta[0], theta[1], v[0], v[1]);
}

}  // namespace polhode
