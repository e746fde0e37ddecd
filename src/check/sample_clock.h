// Restores the times of a trajectory file whose clock was a binary32 number.
#pragma once

#include <optional>

#include "motion/trajectory_csv.h"

namespace polhode {

/// If all times are within binary32 rounding of a uniform grid k0 dt, (k0 + 1) dt, .., but not within binary64
/// rounding, sets them to the grid and returns dt (s). Otherwise the clock would cause attitude errors: at 10 rad/s,
/// rounding t = 1 s to binary32 rotates the body by up to 6e-7 rad. dt is the simplest number that fits: the duration
/// over an integer, 1 over an integer, or the decimal with the fewest digits.
std::optional<double> restore_clock(TrajectoryFile& file, double duration);

}  // namespace polhode
