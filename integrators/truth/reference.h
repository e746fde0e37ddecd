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

/// The motion at sample_time(duration, k, samples), k = 0..samples; a sample at the time of an event shows the motion
/// after it. Made twice, in two formulations with two orders and steps; where they differ by more than 10^-digits
/// (attitude in rad, other blocks relative to their largest length) precision is raised, and in the end
/// `available` is false and the message says how many digits agreed. A scene with a user's own torque has no truth,
/// nor has one with friction at a plane, or a body that comes to rest on one.
/// Kept in a cache on disk by the scene's content: $POLHODE_CACHE, else $XDG_CACHE_HOME/polhode, else
/// ~/.cache/polhode. One that would take longer than `seconds_limit` seconds of either thread's own time is not made:
/// `available` is false, and nothing is kept. Throws InputError on an invalid scene, std::invalid_argument on fewer
/// than 1 sample or digit.
Reference reference(const Scene& scene, long samples, int digits = 25, double seconds_limit = truth_seconds);

/// The same at times of the caller's own (s), increasing from 0 or later. The run lasts to the last of them, also
/// beyond the scene's duration. Throws std::invalid_argument where the times are none or not in order.
Reference reference(const Scene& scene, const std::vector<double>& times, int digits = 25,
                    double seconds_limit = truth_seconds);

/// What makes the truth of a posed scene: "Taylor series", "collocation" where the motion is stiff, "closed form" where
/// it has one and lasts beyond 2 10^5 rad, "none" with a user's own torque.
std::string_view truth_method(const Problem& problem);

/// Numbers of a trajectory file's columns after t: q, w in world axes, p, v, as decimals.
using DecimalColumns = std::array<std::string, 13>;

struct DecimalReference {
    bool available = false;
    std::string message;     ///< why there is none, or how it was made
    double bound = 0;        ///< as Reference::bound
    std::string scene_hash;  ///< of write_scene(scene)
    std::vector<double> times;
    std::vector<DecimalColumns> columns;    ///< one a sample
    std::vector<std::string> impact_times;  ///< s, of the impacts on the scene's planes
    double impact_time_error = 0;           ///< s, largest of them
};

/// The same motion as decimals of two significant digits more than `digits`: `digits` are right relative to the block's
/// largest length (a component that nearly vanishes has fewer of its own).
DecimalReference decimal_reference(const Scene& scene, long samples, int digits = 17,
                                   double seconds_limit = truth_seconds);

/// The most digits that can be asked for.
constexpr int most_truth_digits = 80;

}  // namespace polhode
