// Requests to engines and their answers for one body: the protocol of README.md.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "integrators/engines/engine_formulas.h"
#include "integrators/engines/engine_shapes.h"
#include "integrators/method.h"

namespace polhode {

/// A scene in the terms that every engine supports: a free body whose origin is its centre of mass and whose axes are
/// its principal axes, with an optional pivot and planes.
struct EngineScene {
    Scene free;                                ///< without pivot, planes, shape and formulas; starts as the scene does
    Vector3<double> moments;                   ///< kg m^2
    Quaternion<double> q_BP;                   ///< its axes to those of the scene's body
    std::optional<Vector3<double>> pivot;      ///< fixed at the world's origin: from the centre of mass, in its axes, m
    std::vector<Plane> planes;                 ///< unit normals
    std::vector<EngineShape> shapes;           ///< shapes of the body if there are planes
    std::optional<EngineFormulas> formulas{};  ///< loads given by formulas
};

/// Converts the scene of a problem. A tensor that is already diagonal keeps its axes. Throws std::invalid_argument with
/// a short reason if this is not possible: user-defined torques, drag about axes that are not principal, cones and tori
/// on planes, planes with different coefficients or with torsional or rolling friction.
EngineScene engine_scene(const Problem& problem);

/// State of the body that the engine reports right after creating it. Empty members are not reported.
struct EngineReadback {
    std::optional<double> mass;              ///< kg
    std::optional<Vector3<double>> moments;  ///< kg m^2
    std::optional<Quaternion<double>> q;     ///< its axes to world axes
    std::optional<Vector3<double>> w;        ///< world axes, rad/s
    std::optional<Vector3<double>> p, v;     ///< centre of mass, m and m/s
};

/// The largest difference between the readback and the requested values: mass, moments, w, p and v relative to their
/// size (absolute if that is zero), attitude in rad.
double readback_difference(const EngineScene& scene, const EngineReadback& readback);

/// The planes of a scene with unit normals. Throws std::invalid_argument if engines do not support them: engines
/// combine the coefficients of two bodies by different rules, so all planes must have the same coefficients.
std::vector<Plane> engine_planes(const Scene& scene);

/// The request as one line of JSON. `setting`: name of the engine's setting.
std::string engine_request(const EngineScene& scene, const std::string& setting, const Settings& settings,
                           long steps_per_sample);

/// The line that an engine sends when it has started.
struct EngineHello {
    std::string version;                                          ///< version of the engine
    std::string missing;                                          ///< why the engine is not available; empty if it is
    std::vector<std::pair<std::string, std::string>> settings{};  ///< name and description of each setting
    std::vector<std::string> joints{};                            ///< joint types that it supports
    std::vector<std::string> loops{};                             ///< joint types that it supports for closing loops
    std::vector<std::string> shapes{};                            ///< shapes that it supports on planes; see README.md
    bool contacts = false;                                        ///< supports balls that touch each other and planes
    std::vector<std::string> laws{};                              ///< laws of joints that it supports; see README.md
    bool formulas = false;                                        ///< evaluates loads given by formulas
};

/// Parses the hello. Throws std::invalid_argument with the fault if the line is not a valid hello.
EngineHello read_hello(std::string_view line);

/// The answer of an engine.
struct EngineAnswer {
    Trajectory trajectory;    ///< in the scene's body axes
    EngineReadback readback;  ///< in the engine's axes
};

/// Reads an answer to a request for `problem`. An invalid answer gives a trajectory that is `failed`.
EngineAnswer read_answer(std::string_view line, const Problem& problem, const EngineScene& scene,
                         const Settings& settings, long steps_per_sample);

}  // namespace polhode
