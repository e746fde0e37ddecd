// Errors of a trajectory at the contacts of one body with planes: penetration, slip, energy and event times.
//
// Penetration and slip are measured in the trajectory itself, in 128 bits: a contact point is the lowest point of a
// piece of the body's hull in the trajectory's attitude. Whether the reference rolls at a sample is decided from its
// numbers: a gap and a slip below 1e-20 of the motion's size, which the reference's 25 digits separate from all others.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

/// An event at a contact with a plane.
struct ContactEvent {
    Pair t;                 ///< s
    std::string kind;       ///< "impact", "lands", "rolls", ..
    std::size_t plane = 0;  ///< index of the plane

    /// Whether all members are equal.
    bool operator==(const ContactEvent&) const = default;
};

/// The times of two lists of events, compared in order.
struct EventComparison {
    std::optional<double> time_error;  ///< s, the largest difference; empty if no events match
    std::string message;               ///< describes the first missing or additional event; empty if there is none
};

/// Matches events of the same kind and plane in order, up to the first one that is missing in either list. Impacts that
/// precede the limit of infinitely many impacts (`accumulates`) in one list only are skipped.
EventComparison compare_events(std::span<const ContactEvent> computed, std::span<const ContactEvent> reference);

/// Compares the times of impacts that a method reports with the reference's. Empty if it reports none.
EventComparison compare_impacts(const Trajectory& trajectory, const Reference& reference);

/// Errors of a run at contacts. Empty: undefined.
struct ContactErrors {
    std::optional<double> event_time;   ///< largest error of event times, s
    std::optional<double> penetration;  ///< largest depth of the body in a plane, m
    std::optional<double> slip;         ///< largest speed of the contact point where the reference rolls, m/s
    std::optional<double> energy_gain;  ///< largest increase of the energy, where loads cannot increase it, J
};

/// Errors of a trajectory of one body with planes. All are empty for other scenes and for runs that did not reach their
/// end. `event_time` is that of compare_impacts().
/// `slip` needs the reference and is empty if it never rolls. `energy_gain` is empty if a load of the scene can
/// increase the energy. Sample k of both must be at the same time.
ContactErrors contact_errors(const Scene& scene, const Trajectory& trajectory, const Reference& reference);

}  // namespace polhode
