// When damping makes a motion stiff for the truth.
#pragma once

#include <algorithm>

#include "motion/problem.h"

namespace polhode::truth {

/// The fastest decay times the length of the segment: trace(I^-1 D) is at most three times its largest eigenvalue.
inline double damping_number(const Problem& problem, const Segment& segment) {
    const Forcing<double>& f = segment.forcing;
    const double rate = f.has_translational_drag && !problem.body.pivoted ? f.specific_drag : 0;
    double trace = 0;
    for (int i = 0; i < 3; ++i) trace += f.has_damping ? problem.principal.inverse_moments[i] * f.damping[i][i] : 0;
    return std::max(rate, trace) * (segment.end - segment.begin);
}

/// Beyond it a series would take its steps at the damping rate, and a collocation polynomial as the motion goes.
constexpr double stiff_damping_number = 3000;

}  // namespace polhode::truth
