// Several bodies and their joints as engines are asked for them: the second kind of request of README.md.
#pragma once

#include <string>
#include <vector>

#include "integrators/engines/engine_request.h"

namespace polhode {

/// A body of a mechanism: its origin is its centre of mass, its axes are its principal ones.
struct EngineBody {
    std::string name;             ///< as the scene has it
    double mass = 0;              ///< kg
    Vector3<double> moments;      ///< kg m^2
    Quaternion<double> q_BP;      ///< its axes to those of the scene's body
    Quaternion<double> q;         ///< its axes to the world's at t = 0
    Vector3<double> w_W, p_W, v;  ///< at t = 0, after the impulses there; world axes, rad/s, m, m/s
};

/// What ties two bodies, or a body to the world, as it stands at t = 0: there all joints' coordinates are zero. A
/// loop's closure is one too.
struct EngineJoint {
    std::string name;                          ///< as the scene has it
    std::string type;                          ///< revolute, prismatic, spherical, universal, fixed or distance
    int parent = -1;                           ///< index of a body; -1: the world
    int child = 0;                             ///< index of a body; -1 only of a loop
    Vector3<double> anchor_W;                  ///< the child's point at t = 0, m
    Vector3<double> parent_point;              ///< where that is in the parent, its axes (of `distance`: its own point)
    Vector3<double> child_point;               ///< in the child, its axes, m
    std::vector<Vector3<double>> axes_W;       ///< unit, at t = 0: one of revolute and prismatic, two of universal
    std::vector<Vector3<double>> parent_axes;  ///< the same in the parent's axes
    std::vector<Vector3<double>> child_axes;   ///< the same in the child's axes
    Vector3<double> turning_W;                 ///< w of the child against the parent at t = 0, world axes, rad/s
    std::vector<double> rates;                 ///< of the coordinates at t = 0, rad/s or m/s, by axis
    double length = 0;                         ///< of `distance`, m
};

/// A mechanism in these terms.
struct EngineMechanism {
    std::vector<EngineBody> bodies;   ///< in the scene's order
    std::vector<EngineJoint> joints;  ///< parents before children
    std::vector<EngineJoint> loops;   ///< in the scene's order
    Vector3<double> gravity;          ///< m/s^2
};

/// The scene of a problem of several bodies in these terms. Throws std::invalid_argument, with the reason in a few
/// words, where there are none: springs, dampers and motors, loads other than lasting gravity and impulses at t = 0.
EngineMechanism engine_mechanism(const Problem& problem);

/// The first type of joint, then of loop, that an engine does not take by its hello, as a reason: empty where it takes
/// all.
std::string joints_not_taken(const EngineMechanism& mechanism, const EngineHello& hello);

/// The request, one line of JSON, by the engine's setting.
std::string mechanism_request(const EngineMechanism& mechanism, const std::string& setting, double duration,
                              const Settings& settings, long steps_per_sample);

/// Reads an answer to it. What does not belong there is told by a trajectory that is `failed`.
Trajectory read_mechanism_answer(std::string_view line, const Problem& problem, const EngineMechanism& mechanism,
                                 const Settings& settings, long steps_per_sample);

}  // namespace polhode
