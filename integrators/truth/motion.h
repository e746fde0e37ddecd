// What the truth's formulations share: the motion they stand for, and the layout of a state.
#pragma once

#include <vector>

#include "body/algebra.h"

namespace polhode::truth {

/// The motion at one time; p and v of the centre of mass.
template <class P>
struct Motion {
    Quaternion<P> q;  ///< body to world, of unit length
    Vector3<P> angular_velocity_B, position_W, velocity_W;
};

/// A block of a state's variables that are measured by one scale.
struct Block {
    int first, size;
    double scale;  ///< estimate of the block's largest length over the run
};

}  // namespace polhode::truth
