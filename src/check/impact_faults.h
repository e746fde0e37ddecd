// Faults of impacts on the scene's planes.
#pragma once

#include <vector>

#include "check/diagnosis.h"
#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

/// Diagnoses faults of impacts:
/// - "impact_missed": the body passes through a plane.
/// - "penetration_kept": the body stays inside a plane for at least six rows and 0.1 s without moving into it, by more
///   than 2 % of its reach and more than its travel within a row.
/// - "bounce_gains_energy", "restitution_applied_twice", "bounce_dies_below_threshold", "bounce_late": faults of
///   bounces that do not change the rotation (no rotation, or contacts below the centre of mass).
/// - "restitution_wrong": impacts return another part of the normal speed than the plane's restitution. Only impacts
///   of a single point are measured, if they are fast compared with the change of speed within a row.
///
/// Returns nothing if the scene has no planes or the file has no p or v. w is needed except for a ball about its
/// centre of mass.
std::vector<Diagnosis> impact_faults(const Scene& scene, const TrajectoryFile& file);

}  // namespace polhode
