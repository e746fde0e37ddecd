// What an engine is asked, and what it answers: the protocol of README.md.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "integrators/method.h"

namespace polhode {

/// A scene in the terms that every engine knows: a free body whose origin is its centre of mass and whose axes are its
/// principal ones, beside what holds it and what it may hit.
struct EngineScene {
    Scene free;                            ///< without pivot, planes and shape; starts as the scene does
    Vector3<double> moments;               ///< kg m^2
    Quaternion<double> q_BP;               ///< its axes to those of the scene's body
    std::optional<Vector3<double>> pivot;  ///< held at the world's origin: from the centre of mass, its axes, m
    std::vector<Plane> planes;             ///< unit normals
    std::vector<Vector3<double>> hull;     ///< corners of the body's convex hull, beside planes; its axes, m
    std::optional<double> ball;            ///< or the radius (m) of a ball about the centre of mass
};

/// The scene of a problem in these terms. A tensor that is diagonal as it is written keeps its axes. Throws
/// std::invalid_argument, with the reason in a few words, where there are none: a torque of the user's own, drag about
/// axes that are not principal, a hull that is round and no ball.
EngineScene engine_scene(const Problem& problem);

/// What the engine says of the body right after it was made. Empty where it does not tell.
struct EngineReadback {
    std::optional<double> mass;              ///< kg
    std::optional<Vector3<double>> moments;  ///< kg m^2
    std::optional<Quaternion<double>> q;     ///< its axes to the world's
    std::optional<Vector3<double>> w;        ///< world axes, rad/s
    std::optional<Vector3<double>> p, v;     ///< of the centre of mass, m and m/s
};

/// The largest difference of what was read back from what was asked for: of mass, moments, w, p and v relative to
/// the size of each (absolute where that is zero), of the attitude in rad.
double readback_difference(const EngineScene& scene, const EngineReadback& readback);

/// The request, one line of JSON, by the engine's setting.
std::string engine_request(const EngineScene& scene, const std::string& setting, const Settings& settings,
                           long steps_per_sample);

/// What an engine says of itself when it has started.
struct EngineHello {
    std::string version;                                          ///< of the engine
    std::string missing;                                          ///< why it cannot be had; empty where it can
    std::vector<std::pair<std::string, std::string>> settings{};  ///< each by its name and what it is
    std::vector<std::string> joints{};                            ///< the types of joints that it takes, by their words
    std::vector<std::string> loops{};                             ///< likewise those that it closes loops by
};

/// Throws std::invalid_argument, with the fault, where the line is none.
EngineHello read_hello(std::string_view line);

/// An engine's answer.
struct EngineAnswer {
    Trajectory trajectory;    ///< in the scene's own body axes
    EngineReadback readback;  ///< in the engine's axes
};

/// Reads an answer to a request for `problem`. What does not belong there is told by a trajectory that is `failed`.
EngineAnswer read_answer(std::string_view line, const Problem& problem, const EngineScene& scene,
                         const Settings& settings, long steps_per_sample);

}  // namespace polhode
