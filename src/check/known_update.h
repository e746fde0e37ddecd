// Which method of the catalogue an engine's file follows, and what it could do better with.
#pragma once

#include <optional>

#include "check/diagnosis.h"

namespace polhode {

/// The engine update of the catalogue whose motion, at the file's own step, is nearest to the file: named where the
/// file is ten times nearer to it than to the scene's motion. Nothing where rows do not begin at 0 or are not evenly
/// spaced. Looks at the first 240 rows at most. `in_binary32`: of states in that precision too.
std::optional<FollowedUpdate> followed_update(const Scene& scene, const TrajectoryFile& file, int steps,
                                              bool in_binary32);

}  // namespace polhode
