// Values of Method::refusal that several methods share.
#pragma once

#include <string>

#include "motion/problem.h"

namespace polhode {

/// For implicit methods that require the exact Jacobian.
inline std::string no_jacobian_of_user_torque(const Problem& problem) {
    return problem.needs.user_torque ? "user-defined torques have no Jacobian" : "";
}

}  // namespace polhode
