// What the two formulations of a truth have in common: mass properties, the tensor's shift to a pivot, its inverse, and
// how the bodies start. What rounding takes of these it takes of both, so that their agreement tells nothing of it.
#pragma once

#include "scene/scene.h"

namespace polhode::truth {

/// How far the shared data in arithmetic of `working` decimal digits (50 or 100) are off from those in far more digits,
/// relative to their own sizes: the worst of masses, centres, tensors, inverse tensors, the gyroscopic acceleration
/// I^-1 (w x Iw) relative to |w|^2, attitudes (rad), angular velocities, positions and velocities. Zero where no more
/// is lost than any step rounds anew; infinite where the data are not finite.
template <unsigned working>
double shared_rounding(const Scene& scene);

extern template double shared_rounding<50>(const Scene&);
extern template double shared_rounding<100>(const Scene&);

/// How far a truth is off by a shared rounding, at most: the rounding grows as the motion makes the errors of its steps
/// grow, and the motion goes through `radians` meanwhile. `difference`: of the two runs, in arithmetic of `working`
/// digits by steps to `local_digits`.
double shared_error(double rounding, double radians, double difference, unsigned working, double local_digits);

}  // namespace polhode::truth
