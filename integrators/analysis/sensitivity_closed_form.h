// Derivative of a motion with respect to its initial state if it has a closed form: no steps, any time.
#pragma once

#include <vector>

#include "integrators/series/linear_algebra.h"
#include "motion/problem.h"

namespace polhode {

/// d (attitude, w)(t) / d (attitude, w)(0) at each time, s; attitude as a rotation vector, w in units of its scale.
/// Empty if the motion or a neighbouring one has no closed form, or if there are several segments. Uses central
/// differences of the closed form in 113 bits with a step of 1e-16. Relative error: about 1e-18 per radian of rotation,
/// plus the square of 1e-16 times the derivative.
std::vector<Eigen::Matrix<double, 6, 6>> sensitivity_by_closed_form(const Problem& problem,
                                                                    const std::vector<double>& times);

}  // namespace polhode
