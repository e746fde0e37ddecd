// The truth: a scene's motion to digits that two separately written formulations agree on.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "motion/problem.h"
#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

/// How long a truth may take where nobody says otherwise, s.
constexpr double truth_seconds = 3600;

/// The truth at sample_time(duration, k, samples), k = 0..samples; a sample at the time of an event shows the motion
/// after it. Made twice, in two formulations with two orders and steps; where they differ by more than 10^-digits
/// (attitude in rad, other blocks relative to their largest length) precision is raised, and in the end
/// `available` is false and the message says how many digits agreed. A scene with a user's own torque has no truth,
/// nor has one with friction at a plane, or a body that comes to rest on one.
/// Kept in a cache on disk by the scene's content: $POLHODE_CACHE, else $XDG_CACHE_HOME/polhode, else
/// ~/.cache/polhode. One that would take longer than `seconds_limit` seconds of either thread's own time is not made:
/// `available` is false, and nothing is kept. Throws InputError on an invalid scene, std::invalid_argument on fewer
/// than 1 sample or digit.
Reference reference(const Scene& scene, long samples, int digits = 25, double seconds_limit = truth_seconds);

/// The truth at times of the caller's own (s), which increase from 0 or later. The run lasts to the last of them, also
/// where that lies beyond the scene's duration. Throws std::invalid_argument where there are no times or they are not
/// in order; all else is as for equally spaced samples.
Reference reference(const Scene& scene, const std::vector<double>& times, int digits = 25,
                    double seconds_limit = truth_seconds);

/// What makes the truth of a posed scene: "Taylor series", "collocation" where the motion is stiff, "closed form" where
/// it has one and lasts beyond 2 10^5 rad, "none" with a user's own torque.
std::string_view truth_method(const Problem& problem);

/// The numbers of one line of a trajectory file after t, as decimals: q, w in world axes, p, v.
using DecimalColumns = std::array<std::string, 13>;

/// The numbers of a reaction as decimals: force, torque, both in world axes.
using ReactionDecimals = std::array<std::string, 6>;

/// The truth in decimals.
struct DecimalReference {
    bool available = false;     ///< false: there is none, and nothing but `message` is set
    std::string message;        ///< why there is none, or how it was made
    double bound = 0;           ///< largest of the attitude's error (rad) and the other blocks' relative errors
    std::string scene_hash;     ///< of write_scene(scene)
    std::vector<double> times;  ///< of the samples, s
    int bodies = 1;             ///< how many there are at each time
    std::vector<DecimalColumns> columns;      ///< at each time those of each body
    std::vector<ReactionDecimals> reactions;  ///< where they are known, as Reference::reactions; empty for NaN
    std::vector<std::string> impact_times;    ///< s, of the impacts on the scene's planes
    double impact_time_error = 0;             ///< s, largest of them
};

/// The truth at sample_time(duration, k, samples), k = 0..samples, as decimals. `digits` digits are right relative to
/// the largest length of a block (q, w, p or v), so that a component that nearly vanishes has fewer of its own; two
/// more are written. The cache, the limit of time and what is thrown are as for reference().
DecimalReference decimal_reference(const Scene& scene, long samples, int digits = 17,
                                   double seconds_limit = truth_seconds);

/// The same at times of the caller's own (s), as reference() takes them.
DecimalReference decimal_reference(const Scene& scene, const std::vector<double>& times, int digits = 17,
                                   double seconds_limit = truth_seconds);

/// The most digits that can be asked for.
constexpr int most_truth_digits = 80;

}  // namespace polhode
