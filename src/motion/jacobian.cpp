#include "motion/jacobian.h"

namespace polhode {

template void jacobian(const PrincipalAxisRotation&, double, const double*, double*);
template void jacobian(const FreeRotation&, double, const double*, double*);
template void jacobian(const LoadedRotation&, double, const double*, double*);
template void jacobian(const LoadedMotion&, double, const double*, double*);
template void jacobian(const FullMotion&, double, const double*, double*);

}  // namespace polhode
