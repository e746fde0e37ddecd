// Criterion for strong damping, where the reference is computed by collocation.
#pragma once

#include <algorithm>

#include "motion/problem.h"

namespace polhode::truth {

/// Fastest decay rate times the length of the segment. trace(I^-1 D) is at most three times its largest eigenvalue.
inline double damping_number(const Problem& problem, const Segment& segment) {
    const Forcing<double>& f = segment.forcing;
    const double rate = f.has_translational_drag && !problem.body.pivoted ? f.specific_drag : 0;
    double trace = 0;
    for (int i = 0; i < 3; ++i)
        trace += f.has_damping ? problem.body.principal.inverse_moments[i] * f.damping[i][i] : 0;
    return std::max(rate, trace) * (segment.end - segment.begin);
}

/// Beyond this damping number the steps of a series are limited by the damping rate, those of a collocation polynomial
/// only by the motion. (Stiffness for a solver in binary64 is a different criterion: run/stiffness.h.)
constexpr double strong_damping_number = 3000;

/// True if the sum of the damping numbers of all segments exceeds the limit. False for several bodies.
inline bool is_strongly_damped(const Problem& problem) {
    if (!std::holds_alternative<OneBody>(problem.system)) return false;
    double sum = 0;
    for (const Segment& segment : problem.segments) sum += damping_number(problem, segment);
    return sum > strong_damping_number;
}

}  // namespace polhode::truth
