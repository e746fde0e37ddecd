// What a scene really has: which system it can be posed as, and what may be left out.
#pragma once

#include "motion/problem.h"

namespace polhode {

/// Fills in problem.needs, problem.body.axis and every segment's about_axis. The rest of `problem` is complete but for
/// its scales; `exact` and the 128-bit forcings belong to it.
void find_needs(Problem& problem, const ExactBody<Wide>& exact, const Quaternion<Wide>& q_BP,
                const std::vector<Forcing<Wide>>& forcings);

/// Estimates problem.scales by a scout: a Bogacki-Shampine 3(2) run at a relative 1e-3, of 20,000 steps at the most.
void find_scales(Problem& problem);

}  // namespace polhode
