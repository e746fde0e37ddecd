// What tells stiff motion from other.
#pragma once

#include "motion/problem.h"

namespace polhode {

/// Whether damping decays more than 10^4 times within the duration: an explicit step is then bound by stability, not by
/// accuracy. Never with a user's own torque, whose derivative an implicit method would lack.
bool is_stiff(const Problem& problem);

}  // namespace polhode
