// Types shared by the reference's formulations: the motion of bodies and the layout of a state.
#pragma once

#include <vector>

#include "body/algebra.h"
#include "motion/mechanism_motion.h"

namespace polhode::truth {

/// The motion of a body at one time.
template <class P>
using Motion = BodyMotion<P>;
/// The motions of several bodies at one time, in the scene's order.
template <class P>
using Motions = std::vector<Motion<P>>;

/// A block of state variables with a common scale.
struct Block {
    int first, size;
    double scale;  ///< estimate of the block's largest length over the run
};

}  // namespace polhode::truth
