// How wrong a trajectory is: attitude first, then the angular momentum as a vector, then energy.
#pragma once

#include <optional>
#include <vector>

#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

/// Errors at each sample that the trajectory reached. Differences from the truth are formed in 128 bits.
struct ErrorSeries {
    std::vector<double> t;         ///< s
    std::vector<double> attitude;  ///< rad, 2 atan2(|vec(q_ref* q)|, |scal(q_ref* q)|), q normalised
    std::vector<double> omega;     ///< |w_B - w_B,ref| / max |w_ref|
    std::vector<double> energy;    ///< |E - E_ref| / max over the run of max(|E_ref|, kinetic energy)
    std::vector<double> momentum;  ///< |L_W - L_ref| / max |L_ref|, a difference of vectors
    std::vector<double> norm;      ///< ||q| - 1|, or the orthogonality defect of a matrix method
    /// rad: what rounding of the start alone makes of the attitude in binary64; whoever knows the conditioning sets it
    std::vector<double> float64_floor;
};

/// The columns of the result table. A number that does not exist is empty: all but `norm_max` without a truth, all of
/// them for a run that did not reach the end, and one that overflows.
struct Errors {
    std::optional<double> attitude_final, attitude_max, omega_max, energy_max, momentum_max, norm_max;
};

/// Sample by sample, as far as both go; sample k of the one must be sample k of the other (same t), else
/// std::invalid_argument. A scale of zero makes that error absolute.
ErrorSeries error_series(const Scene& scene, const Trajectory& trajectory, const Reference& reference);

/// Rotation angle (rad) between q, normalised, and the truth, without regard to sign.
double attitude_error(const Quaternion<double>& q, const Quaternion<Pair>& reference);

Errors errors(const ErrorSeries& series, const Trajectory& trajectory, const Reference& reference);

/// ||q| - 1| (or the orthogonality defect) at each sample: needs no truth.
std::vector<double> norm_errors(const Trajectory& trajectory);

}  // namespace polhode
