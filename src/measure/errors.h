// Errors of a trajectory against the reference: attitude first, then the angular momentum as a vector, then energy.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "measure/measures.h"
#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

/// Errors at each sample that the trajectory reached: series["attitude"][k] at t[k]. Differences from the reference
/// are formed in 128 bits. Measures that need a reference are empty without one.
struct ErrorSeries : PerMeasure<std::vector<double>> {
    std::vector<double> t;   ///< s
    std::string worst_body;  ///< several bodies: the name of the one with the largest attitude error; empty without a
                             ///< reference
    /// rad: attitude error from rounding the initial state to binary64; set by callers that compute the conditioning
    std::vector<double> float64_floor;
};

/// One measure of a run. Undefined values are empty: without the reference that a measure needs, for a run that did
/// not reach its end, and for a maximum that overflows.
struct ErrorOfRun {
    std::optional<double> final;  ///< at the end of the run
    std::optional<double> max;    ///< the largest over all samples
};
/// The measures of a run by name: errors["attitude"].max is its largest attitude error.
struct Errors : PerMeasure<ErrorOfRun> {
    std::string worst_body;  ///< several bodies: the name of the one with the largest attitude error; else empty
};

/// Errors of a trajectory of `scene` against its reference, sample by sample, up to the end of the shorter one.
/// Sample k of both must be at the same time; otherwise throws std::invalid_argument. A scale of zero makes an error
/// absolute. For several bodies, the errors of attitude, w, p, v and norm are those of the worst body, all others
/// those of the whole system; a momentum that vanishes to round-off has scale zero.
ErrorSeries error_series(const Scene& scene, const Trajectory& trajectory, const Reference& reference);

/// The final and the maximum errors of a run, from its series.
Errors errors(const ErrorSeries& series, const Trajectory& trajectory, const Reference& reference);

}  // namespace polhode
