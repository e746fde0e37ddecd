// Curves and figures from rows, shared by several kinds.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/run/findings.h"
#include "experiment/run/result.h"

namespace polhode {

/// The rows of one curve on one scene, from coarse to fine.
std::vector<const Result*> select_rows(const std::vector<Result>& results, const PlannedScene& scene,
                                       const PlannedCurve& curve);

/// The name of a curve in legends: the method, and the kind of setting if the method takes steps and tolerances.
std::string curve_label(const PlannedCurve& curve);

/// The curve with that label. Appends one in the next colour if there is none.
Curve& find_or_add_curve(std::vector<Curve>& curves, const std::string& label);

/// Labels of the floors in figures, equal to the headings of their columns.
inline constexpr const char *float64_floor_label = "float64 floor", *float32_floor_label = "float32 floor";

/// Levels of the attitude error that rounding of the start alone causes, in binary64 and binary32. Taken from the
/// scene's first row that has them.
std::vector<Guide> floor_guides(const std::vector<Result>& results, const PlannedScene& scene,
                                std::optional<double> Floors::*float64, std::optional<double> Floors::*float32);

/// Sets the style of a curve from its method, and its group from the method's family.
void style_curve(Curve& curve, const PlannedCurve& planned);

/// Adds notes to a figure: why curves are cut, and that SUNDIALS is unoptimised.
void add_figure_notes(Figure& figure, const Plan& plan);

/// Attitude error against run time: one panel per scene, one curve per method and kind of setting.
std::vector<NamedFigure> work_precision_figures(const Plan& plan, const std::vector<Result>& results);

/// Attitude error at T against step, and against tolerance.
std::vector<NamedFigure> convergence_figures(const Plan& plan, const std::vector<Result>& results);

/// Attitude, momentum and energy error against time: one figure per scene.
std::vector<NamedFigure> drift_figures(const Plan& plan, const std::vector<Result>& results);

/// Largest attitude error against tolerance.
std::vector<NamedFigure> tolerance_figures(const Plan& plan, const std::vector<Result>& results);

/// Energy, momentum, attitude and norm error against time on logarithmic axes: one figure per scene and cost.
std::vector<NamedFigure> conservation_figures(const Plan& plan, const std::vector<Result>& results);

}  // namespace polhode
