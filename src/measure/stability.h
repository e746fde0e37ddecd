// What became of a run: one definition of "stable", and the classes of what lies beyond.
#pragma once

#include <array>

#include "measure/errors.h"
#include "motion/trajectory.h"

namespace polhode {

enum class Outcome {
    accurate,           ///< the attitude within 1e-3 rad of the truth at every sample
    close,              ///< within 0.1 rad
    wrong_but_bounded,  ///< further off, and nothing of the numbers shows it
    damped_to_rest,     ///< the body stopped where the true one moves on
    diverged,           ///< the solver says so, or to the end with finite numbers but not stable: see is_stable()
    tolerance_not_met,
    failed,       ///< the solver's own word, or one of the run's limits
    unsupported,  ///< not run
    no_truth,     ///< nothing to judge it by
};
inline constexpr std::array outcomes{Outcome::accurate,       Outcome::close,       Outcome::wrong_but_bounded,
                                     Outcome::damped_to_rest, Outcome::diverged,    Outcome::tolerance_not_met,
                                     Outcome::failed,         Outcome::unsupported, Outcome::no_truth};

/// "accurate", "close", "wrong but bounded", ..
const char* name_of(Outcome outcome);

inline constexpr double accurate_attitude = 1e-3, close_attitude = 0.1;  ///< rad

/// Stable: the run reached its end, and at no sample did the angular velocity's error exceed 4 times the motion's
/// largest rate or the energy's error 8 times its largest energy. A motion that is only out of phase with the truth, or
/// turns the other way, differs from it by twice its own size in rate; 4 and 8 are reached by what has grown to three
/// times the rate of the true motion, nine times its kinetic energy. Growth that has not come so far at the end of the
/// run is not seen: the bound is one over the run. `of_run` is of a run that ended `ok`; without a truth never stable.
bool is_stable(const Errors& of_run);

/// Damped to rest: over the last quarter of its samples the body turns at less than a tenth of the true rate (root mean
/// squares), where the true one keeps at least a thousandth of its largest.
bool is_damped_to_rest(const Trajectory& trajectory, const Reference& reference);

/// The class of a run. A tolerance-driven one that ends more than 1 rad off is Status::tolerance_not_met before this.
Outcome outcome_of(const Trajectory& trajectory, const Errors& errors, const Reference& reference);

}  // namespace polhode
