// Faults of friction while a ball slides or rolls on a plane.
#pragma once

#include <vector>

#include "check/diagnosis.h"
#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

/// Diagnoses faults of friction from the impulses between rows in which a ball stays on a plane. Impulses do not depend
/// on the engine's step, so that a coarse step is not reported as a fault:
/// - "friction_missing", "friction_scaled", "friction_pyramid": the impulse while the ball slides is zero, another part
///   of the normal impulse than mu, or not against the slip.
/// - "friction_at_center": friction changes the velocity, but not the angular velocity.
/// - "hollow_inertia": friction changes the angular velocity, or a slope the velocity, as that of a hollow ball.
/// - "rolling_slips", "rolling_slowed": the contact point of a rolling ball moves; a rolling ball accelerates less than
///   its inertia allows.
/// - "spin_friction": the spin about the normal changes, although the plane has no torsional friction.
/// - "rolling_sleeps": the motion of a rolling ball ends from one row to the next.
///
/// Returns nothing if the body is not a uniform or point-symmetric ball, if loads other than constant gravity act, or
/// if the file has no position, velocity or angular velocity.
std::vector<Diagnosis> contact_faults(const Scene& scene, const TrajectoryFile& file);

}  // namespace polhode
