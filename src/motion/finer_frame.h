// The principal frame about a pivot in more digits than 113 bits have.
#pragma once

#include "body/rigid_body.h"
#include "scene/scene.h"

namespace polhode {

/// The principal frame of a scene's body, in as many digits as its cancellation can take.
struct FinerFrame {
    WidePrincipalFrame wide;           ///< rounded once to 113 bits
    PrincipalFrame nearest;            ///< rounded once to binary64
    Matrix3<double> inverse_inertia;   ///< body axes, 1/(kg m^2), rounded once
    Vector3<Wide> angular_velocity_B;  ///< at t = 0, in the axes of `wide`, rad/s
};

/// Whether 113 bits may leave fewer than binary64's digits of the least moment, or of a difference beside it: it is
/// below 1e-10 of the largest, and the axes had to be found or the tensor moved to a pivot.
bool needs_finer_frame(const Matrix3<Wide>& inertia, bool moved, const Vector3<double>& moments);

/// The frame of the tensor about the pivot or the centre of mass, worked out in 120 decimal digits.
FinerFrame finer_frame(const Scene& scene);

}  // namespace polhode
