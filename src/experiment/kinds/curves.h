// Curves of rows, and the pictures that several kinds make of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/run/findings.h"
#include "experiment/run/result.h"

namespace polhode {

/// The rows of one curve on one scene, from coarse to fine.
std::vector<const Result*> rows_of(const std::vector<Result>& results, const PlannedScene& scene,
                                   const PlannedCurve& curve);

/// A curve's name in legends: the method's, and how it is controlled where it can be in two ways.
std::string curve_label(const PlannedCurve& curve);

/// The curve of that label, begun in the next colour where there is none yet.
Curve& curve_named(std::vector<Curve>& curves, const std::string& label);

/// What pictures call them, as the columns of the table are called.
inline constexpr const char *float64_floor_label = "float64 floor", *float32_floor_label = "float32 floor";

/// The errors that rounding of the start alone causes, in binary64 and binary32: levels in a panel of the attitude's
/// error. From the scene's first row that knows them.
std::vector<Guide> floor_guides(const std::vector<Result>& results, const PlannedScene& scene,
                                std::optional<double> Floors::*float64, std::optional<double> Floors::*float32);

/// Gives a curve the look of its method, and its family for a group.
void look_as(Curve& curve, const PlannedCurve& planned);

/// Notes what the reader of a picture must know: why a curve was cut, a SUNDIALS compiled without optimisation.
void tell(Figure& figure, const Plan& plan);

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

}  // namespace polhode
