// The principal frame in binary64, for bodies by the million.
#pragma once

#include "body/rigid_body.h"

namespace polhode {

/// As principal_frame, worked out in binary64: moments and axes are those of a tensor that differs from this one by a
/// few epsilon of its largest moment. Of entries that disagree across the diagonal their mean counts. What is not
/// finite comes back not finite.
PrincipalFrame fast_principal_frame(const Matrix3<double>& inertia);

}  // namespace polhode
