// Reasons for which several methods refuse a problem: values of Method::refuses.
#pragma once

#include <string>

#include "motion/problem.h"

namespace polhode {

/// Of an implicit method that is given the exact Jacobian.
inline std::string no_jacobian_of_user_torque(const Problem& problem) {
    return problem.needs.user_torque ? "a torque of the user's own has no Jacobian" : "";
}

}  // namespace polhode
