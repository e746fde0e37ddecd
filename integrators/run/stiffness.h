// Stiffness of a motion.
#pragma once

#include "motion/problem.h"

namespace polhode {

/// Number of decay times against rotation. Decay limits the steps of an explicit method by stability; rotation limits
/// the steps of any method by accuracy.
struct Stiffness {
    double decay_times = 0;  ///< integral over the run of the largest |lambda| of decaying eigenvalues of df/dy
    double rotation = 0;     ///< integral over the run of |omega|, rad

    /// Explicit steps of high order cover about five decay times and about one radian. Ten implicit steps, each about
    /// ten times as expensive, bring a motion to rest.
    bool stiff() const { return decay_times > 500 && decay_times > 20 * rotation; }
};

/// Evaluates the stiffness along the motion, which `radau` computes to a tolerance of 1e-3. Returns zero if nothing
/// damps, for user-defined torques (implicit methods require their derivative), for user-defined systems, with planes,
/// and if `radau` does not complete within 5000 steps. A mechanism is evaluated from its initial state only.
Stiffness stiffness(const Problem& problem);

/// stiffness(problem).stiff()
bool is_stiff(const Problem& problem);

}  // namespace polhode
