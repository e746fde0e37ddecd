#include "integrators/run/march.h"

#include <cmath>
#include <limits>

namespace polhode {

long steps_per_sample(double interval, double step) {
    const double ratio = interval / step, whole = std::round(ratio);
    if (!(ratio < 9e18)) return std::numeric_limits<long>::max();
    // a ratio that misses a whole number by rounding only is that number
    const double steps = std::abs(ratio - whole) <= 1e-9 * ratio ? whole : std::ceil(ratio);
    return steps < 1 ? 1 : static_cast<long>(steps);
}

}  // namespace polhode
