// What happens at the contacts of a run: events, intervals of one mode, and contact forces, over any scalar.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "body/body_motion.h"

namespace polhode::contact {

/// The equations that a body follows.
enum class Mode {
    flight,   ///< no contact
    sliding,  ///< contact with slip
    rolling,  ///< contact without slip: rolling or sticking
    // with torsional or rolling friction
    sliding_without_spin,      ///< slip; the spin is zero and is held
    sliding_without_rolling,   ///< slip; the rolling velocity is zero and is held
    sliding_without_rotation,  ///< slip; spin and rolling velocity are zero and are held
    rolling_without_spin,      ///< no slip; the spin is zero and is held
    spinning,                  ///< no slip; rolling is held
    resting,                   ///< no slip; spin and rolling are held
};

/// A change of mode or an impact.
enum class EventKind {
    impact,          ///< an impact after which the body separates
    lands,           ///< an arrival after which contact continues
    rolls,           ///< the slip ends
    slides,          ///< slip starts
    lifts_off,       ///< contact ends without an impact
    accumulates,     ///< the limit of infinitely many impacts
    stops,           ///< the body comes to rest
    spin_stops,      ///< torsional friction ends the spin
    spin_starts,     ///< the torque about the normal exceeds the limit of torsional friction
    rolling_stops,   ///< rolling friction ends the rolling
    rolling_starts,  ///< the torque exceeds the limit of rolling friction
};

/// Names in files and messages.
inline constexpr std::array<const char*, 9> mode_names{"flight",
                                                       "sliding",
                                                       "rolling",
                                                       "sliding_without_spin",
                                                       "sliding_without_rolling",
                                                       "sliding_without_rotation",
                                                       "rolling_without_spin",
                                                       "spinning",
                                                       "resting"};
inline constexpr std::array<const char*, 11> event_names{"impact",      "lands",         "rolls",         "slides",
                                                         "lifts_off",   "accumulates",   "stops",         "spin_stops",
                                                         "spin_starts", "rolling_stops", "rolling_starts"};

/// An event at a contact with a plane.
template <class P>
struct Event {
    P t = P(0);             ///< s
    std::size_t plane = 0;  ///< index of the plane
    EventKind kind = EventKind::impact;
    P normal_impulse = P(0);          ///< N s; zero unless an impulse acts
    Vector3<P> tangential_impulse_W;  ///< N s
};

/// An interval in which the equations do not change.
template <class P>
struct Interval {
    P from = P(0), to = P(0);  ///< s
    std::size_t plane = 0;     ///< index of the plane; not used in flight
    Mode mode = Mode::flight;
    double largest_ratio = 0;  ///< largest |F|/(mu N); 0 in flight and without friction
};

/// Events and intervals of a run, in the order of time.
template <class P>
struct Record {
    std::vector<Event<P>> events;
    std::vector<Interval<P>> intervals;
};

/// Result of a run with contacts.
template <class P>
struct Run {
    std::string fault;                              ///< why the run stopped early; empty if it did not
    std::vector<BodyMotion<P>> motions;             ///< one per sample
    std::vector<std::vector<Vector3<P>>> forces_W;  ///< per sample: the force of each plane on the body, N
    /// Per sample: the torque of each plane's torsional and rolling friction about the contact point, N m.
    std::vector<std::vector<Vector3<P>>> torques_W;
    Record<P> record;
    long steps = 0;
    long evaluations = 0;  ///< number of right-hand sides, or of series if the steps are Taylor series
};

}  // namespace polhode::contact
