// Displaced, separating or limited joints, diagnosed from the poses of a file without dynamics.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "check/diagnosis.h"

namespace polhode {

/// Diagnoses each joint whose bodies are in the file: a displaced anchor or axis, bodies that separate and are pulled
/// back, a limit. Positions are needed, and velocities for the rate of Baumgarte stabilisation. `predicts(k)`:
/// whether the scene's motion leads from moment k of the file to moment k + 2. If it does, a joint that stops there,
/// for example at a dead centre, is not at a limit.
std::vector<Diagnosis> joint_faults(const Scene& scene, const TrajectoryFile& file,
                                    const std::function<bool(std::size_t)>& predicts);

}  // namespace polhode
