// Contacts of a motion for the page: modes, events, contact points, forces and slips.
#pragma once

#include <string>

#include "motion/trajectory.h"
#include "report/json_numbers.h"
#include "report/keyframes.h"
#include "scene/scene.h"

namespace polhode {

/// What the page shows of contacts or joints beside the motion, as the keys of Motion of
/// src/report/page/source/data.ts.
struct MotionDetails {
    Json timeline;                  ///< Timeline, or null
    Json contacts = Json::array();  ///< ContactCurves[]
    Json coordinates;               ///< JointCurves, or null
    std::string remark;             ///< why something is not shown; may be empty
};

/// Modes, events, contact points, forces and slips of a scene with planes or contacts, along its duration. They are
/// those of the motion in binary64; if it is not within `tolerance` of the truth, only a remark is returned.
MotionDetails contacts_of_motion(const Scene& scene, const Reference& truth, const Tolerance& tolerance);

}  // namespace polhode
