// Certified reference solution: the motion of a scene with proven digits. All steps use ball arithmetic (Arb), from the
// scene's binary64 numbers, taken exactly, to the decimals.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "integrators/truth/reference.h"
#include "scene/scene.h"

namespace polhode {

/// The exact number lies within `radius` of `value`. The radius includes the rounding to decimals.
struct CertifiedNumber {
    std::string value;   ///< decimal, to as many digits as are proven
    std::string radius;  ///< decimal, rounded upward; "0" if the value is exact
    int digits = 0;      ///< proven digits: radius <= 10^-digits times the largest length of its block (q: 1)
};

/// An event at a contact of a sphere with a plane.
struct CertifiedEvent {
    std::string kind;   ///< "impact", "lands", "accumulates" or "rolls"
    std::string plane;  ///< name of the plane
    CertifiedNumber t;  ///< s
};

struct CertifiedReference {
    bool available = false;
    std::string message;     ///< why no result is available, or how it was computed
    std::string method;      ///< method that enclosed the motion
    std::string scene_hash;  ///< hash of write_scene(scene)
    int requested_digits = 0;
    int digits = 0;            ///< smallest number of proven digits in any column
    long working_bits = 0;     ///< precision of the last (highest) attempt
    long steps = 0;            ///< steps of the integration; 0 if closed forms covered the whole run
    double seconds = 0;        ///< wall clock, s
    std::string radius = "0";  ///< largest radius of all numbers
    std::vector<double> times;
    int bodies = 1;                                        ///< number of bodies at each time
    std::vector<std::array<CertifiedNumber, 13>> columns;  ///< one row per time and body: q, w in world axes, p, v
    std::vector<std::string> bounds;                       ///< largest radius of each row
    std::vector<CertifiedEvent> events;                    ///< contacts of a sphere with planes, up to the last sample
};

/// Computes the motion at sample_time(duration, k, samples), k = 0..samples. A sample at the time of an event shows the
/// motion after the event. Every radius is at most 10^-digits, and at most 10^-digits times the largest length of its
/// block (q, w, p, v) over the run. The precision is raised until this holds. If it cannot be reached, `available` is
/// false and the message gives the number of digits that can be reached. Several bodies are supported without loops.
/// Planes are supported for a uniform sphere under constant gravity: in flight, impacts, sliding with a constant
/// direction and rolling on one plane at a time. Also unavailable: scenes with a user-defined torque or other contacts,
/// programs built without Arb, and runs that take the thread more than `seconds_limit` seconds of processor time.
/// Throws InputError if the scene is invalid, std::invalid_argument if samples or digits is less than 1.
CertifiedReference certified_reference(const Scene& scene, long samples, int digits,
                                       double seconds_limit = truth_seconds);

/// Computes the motion at the given times, s. Throws std::invalid_argument unless the times increase, the first is
/// >= 0 and the last is at most the scene's duration. Otherwise as certified_reference() for equally spaced samples.
CertifiedReference certified_reference(const Scene& scene, const std::vector<double>& times, int digits,
                                       double seconds_limit = truth_seconds);

/// Version of the ball arithmetic library; empty if the program was built without it.
std::string ball_arithmetic_version();

}  // namespace polhode
