// Contact points, forces and slips over time, along the modes and events of a motion.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "body/algebra.h"
#include "integrators/contact/contact_record.h"
#include "motion/problem.h"
#include "scene/scene.h"

namespace polhode {

/// What takes part in the contact of an event or interval: a body, and a plane or another body.
struct ContactParts {
    std::size_t body = 0;
    std::optional<std::size_t> plane;  ///< index of the plane
    std::optional<std::size_t> other;  ///< index of the other body
};

/// The parts of the contact with this number (see contact_with_plane()).
ContactParts parts_of_contact(const Scene& scene, std::size_t contact);

/// A contact at one time.
struct ContactSample {
    double t = 0;             ///< s
    Vector3<double> point_W;  ///< m; of a face: where the pressure acts
    Vector3<double> force_W;  ///< force of the plane on the body, N
    Vector3<double> slip_W;   ///< tangential velocity of the body's point in contact, m/s
};

/// The modes and events of a motion, and the contacts with planes within its intervals.
struct ContactHistory {
    std::string fault;                                     ///< why the run stopped early; empty if it did not
    contact::Record<double> record;                        ///< in the order of time
    std::vector<std::vector<BodyMotion<double>>> motions;  ///< by requested time that was reached, then by body
    std::vector<std::vector<ContactSample>> of_interval;   ///< one list per interval of `record`; empty in flight
};

/// Follows a scene with planes or contacts in binary64. `times` (s): those of `motions`. Each interval of contact gets
/// a part of `samples` samples in proportion to its length, but at least four. The intervals after the first
/// samples / 4 have none. No sample is at an event, where forces jump.
ContactHistory contact_history(const Problem& problem, const std::vector<double>& times, std::size_t samples);

}  // namespace polhode
