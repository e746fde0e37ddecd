// Determines which system a scene can be posed as, and which variables and terms can be omitted.
#pragma once

#include "motion/problem.h"

namespace polhode {

/// Sets problem.needs, problem.body.axis and every segment's about_axis. The rest of `problem`, except its scales,
/// must be complete. `exact` and the 128-bit forcings must belong to it.
void find_needs(Problem& problem, const ExactBody<Wide>& exact, const Quaternion<Wide>& q_BP,
                const std::vector<Forcing<Wide>>& forcings);

/// Estimates problem.scales by a coarse run: Bogacki-Shampine 3(2) with relative tolerance 1e-3 and at most 20,000
/// steps.
void find_scales(Problem& problem);

}  // namespace polhode
