// The principal frame computed in binary64, fast enough for ensembles of millions of bodies.
#pragma once

#include "body/rigid_body.h"

namespace polhode {

/// Computes principal_frame() in binary64. The result is the principal frame of a tensor that differs from `inertia`
/// by a few epsilon of its largest moment. If `inertia` is not symmetric, its symmetric part is used. Non-finite
/// input gives non-finite output.
PrincipalFrame fast_principal_frame(const Matrix3<double>& inertia);

}  // namespace polhode
