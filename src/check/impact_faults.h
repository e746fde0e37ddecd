// What a file shows of impacts on the scene's planes.
#pragma once

#include <vector>

#include "check/diagnosis.h"
#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

/// Impacts that are missed, the body passing through a plane ("impact_missed"), and impacts whose normal speed comes
/// back in another measure than the plane's restitution says ("restitution_wrong"): told where a single point touches,
/// fast enough that neither gravity nor the turning matters within a row. Nothing where the scene has no planes, or the
/// file no w, p or v.
std::vector<Diagnosis> impact_faults(const Scene& scene, const TrajectoryFile& file);

}  // namespace polhode
