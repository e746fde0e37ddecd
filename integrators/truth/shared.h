// Errors that the two formulations of a reference share: rounding of mass properties, of the tensor's shift to a pivot,
// of its inverse and of the initial state. Both runs contain these errors, so that their agreement does not show them.
#pragma once

#include "scene/scene.h"

namespace polhode::truth {

/// Error of the shared data in arithmetic of `working` decimal digits (50 or 100), compared with 200 digits. Returns
/// the largest relative error of masses, centres, tensors, inverse tensors, the gyroscopic acceleration I^-1 (w x Iw)
/// relative to |w|^2, attitudes (rad), angular velocities, positions and velocities. Zero if it does not exceed the
/// rounding error of a step; infinite if the data are not finite.
template <unsigned working>
double shared_rounding(const Scene& scene);

extern template double shared_rounding<50>(const Scene&);
extern template double shared_rounding<100>(const Scene&);

/// Upper estimate of a reference's error due to shared rounding. The rounding error grows by the same factor as the
/// errors of the steps, over a rotation of `radians`. `difference` is that of the two runs, in arithmetic of `working`
/// digits with steps to `local_digits`.
double shared_error(double rounding, double radians, double difference, unsigned working, double local_digits);

}  // namespace polhode::truth
