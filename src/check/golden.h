// A scene's truth as golden data for an engine's own unit tests.
#pragma once

#include <optional>
#include <string>

#include "check/convention.h"
#include "integrators/truth/reference.h"
#include "scene/scene.h"

namespace polhode {

/// All that an engine's test needs, in the axes and units of a convention.
struct Golden {
    std::string scene, about, scene_hash, truth, convention;
    bool scalar_last = false, degrees = false, body_rates = false;
    double length_unit = 1;  ///< m in the unit of all lengths
    double mass = 0;
    Vector3<double> center_of_mass;  ///< from the body's origin, body axes
    Matrix3<double> inertia;         ///< about the centre of mass, body axes
    std::optional<Vector3<double>> pivot;
    TrajectoryFile motion;       ///< the first row is the start; w in rad/s, or degrees/s by the convention
    double bound = 0;            ///< of the numbers, rounding to binary64 included: rad, and relative
    double tolerance = 0;        ///< rad: what an attitude may be off
    std::string tolerance_from;  ///< why that
    std::optional<double> float32_floor, float64_floor;  ///< rad, the largest over the run
    std::string loads;                                   ///< JSON of the scene's loads, always in the scene's own axes
};

/// Golden data of a truth that is available. Throws std::invalid_argument where it is not.
Golden golden(const Scene& scene, const Reference& truth, const Convention& convention);

std::string golden_csv(const Golden& golden);
std::string golden_json(const Golden& golden);
/// A header of static const arrays that compiles as C99 and C++. Every identifier and the include guard begin with
/// polhode_ and the scene's name, its characters but letters and digits turned to _.
std::string golden_c(const Golden& golden);

}  // namespace polhode
