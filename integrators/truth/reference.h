// The reference solution (ground truth) of a scene, to the digits on which two independent formulations agree.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "motion/problem.h"
#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

/// Default limit of the time that one thread may spend on a reference, s.
constexpr double truth_seconds = 3600;

/// Computes the reference at sample_time(duration, k, samples), k = 0..samples. A sample at the time of an event shows
/// the motion after the event. The motion is computed twice, by two formulations with different orders and steps. If
/// they differ by more than 10^-digits (attitude in rad, other blocks relative to their largest length), the precision
/// is raised; if that fails, `available` is false and the message gives the number of digits that agreed. Also
/// unavailable: user-defined torques, contacts that the modes of integrators/contact do not cover, and runs that take
/// either thread more than `seconds_limit` seconds of processor time (these are not cached). Other results are cached
/// on disk by the scene's content, in $POLHODE_CACHE, $XDG_CACHE_HOME/polhode or ~/.cache/polhode, the first that is
/// set. Throws InputError if the scene is invalid, std::invalid_argument if samples or digits is less than 1.
Reference reference(const Scene& scene, long samples, int digits = 25, double seconds_limit = truth_seconds);

/// Computes the reference at the given times, s, which must increase from 0 or later. The run ends at the last time,
/// which may exceed the scene's duration. Throws std::invalid_argument if there are no times or they are out of order.
/// Otherwise as reference() for equally spaced samples.
Reference reference(const Scene& scene, const std::vector<double>& times, int digits = 25,
                    double seconds_limit = truth_seconds);

/// How the reference of a posed scene is computed: "closed form" if it has one and rotates by more than 2 10^5 rad,
/// "collocation" if the motion is stiff, "none" for a user-defined torque, otherwise "Taylor series".
std::string_view truth_method(const Problem& problem);

/// The columns of a trajectory file after t, as decimals: q, w in world axes, p, v.
using DecimalColumns = std::array<std::string, 13>;

/// The components of a reaction as decimals: force, torque, both in world axes.
using ReactionDecimals = std::array<std::string, 6>;

/// An event at a contact with a plane, as decimals.
struct DecimalContactEvent {
    std::string t;                                  ///< s
    std::size_t plane = 0;                          ///< index of the plane
    std::string event;                              ///< "impact", "lands", "rolls", ..
    std::string normal_impulse;                     ///< N s; "0" unless an impulse acts
    std::array<std::string, 3> tangential_impulse;  ///< N s, world axes

    /// Whether all members are equal.
    bool operator==(const DecimalContactEvent&) const = default;
};

/// An interval in which a body is in flight, slides or rolls, as decimals.
struct DecimalContactInterval {
    std::string from;          ///< s
    std::string to;            ///< s
    std::size_t plane = 0;     ///< index of the plane; not used in flight
    std::string mode;          ///< "flight", "sliding" or "rolling"
    double largest_ratio = 0;  ///< largest |F|/(mu N); 0 in flight and without friction

    /// Whether all members are equal.
    bool operator==(const DecimalContactInterval&) const = default;
};

/// The reference as decimal strings.
struct DecimalReference {
    bool available = false;     ///< false: only `message` is set
    std::string message;        ///< why it is unavailable, or how it was computed
    double bound = 0;           ///< largest of the attitude error (rad) and the relative errors of the other blocks
    std::string scene_hash;     ///< hash of write_scene(scene)
    std::vector<double> times;  ///< sample times, s
    int bodies = 1;             ///< number of bodies at each time
    std::vector<DecimalColumns> columns;  ///< one row per time and body
    /// As Reference::reactions, if known; NaN is an empty string. With contact modes: of each plane on the body.
    std::vector<ReactionDecimals> reactions;
    std::vector<std::string> impact_times;  ///< times of impacts on the scene's planes, s
    double impact_time_error = 0;           ///< largest error of these times, s
    /// Events at contacts, by time; empty if the motion was computed without contact modes.
    std::vector<DecimalContactEvent> contact_events;
    /// The modes over time; empty if the motion was computed without contact modes.
    std::vector<DecimalContactInterval> contact_intervals;
};

/// Computes the reference at sample_time(duration, k, samples), k = 0..samples, as decimals. `digits` digits are
/// correct relative to the largest length of a block (q, w, p or v); a component that nearly vanishes has fewer correct
/// digits. Two more digits are written. Cache, time limit and exceptions: see reference().
DecimalReference decimal_reference(const Scene& scene, long samples, int digits = 17,
                                   double seconds_limit = truth_seconds);

/// Computes the reference at the given times, s, as decimals. Times and exceptions: see reference().
DecimalReference decimal_reference(const Scene& scene, const std::vector<double>& times, int digits = 17,
                                   double seconds_limit = truth_seconds);

/// Largest number of digits that reference() and decimal_reference() support.
constexpr int most_truth_digits = 80;

}  // namespace polhode
