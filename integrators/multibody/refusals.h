// Values of Method::refusal that methods for mechanisms share.
#pragma once

#include <string>

#include "motion/problem.h"

namespace polhode::multibody {

/// For all of them: the scene must have several bodies. Joints must have neither friction nor limits.
std::string mechanism_refusal(const Problem& problem);

/// For methods that use the inverse of each body's mass and tensor and support friction and limits of joints: every
/// body must have both, and no joint an armature.
std::string impulse_refusal(const Problem& problem);

/// impulse_refusal() for methods that do not support restitution at limits.
std::string soft_limit_refusal(const Problem& problem);

/// For methods in joint coordinates that support friction and limits without restitution, and neither loops nor
/// couplings.
std::string reduced_limit_refusal(const Problem& problem);

/// Why binary32 cannot represent a mechanism: a mass, moment or scale out of range, or a body without inertia. Empty if
/// it can, and for problems that are not mechanisms.
std::string mechanism_binary32_refusal(const Problem& problem);

}  // namespace polhode::multibody
