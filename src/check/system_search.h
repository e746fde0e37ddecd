// Which faults explain a file of several bodies: each step from a row to the next is predicted with and without them.
#pragma once

#include <string>
#include <vector>

#include "check/diagnosis.h"

namespace polhode {

/// The faults of engine, loads, joints and bodies that explain a file of a scene of several bodies: those of
/// check/system_faults.h, tried one by one and the best with any other. Needs the attitudes of all bodies that can
/// move; velocities and positions that the file lacks follow from the joints where these tie all bodies to the world.
/// Looks at a few dozen steps without impulses or load changes. `all` tries them on a sound file too.
Diagnosed diagnose_system(const Scene& scene, const TrajectoryFile& file, bool all = false);

}  // namespace polhode
