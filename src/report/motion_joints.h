// Joints of a motion for the page: coordinates, rates, limits, modes and events.
#pragma once

#include "report/motion_contacts.h"

namespace polhode {

/// Coordinates and rates of the joints of a mechanism over its duration, and modes and events of joints with limits or
/// friction. Coordinates of a scene without such joints are those of the truth. Otherwise they are those of the motion
/// in binary64; if it is not within `tolerance` of the truth, only a remark is returned.
MotionDetails joints_of_motion(const Scene& scene, const Reference& truth, const Tolerance& tolerance);

}  // namespace polhode
