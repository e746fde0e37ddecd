// How wrong a trajectory is: attitude first, then the angular momentum as a vector, then energy.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "measure/measures.h"
#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

/// Errors at each sample that the trajectory reached: series["attitude"][k] at t[k]. Differences from the truth are
/// formed in 128 bits. Measures that need a truth are empty without one.
struct ErrorSeries : PerMeasure<std::vector<double>> {
    std::vector<double> t;   ///< s
    std::string worst_body;  ///< of several: the one whose attitude error is the largest; empty without a truth
    /// rad: what rounding of the start alone makes of the attitude in binary64; whoever knows the conditioning sets it
    std::vector<double> float64_floor;
};

/// One measure of a run. A number that does not exist is empty: without the truth that it needs, of a run that did not
/// reach the end, and a maximum that overflows.
struct ErrorOfRun {
    std::optional<double> final;  ///< at the end of the run
    std::optional<double> max;    ///< the largest over all samples
};
/// The measures of a run by name: errors["attitude"].max is its largest attitude error.
struct Errors : PerMeasure<ErrorOfRun> {
    std::string worst_body;  ///< of several: the one whose attitude error is the largest; else empty
};

/// The errors of a trajectory of `scene` against its truth, sample by sample, as far as both go. Sample k of the one
/// must be at the time of sample k of the other, else std::invalid_argument is thrown. A scale of zero makes an error
/// absolute. Of several bodies: an error of the attitude, w, p, v and the norm is the worst body's, all others are of
/// the bodies together; a momentum that vanishes to round-off has the scale zero.
ErrorSeries error_series(const Scene& scene, const Trajectory& trajectory, const Reference& reference);

/// The errors of a run at its end and at their largest, from its series.
Errors errors(const ErrorSeries& series, const Trajectory& trajectory, const Reference& reference);

}  // namespace polhode
