// How wrong a trajectory is: attitude first, then the angular momentum as a vector, then energy.
#pragma once

#include <optional>
#include <vector>

#include "measure/measures.h"
#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

/// Errors at each sample that the trajectory reached: series["attitude"][k] at t[k]. Differences from the truth are
/// formed in 128 bits. Measures that need a truth are empty without one.
struct ErrorSeries : PerMeasure<std::vector<double>> {
    std::vector<double> t;  ///< s
    /// rad: what rounding of the start alone makes of the attitude in binary64; whoever knows the conditioning sets it
    std::vector<double> float64_floor;
};

/// One measure of a run. A number that does not exist is empty: without the truth that it needs, of a run that did not
/// reach the end, and a maximum that overflows.
struct ErrorOfRun {
    std::optional<double> final, max;  ///< at the end, and the largest over all samples
};
/// errors["attitude"].max, ..
using Errors = PerMeasure<ErrorOfRun>;

/// Sample by sample, as far as both go; sample k of the one must be sample k of the other (same t), else
/// std::invalid_argument. A scale of zero makes that error absolute.
ErrorSeries error_series(const Scene& scene, const Trajectory& trajectory, const Reference& reference);

Errors errors(const ErrorSeries& series, const Trajectory& trajectory, const Reference& reference);

}  // namespace polhode
