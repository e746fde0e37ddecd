// Tables from the rows of a sweep.
#pragma once

#include <vector>

#include "experiment/run/findings.h"
#include "experiment/run/result.h"

namespace polhode {

/// NAME_orders: for each scene, method and kind of setting the claimed and the observed order of the attitude error at
/// T, the fitted range, and the smallest and largest error. For tolerances the order is the slope of log error over log
/// tolerance.
Table order_table(const Plan& plan, const std::vector<Result>& results);

/// NAME_fastest: for each scene and each of accuracy_levels the fastest run whose attitude error is within it at all
/// samples, the runner-up, and the ratio of their times.
Table fastest_table(const Plan& plan, const std::vector<Result>& results);

/// NAME_digits: log10(R / largest attitude error in rad) for each scene, method and tolerance R. Positive values are
/// digits gained over the tolerance, negative values digits lost. The first rows are each method's median and smallest
/// value over the scenes.
Table digits_table(const Plan& plan, const std::vector<Result>& results);

/// NAME_gain: for each scene, method and kind of setting the times of the three formulations at the same largest
/// attitude error, the gain in time of the reduced formulation, the ratio of reduced to full error at equal settings,
/// and what was omitted. The error is that of the reduced formulation in the middle of its curve; times come from a
/// least-squares line through log time over log error.
NamedTable gain_table(const Plan& plan, const std::vector<Result>& results);

/// NAME_growth: for each scene, cost and method the largest errors of energy, momentum, norm and attitude in a long
/// run, and the exponents of their growth.
NamedTable growth_table(const Plan& plan, const std::vector<Result>& results);

/// NAME_summary: for each method and setting, over all scenes: its description in the source text, its order, the
/// numbers of outcomes, the largest errors of attitude, momentum, energy and norm, and the median ratio of its time per
/// step to that of odeint_rk4 on the same scene.
NamedTable summary_table(const Plan& plan, const std::vector<Result>& results);

}  // namespace polhode
