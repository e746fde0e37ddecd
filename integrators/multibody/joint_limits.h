// The limits of a joint's coordinate.
#pragma once

#include <array>
#include <cmath>

#include "scene/scene.h"

namespace polhode::multibody {

/// One side of the range of a coordinate.
template <class S>
struct JointLimit {
    S sign;   ///< 1 or -1: the sign of a rate away from the limit
    S limit;  ///< times sign; infinite if there is none

    bool exists() const { return std::isfinite(limit); }
    /// Negative beyond the limit.
    S gap_at(S coordinate) const { return sign * coordinate - limit; }
};

/// The lower and the upper limit.
template <class S>
std::array<JointLimit<S>, 2> limits_of(const Joint& joint) {
    return {JointLimit<S>{S(1), S(joint.limits.lower)}, JointLimit<S>{S(-1), S(-joint.limits.upper)}};
}

}  // namespace polhode::multibody
