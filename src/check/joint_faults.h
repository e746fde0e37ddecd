// Joints that are not where the scene has them, or do not hold: what the poses of a file show without any dynamics.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "check/diagnosis.h"

namespace polhode {

/// Of each joint whose bodies the file has: an anchor or an axis that is elsewhere, bodies that drift apart and are
/// pulled back, a limit that stops it. Positions are needed, for Baumgarte's rate also velocities. `predicts`: whether
/// the scene's own motion goes from a moment of the file to the second one after it; where a joint is stopped by
/// itself, as in a dead centre, there is no limit.
std::vector<Diagnosis> joint_faults(const Scene& scene, const TrajectoryFile& file,
                                    const std::function<bool(std::size_t)>& predicts);

}  // namespace polhode
