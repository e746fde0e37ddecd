// Certified truth: a scene's motion with digits that are proven. Ball arithmetic (Arb) all the way, from the scene's
// binary64 numbers, taken exactly, to the decimals.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "integrators/truth/reference.h"
#include "scene/scene.h"

namespace polhode {

/// The true number lies within `radius` of `value`, for certain; rounding to decimals is in the radius.
struct CertifiedNumber {
    std::string value;   ///< decimal, as far as it is proven
    std::string radius;  ///< decimal, rounded upward; "0" where the value is exact
    int digits = 0;      ///< proven digits: radius <= 10^-digits times the largest length of its block (q: 1)
};

struct CertifiedReference {
    bool available = false;
    std::string message;     ///< why there is none, or how it was made
    std::string method;      ///< what enclosed the motion
    std::string scene_hash;  ///< of write_scene(scene)
    int requested_digits = 0;
    int digits = 0;            ///< the least proven of any number
    long working_bits = 0;     ///< of the last and widest attempt
    long steps = 0;            ///< of the integration; 0 where closed forms did it all
    double seconds = 0;        ///< wall clock
    std::string radius = "0";  ///< the largest
    std::vector<double> times;
    int bodies = 1;                                        ///< how many there are at each time
    std::vector<std::array<CertifiedNumber, 13>> columns;  ///< at each time, of each body: q, w in world axes, p, v
    std::vector<std::string> bounds;                       ///< the largest radius of each of these
};

/// The motion at sample_time(duration, k, samples), k = 0..samples; a sample at the time of an event shows the motion
/// after it. Every radius is at most 10^-digits, and at most 10^-digits times the largest length of its block (q, w,
/// p, v) over the run. Precision is raised until it is; where that is out of reach `available` is false and the
/// message says how many digits can be had. Several bodies are enclosed where no loops tie them. A scene with a user's
/// own torque has no truth, and a program built without Arb has none that is certified. Nor is there one that would
/// take the thread more than `seconds_limit` seconds. Throws InputError on an invalid scene, std::invalid_argument on
/// fewer than 1 sample or digit.
CertifiedReference certified_reference(const Scene& scene, long samples, int digits,
                                       double seconds_limit = truth_seconds);

/// The same at times of the caller's own (s), which increase from 0 or later and none of which is beyond the scene's
/// duration; else std::invalid_argument.
CertifiedReference certified_reference(const Scene& scene, const std::vector<double>& times, int digits,
                                       double seconds_limit = truth_seconds);

/// Version of the ball arithmetic in use; empty where the program was built without it.
std::string ball_arithmetic_version();

}  // namespace polhode
