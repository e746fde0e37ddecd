// Golden data: the truth of a scene for the unit tests of an engine.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "body/support.h"
#include "check/convention.h"
#include "integrators/truth/reference.h"
#include "scene/scene.h"

namespace polhode {

/// The tolerance of one block of the motion.
struct GoldenTolerance {
    std::string block;  ///< one of tolerated_blocks
    double value = 0;   ///< in the convention's units; relative for energy and momentum
    std::string from;   ///< where it was set
};

/// An event at a contact, or at a joint with friction or limits.
struct GoldenEvent {
    double t = 0;       ///< s
    std::string body;   ///< name; of an event of a joint: the joint
    std::string other;  ///< name of the plane or of the other body; empty for a joint
    std::string event;  ///< "impact", "lands", "rolls", ..
    /// Along the normal, kg m/s in the convention's unit of length; of a joint: on its coordinate.
    double impulse = 0;
    Vector3<double> tangential_impulse;  ///< on the body, world axes; zero for a joint
};

/// The data that an engine's test needs, in the axes and units of a convention.
struct Golden {
    std::string scene_hash, truth;
    Convention convention;
    Scene scene;  ///< in the convention's axes and unit of length
    /// For each body: the pieces whose convex hull is the body, from its origin; empty if the scene does not say.
    std::vector<std::vector<SupportPiece<double>>> shapes;
    /// The rows at t = 0 are the start. w in rad/s, or degrees/s in a convention with degrees.
    TrajectoryFile motion;
    std::vector<double> energy;             ///< kinetic and potential, at each time, kg m^2/s^2
    std::vector<Vector3<double>> momentum;  ///< angular, about pivot or centre of mass, world axes, kg m^2/s
    /// Reactions of several bodies, kg m/s^2 and kg m^2/s^2: at each time those of the joints, then of the loops.
    /// Empty if the truth does not determine them.
    std::vector<Vector3<double>> forces, torques;
    std::vector<GoldenEvent> events;              ///< by time
    double energy_scale = 1, momentum_scale = 1;  ///< scales of their errors; 1 for absolute errors
    double bound = 0;  ///< error bound of the numbers with rounding to binary64, rad and relative
    std::vector<GoldenTolerance> tolerances;  ///< one per block, the attitude (rad) first
    std::optional<double> float64_floor;      ///< largest over the run, rad
    double float32_floor = 0;                 ///< largest over the run, rad
};

/// Converts all numbers of a scene to the convention's axes and unit of length; kg and s stay. Bodies keep their
/// mass, tensor and centre of mass, but not the shapes they are made of.
Scene convert_scene(const Convention& convention, const Scene& scene);

/// Collects the golden data of a scene. Throws std::invalid_argument if its truth is not available.
///
/// The tolerance of a block is the scene's `tolerated`, for the attitude at least the float32 floor. Without it, the
/// tolerance is the default limit of `check` (see ErrorLimits) or ten times the float32 floor, whichever is larger,
/// so that binary32 engines can meet it. The floor comes from the conditioning. If this is not available, the floor
/// is the error caused by one rounding of the start to binary32, or else pi.
///
/// The tolerance of event times is a step of an engine at 60 Hz, because it sees an event at the end of a step.
Golden golden(const Scene& scene, const Reference& truth, const Convention& convention,
              std::span<const DecimalContactEvent> events);
/// s
inline constexpr double golden_event_tolerance = 1.0 / 60;

/// Output formats of golden data.
enum class GoldenFormat {
    csv,     ///< the motion as a trajectory file
    json,    ///< all data
    c,       ///< a C99 and C++ header with arrays and a function that compares a state
    cpp,     ///< a C++17 header with constexpr arrays and this function
    csharp,  ///< a C# static class with arrays and this function
};

/// Writes golden data. Numbers below 1e-300 in magnitude are written as 0. `floats`: write arrays of float, with
/// numbers rounded to binary32. In C, names start with polhode_ and the scene's name, in which characters other than
/// letters and digits become _; in C++ this is the namespace and in C# the class (Polhode_). Throws
/// std::invalid_argument if a number exceeds the range of its type.
std::string golden_text(const Golden& golden, GoldenFormat format, bool floats);

}  // namespace polhode
