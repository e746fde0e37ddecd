// Identifies the update of the catalogue that a file follows.
#pragma once

#include <optional>

#include "check/diagnosis.h"

namespace polhode {

/// Finds the engine update of the catalogue that a file follows, with one step or `steps` steps per row. The file
/// matches an update if its attitude agrees to rounding from the first row on, up to the row at which it departs. The
/// file resembles an update if it is ten times closer to it than to the scene's motion over its first 240 rows.
/// Returns nothing if the attitude is correct, or if rows do not start at 0 or are not evenly spaced. `noise`:
/// relative rounding error of the file's numbers.
std::optional<UpdateMatch> identify_update(const Scene& scene, const TrajectoryFile& file, int steps, double noise);

}  // namespace polhode
