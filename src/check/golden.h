// A scene's truth as golden data for an engine's own unit tests.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "body/support.h"
#include "check/convention.h"
#include "integrators/truth/reference.h"
#include "scene/scene.h"

namespace polhode {

/// What a block of the motion may be off.
struct GoldenTolerance {
    std::string block;  ///< one of tolerated_blocks
    double value = 0;   ///< in the convention's units; of energy and momentum relative
    std::string from;   ///< who set it
};

/// All that an engine's test needs, in the axes and units of a convention.
struct Golden {
    std::string scene_hash, truth;
    Convention convention;
    Scene scene;                              ///< its numbers in the convention's axes and units of length
    std::vector<SupportPiece<double>> shape;  ///< whose convex hull is the body's, from its origin; likewise
    /// The first row is the start, of several bodies the first of each; w in rad/s, or degrees/s by the convention.
    TrajectoryFile motion;
    std::vector<double> energy;             ///< kinetic and potential, at each row, kg m^2/s^2 by the unit of length
    std::vector<Vector3<double>> momentum;  ///< angular, about the pivot or the centre of mass, world axes, kg m^2/s
    /// Of several bodies, at each time those of joints, then of loops, where the truth tells them: kg m/s^2, kg
    /// m^2/s^2.
    std::vector<Vector3<double>> forces, torques;
    double energy_scale = 1, momentum_scale = 1;  ///< what their errors are relative to; 1 where they are absolute
    double bound = 0;                             ///< of the numbers, rounding to binary64 included: rad, and relative
    std::vector<GoldenTolerance> tolerances;      ///< of all blocks, the attitude (rad) first
    std::optional<double> float64_floor;          ///< rad, the largest over the run
    double float32_floor = 0;                     ///< likewise
};

/// The scene with all its numbers in the convention's axes and unit of length; kg and s stay. What the body is made of
/// is left out: its mass, tensor and centre are there.
Scene scene_to(const Convention& convention, const Scene& scene);

/// Golden data of a truth that is available. Throws std::invalid_argument where it is not.
///
/// Tolerances are what the scene tolerates, the attitude's no less than the float32 floor; else what `check` allows by
/// default (see ErrorLimits) or ten times that floor, whichever is more: what no float engine can hold is not asked of
/// one. The floor is the conditioning's; where that is not known, what one rounding of the start to binary32 leads to;
/// and pi where neither is.
Golden golden(const Scene& scene, const Reference& truth, const Convention& convention);

/// What golden data is written as.
enum class GoldenFormat {
    csv,     ///< the motion as a trajectory file
    json,    ///< all of it
    c,       ///< a header of arrays that compiles as C99 and as C++, with a function that compares
    cpp,     ///< a header of constexpr arrays for C++17, likewise
    csharp,  ///< a static class, likewise
};

/// Numbers below 1e-300 in magnitude are written as 0. `floats`: arrays of float, and numbers as short as a float's. In
/// code every identifier begins with polhode_ (in C#, Polhode_) and the scene's name, its characters but letters and
/// digits turned to _. Throws std::invalid_argument where a number is beyond what it is to be written as.
std::string golden_text(const Golden& golden, GoldenFormat format, bool floats);

}  // namespace polhode
