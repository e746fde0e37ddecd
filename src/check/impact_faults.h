// What a file shows of impacts on the scene's planes.
#pragma once

#include <vector>

#include "check/diagnosis.h"
#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

/// Impacts that are missed, the body passing through a plane ("impact_missed"). Bodies that stay inside a plane without
/// moving into it for at least six rows and 0.1 s, by more than 2 % of their reach and the way of a row
/// ("penetration_kept"). Faults of the bounces of a body that does not rotate, or whose contacts lie below its centre
/// of mass
/// ("bounce_gains_energy", "restitution_applied_twice", "bounce_dies_below_threshold", "bounce_late"). Impacts whose
/// normal speed comes back in another measure than the plane's restitution says ("restitution_wrong"): reported where a
/// single point touches, fast enough that neither gravity nor the rotation matters within a row. Empty where the scene
/// has no planes, or the file no p or v, or no w of a body other than a ball about its centre of mass.
std::vector<Diagnosis> impact_faults(const Scene& scene, const TrajectoryFile& file);

}  // namespace polhode
