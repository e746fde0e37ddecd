// Which method of the catalogue an engine's file follows, and what it could do better with.
#pragma once

#include <optional>

#include "check/diagnosis.h"

namespace polhode {

/// The engine update of the catalogue that a file goes by, at the file's own step or a part of it. It matches where the
/// attitude follows to rounding from the first row on, until the row at which it leaves, if it does. One that does not
/// match is given where the file is ten times nearer to it than to the scene's motion over its first 240 rows: it
/// resembles it. Nothing where the attitude is right, or where rows do not begin at 0 or are not evenly spaced.
/// `steps`: from row to row, tried beside one; `noise`: relative, of the file's numbers.
std::optional<FollowedUpdate> followed_update(const Scene& scene, const TrajectoryFile& file, int steps, double noise);

}  // namespace polhode
