// What tells stiff motion from other.
#pragma once

#include "motion/problem.h"

namespace polhode {

/// How often what decays would decay, against how far the body turns: what binds an explicit method's steps by
/// stability, and what any method's by accuracy.
struct Stiffness {
    double decays = 0;   ///< integral over the run of the largest |lambda|, of eigenvalues of df/dy that decay
    double turning = 0;  ///< integral over the run of |omega|, rad

    /// Explicit steps of high order span about five decays and about a radian; ten implicit ones, of ten times the
    /// price, bring a motion to rest.
    bool stiff() const { return decays > 500 && decays > 20 * turning; }
};

/// Looks along the motion itself, found to three digits by `radau`. Zero where nothing damps, and with a user's own
/// torque, whose derivative an implicit method would lack; where `radau` finds the motion hard it is not stiff. Of
/// several bodies by their start alone; of a system of the user's own not known, and zero.
Stiffness stiffness(const Problem& problem);

/// stiffness(problem).stiff()
bool is_stiff(const Problem& problem);

}  // namespace polhode
