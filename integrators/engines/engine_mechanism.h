// Several bodies and their joints as sent to engines: the second kind of request in README.md.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "integrators/engines/engine_request.h"

namespace polhode {

/// A body of a mechanism. Its origin is the centre of mass and its axes are the principal axes.
struct EngineBody {
    std::string name;             ///< name in the scene
    double mass = 0;              ///< kg
    Vector3<double> moments;      ///< kg m^2
    Quaternion<double> q_BP;      ///< its axes to those of the scene's body
    Quaternion<double> q;         ///< its axes to world axes at t = 0
    Vector3<double> w_W, p_W, v;  ///< at t = 0, after the impulses at that time; world axes, rad/s, m, m/s
};

/// Laws of a revolute or prismatic joint, in its coordinate x that is zero at t = 0.
struct EngineJointLaws {
    JointLimits limits;              ///< range of x, rad or m, and the coefficient of the impact at a limit
    double friction = 0;             ///< Coulomb friction, N m or N
    double armature = 0;             ///< added to the joint's entry of the mass matrix, kg m^2 or kg
    double stiffness = 0, rest = 0;  ///< generalized force -stiffness (x - rest)
    double damping = 0;              ///< generalized force -damping x'
};

/// A joint or the closure of a loop between two bodies, or a body and the world, in its configuration at t = 0, where
/// all joint coordinates are zero.
struct EngineJoint {
    std::string name;                     ///< name in the scene
    std::string type;                     ///< revolute, prismatic, spherical, universal, fixed or distance
    int parent = -1;                      ///< index of a body; -1: the world
    int child = 0;                        ///< index of a body; -1 (world) only for loops
    Vector3<double> anchor_W;             ///< child's point at t = 0, world axes, m
    Vector3<double> parent_point;         ///< this point in the parent's axes (`distance`: the parent's own point), m
    Vector3<double> child_point;          ///< this point in the child's axes, m
    std::vector<Vector3<double>> axes_W;  ///< unit, at t = 0: one for revolute and prismatic, two for universal
    std::vector<Vector3<double>> parent_axes;  ///< the same axes in the parent's axes
    std::vector<Vector3<double>> child_axes;   ///< the same axes in the child's axes
    Vector3<double> angular_velocity_W;        ///< angular velocity of the child relative to the parent at t = 0, rad/s
    std::vector<double> rates;                 ///< rates of the coordinates at t = 0, per axis, rad/s or m/s
    double length = 0;                         ///< length of `distance`, m
    EngineJointLaws laws{};                    ///< limits, friction, armature, spring and damper
};

/// A constant generalized force on a joint, along its axis on the child.
struct EngineMotor {
    int joint = 0;     ///< index of a joint
    double force = 0;  ///< N m on a revolute joint, N on a prismatic one
    Window window;     ///< when it acts
};

/// A constraint between the coordinates of two joints: second = ratio * first, because both are zero at t = 0.
struct EngineCoupling {
    int first = 0, second = 0;  ///< indices of joints
    double ratio = 1;           ///< coordinate of the second per coordinate of the first
};

/// Balls that touch each other and planes, instead of joints.
struct EngineBalls {
    std::vector<double> radii;             ///< radius by body, about its centre of mass, m
    double restitution = 0, friction = 0;  ///< coefficients for two balls
    std::vector<Plane> planes;             ///< unit normals
};

/// A mechanism in the engines' terms.
struct EngineMechanism {
    std::vector<EngineBody> bodies;      ///< in the scene's order
    std::vector<EngineJoint> joints;     ///< parents precede children
    std::vector<EngineJoint> loops;      ///< in the scene's order
    Vector3<double> gravity;             ///< m/s^2
    std::optional<EngineBalls> balls{};  ///< for scenes with contacts
    std::vector<EngineMotor> motors{};
    std::vector<EngineCoupling> couplings{};
    std::optional<EngineFormulas> formulas{};  ///< loads given by formulas
};

/// Converts the scene of a problem with several bodies. Throws std::invalid_argument with a short reason if this is not
/// possible: springs, dampers and armature of spherical and universal joints, prescribed motions, loads other than
/// constant gravity, motors, formulas and impulses at t = 0, and pairs of balls with different coefficients.
EngineMechanism engine_mechanism(const Problem& problem);

/// The laws of joints that the mechanism has, in the words of an engine's hello: limits, restitution, friction,
/// armature, springs, motors, couplings.
std::vector<std::string> joint_laws(const EngineMechanism& mechanism);

/// Why an engine does not support the mechanism: contacts of balls, formulas, or the first joint type, loop type or law
/// of joints that its hello lacks. Empty if none.
std::string joints_refusal(const EngineMechanism& mechanism, const EngineHello& hello);

/// The request as one line of JSON. `setting`: name of the engine's setting.
std::string mechanism_request(const EngineMechanism& mechanism, const std::string& setting, double duration,
                              const Settings& settings, long steps_per_sample);

/// Reads an answer to the request. An invalid answer gives a trajectory that is `failed`.
Trajectory read_mechanism_answer(std::string_view line, const Problem& problem, const EngineMechanism& mechanism,
                                 const Settings& settings, long steps_per_sample);

}  // namespace polhode
