// Outcome of a run: the definition of "stable" and the classes of all other results.
#pragma once

#include <array>

#include "measure/errors.h"
#include "motion/trajectory.h"

namespace polhode {

/// The class of a run.
enum class Outcome {
    accurate,           ///< attitude within 1e-3 rad of the reference at every sample
    close,              ///< within 0.1 rad
    wrong_but_bounded,  ///< further off, but stable: see is_stable()
    damped_to_rest,     ///< the body stopped while the true one moves on
    diverged,           ///< reported by the solver, or finite to the end but not stable: see is_stable()
    tolerance_not_met,
    failed,       ///< reported by the solver, or a limit of the run
    unsupported,  ///< not run
    no_truth,     ///< no reference to compare with
};
/// All outcomes.
inline constexpr std::array outcomes{Outcome::accurate,       Outcome::close,       Outcome::wrong_but_bounded,
                                     Outcome::damped_to_rest, Outcome::diverged,    Outcome::tolerance_not_met,
                                     Outcome::failed,         Outcome::unsupported, Outcome::no_truth};

/// The outcome as text: "accurate", "close", "wrong but bounded", ..
const char* name_of(Outcome outcome);

inline constexpr double accurate_attitude = 1e-3, close_attitude = 0.1;  ///< rad

/// Stable: the run reached its end, the error of the angular velocity never exceeded 4 times the motion's largest
/// rate, and the energy error never exceeded 8 times its largest energy. A motion that is only out of phase or
/// rotates the other way differs by twice its own rate. The limits 4 and 8 correspond to three times the true rate
/// and nine times the true kinetic energy. Growth that has not reached them by the end of the run is not detected.
/// `of_run` belongs to a run that ended `ok`; without a reference it is never stable.
bool is_stable(const Errors& of_run);

/// Damped to rest: over the last quarter of the samples, the root mean square rate is below a tenth of the true one,
/// while the true one is at least a thousandth of the motion's largest rate.
bool is_damped_to_rest(const Trajectory& trajectory, const Reference& reference);

/// The class of a run. A tolerance-driven run that ends more than 1 rad off must already have
/// Status::tolerance_not_met.
Outcome outcome_of(const Trajectory& trajectory, const Errors& errors, const Reference& reference);

}  // namespace polhode
