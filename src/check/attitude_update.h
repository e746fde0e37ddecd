// Detects first-order quaternion updates in the rows of a file.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "motion/trajectory_csv.h"

namespace polhode {

/// The first-order update q + (h/2) w q, normalised. The exact update is exp(h w / 2) q.
struct FirstOrderUpdate {
    double step = 0;       ///< h, s
    double error = 0;      ///< rms error of the rotation from row to row, predicted by exact updates, rad
    double explained = 0;  ///< the same error, predicted by first-order updates, rad
};

/// Tests whether first-order updates predict the attitudes of the file's first rows from its w at least ten times
/// better than exponential updates. Both use the w at the start, middle or end of a step and 1 to 20 steps per row.
/// Returns nothing if they do not, if the error of exponential updates is below 1e-6 rad per row, or if the body
/// rotates by more than 1 rad per row.
std::optional<FirstOrderUpdate> first_order_update(const TrajectoryFile& file);

}  // namespace polhode
