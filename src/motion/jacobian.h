// The Jacobians of the systems of one body, compiled once for all methods.
#pragma once

#include "motion/dual.h"
#include "motion/systems.h"

namespace polhode {

/// @cond
extern template void jacobian(const PrincipalAxisRotation&, double, const double*, double*);
extern template void jacobian(const FreeRotation&, double, const double*, double*);
extern template void jacobian(const LoadedRotation&, double, const double*, double*);
extern template void jacobian(const LoadedMotion&, double, const double*, double*);
extern template void jacobian(const FullMotion&, double, const double*, double*);
/// @endcond

}  // namespace polhode
