// The principal frame about a pivot, computed with more than 113 bits.
#pragma once

#include "body/rigid_body.h"
#include "scene/scene.h"

namespace polhode {

/// The principal frame of a scene's body, computed with enough digits to survive cancellation.
struct FinerFrame {
    WidePrincipalFrame wide;           ///< rounded once to 113 bits
    PrincipalFrame nearest;            ///< rounded once to binary64
    Matrix3<double> inverse_inertia;   ///< body axes, 1/(kg m^2), rounded once
    Vector3<Wide> angular_velocity_B;  ///< at t = 0, in the axes of `wide`, rad/s
};

/// Whether 113 bits may not give binary64 accuracy of the smallest moment or of a difference of moments. True if that
/// moment is below 1e-10 of the largest, and either the axes had to be computed or the tensor was moved to a pivot.
bool needs_finer_frame(const Matrix3<Wide>& inertia, bool moved, const Vector3<double>& moments);

/// The frame of the tensor about the pivot or the centre of mass, computed in 120 decimal digits.
FinerFrame finer_frame(const Scene& scene);

}  // namespace polhode
