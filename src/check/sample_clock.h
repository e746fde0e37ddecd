// The times of a trajectory file whose clock was a binary32 number.
#pragma once

#include <optional>

#include "motion/trajectory_csv.h"

namespace polhode {

/// Where all times are within binary32 rounding of a uniform grid's, k0 dt, (k0 + 1) dt, .., and not within binary64
/// rounding of it, sets them to the grid's and returns dt (s): a body that turns at 10 rad/s is 6e-7 rad further on
/// after the rounding of t = 1 s alone, which is the clock's fault. dt is the roundest number that fits: duration over
/// a whole number, one over a whole number, or the decimal of the fewest digits.
std::optional<double> restore_clock(TrajectoryFile& file, double duration);

}  // namespace polhode
