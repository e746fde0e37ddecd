// Tables and pictures of a finished experiment.
#pragma once

#include <string>
#include <vector>

#include "experiment/run/result.h"
#include "figure/figure.h"

namespace polhode {

/// A picture and the name of its file, without extension.
struct NamedFigure {
    std::string name;
    Figure figure;
};

/// The rows of one curve on one scene, from coarse to fine.
std::vector<const Result*> rows_of(const std::vector<Result>& results, const PlannedScene& scene,
                                   const PlannedCurve& curve);

/// A curve's name in legends: the method's, and how it is controlled where it can be in two ways.
std::string curve_label(const PlannedCurve& curve);

/// What pictures call them, as the columns of the table are called.
inline constexpr const char *float64_floor_label = "float64 floor", *float32_floor_label = "float32 floor";

/// The errors that rounding of the start alone causes, in binary64 and binary32: levels in a panel of the attitude's
/// error. From the scene's first row that knows them.
std::vector<Guide> floor_guides(const std::vector<Result>& results, const PlannedScene& scene,
                                std::optional<double> Floors::*float64, std::optional<double> Floors::*float32);

/// What the reader of a picture must know: why a curve was cut, a SUNDIALS compiled without optimisation.
std::string figure_note(const Plan& plan, bool cut);

/// Error against run time, a panel a scene, a curve a method and kind of setting.
std::vector<NamedFigure> work_precision_figures(const Plan& plan, const std::vector<Result>& results);

/// Error against step, and against tolerance.
std::vector<NamedFigure> convergence_figures(const Plan& plan, const std::vector<Result>& results);

/// Attitude, momentum and energy error against time, a picture a scene.
std::vector<NamedFigure> drift_figures(const Plan& plan, const std::vector<Result>& results);

/// The largest attitude error against the tolerance asked for.
std::vector<NamedFigure> tolerance_figures(const Plan& plan, const std::vector<Result>& results);

/// Energy, momentum, attitude and norm error against time, both logarithmic, a picture a scene and cost.
std::vector<NamedFigure> conservation_figures(const Plan& plan, const std::vector<Result>& results);

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
Table gain_table(const Plan& plan, const std::vector<Result>& results);

/// NAME_growth: for each scene, cost and method the error of energy, momentum, norm and attitude at the end of a long
/// run and the exponents with which they grew.
Table growth_table(const Plan& plan, const std::vector<Result>& results);

/// NAME_summary: for each method and kind of setting over all scenes: what the text it is from calls it, its order, how
/// many scenes ended how, and at each setting that it ran at the worst errors of attitude, momentum, energy and norm
/// and the median time of a step over that of odeint_rk4 on the same scene.
Table summary_table(const Plan& plan, const std::vector<Result>& results);

/// Writes NAME.csv, .md, .tex, .json, the tables above as the kind asks, the pictures, and this experiment's entry in
/// provenance.json. Returns remarks for the user (a picture that could not be drawn). Throws std::runtime_error.
std::vector<std::string> write_report(const Plan& plan, const std::vector<Result>& results,
                                      const std::string& directory, const std::string& command_line, bool quick);

}  // namespace polhode
