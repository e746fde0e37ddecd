// Faults of friction, limits, couplings and armatures of joints.
#pragma once

#include <vector>

#include "check/diagnosis.h"
#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

/// Diagnoses a file of a scene whose joints have friction, limits or couplings. The scene is changed as an engine with
/// a known fault would change it, solved, and compared with the file over all rows; a number is fitted to the file. A
/// fault is reported if it reduces the difference to a fifth or less, so that the error of a coarse step, which no
/// fault explains, is not reported:
/// - "joint_friction_missing", "joint_friction_scaled", "joint_friction_viscous": no dry friction, another size, or
///   damping in its place.
/// - "joint_limit_missing", "joint_limit_shifted", "joint_limit_restitution": a limit does not act, acts elsewhere, or
///   has another coefficient of restitution.
/// - "gear_missing", "gear_inverted", "gear_reversed", "gear_scaled": a coupling is missing, or its ratio is 1/k, -k or
///   another number.
/// - "armature_missing", "armature_scaled".
///
/// Returns nothing if the file has neither all bodies nor attitudes that depend on the joints, or if no fault explains
/// it.
std::vector<Diagnosis> joint_event_faults(const Scene& scene, const TrajectoryFile& file);

}  // namespace polhode
