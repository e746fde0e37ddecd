// What the rows of a sweep say, as tables.
#pragma once

#include <vector>

#include "experiment/run/findings.h"
#include "experiment/run/result.h"

namespace polhode {

/// NAME_orders: for each scene, method and kind of setting the claimed order and the observed one, the range it was
/// fitted to, the smallest and largest error; of the attitude error at the end. For tolerances the slope of log error
/// over log tolerance.
Table order_table(const Plan& plan, const std::vector<Result>& results);

/// NAME_fastest: for each scene and each of the errors 1e-6, 1e-9, 1e-12 rad the fastest run that stays below it over
/// all samples, and the runners-up by their ratio in time.
Table fastest_table(const Plan& plan, const std::vector<Result>& results);

/// NAME_digits: for each scene and method, and for each tolerance R, log10(R / largest attitude error in rad): the
/// digits gained over what was asked for, lost where negative. Then each method's median and worst over the scenes.
Table digits_table(const Plan& plan, const std::vector<Result>& results);

/// NAME_gain: for each scene, method and kind of setting the times of the three formulations at one and the same
/// largest attitude error (that of the reduced form half-way along its curve; between settings by a straight line
/// through log time over log error), the factor in time that leaving out is worth, the error of the reduced form over
/// that of the full one at equal settings, and what was left out.
NamedTable gain_table(const Plan& plan, const std::vector<Result>& results);

/// NAME_growth: for each scene, cost and method the error of energy, momentum, norm and attitude at the end of a long
/// run and the exponents with which they grew.
NamedTable growth_table(const Plan& plan, const std::vector<Result>& results);

/// NAME_summary: for each method and kind of setting over all scenes: what the text it is from calls it, its order, how
/// many scenes ended how, and at each setting that it ran at the worst errors of attitude, momentum, energy and norm
/// and the median time of a step over that of odeint_rk4 on the same scene.
NamedTable summary_table(const Plan& plan, const std::vector<Result>& results);

}  // namespace polhode
