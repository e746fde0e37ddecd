// A scene: data only. Which body, how it starts, what acts on it and for how long. No scene knows a method.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "body/algebra.h"
#include "body/body_motion.h"
#include "text/message.h"

namespace polhode {

/// The axes that a vector is given in, or the frame that a point is fixed in.
enum class Frame {
    body,   ///< fixed in the body, with the body's own origin
    world,  ///< inertial, with z up
};

/// When a load acts: for from <= t < until. Always, unless it is given others.
struct Window {
    double from = -std::numeric_limits<double>::infinity();  ///< s
    double until = std::numeric_limits<double>::infinity();  ///< s
};

/// Uniform gravity, whose force acts at the centre of mass.
struct Gravity {
    Vector3<double> acceleration_W;  ///< m/s^2
    Window window;                   ///< when it acts
};

/// A torque that is constant in the body's or in the world's axes.
struct Torque {
    Vector3<double> vector;     ///< N m
    Frame frame = Frame::body;  ///< the axes of `vector`
    Window window;              ///< when it acts
    std::string body = "";      ///< the name of the body that it acts on, in a scene of several; else empty
};

/// A force that is constant in the body's or in the world's axes and acts at a point fixed in the body or in the world.
struct Force {
    Vector3<double> vector;           ///< N
    Frame frame = Frame::world;       ///< the axes of `vector`
    Vector3<double> point;            ///< m, from the origin of `point_frame`
    Frame point_frame = Frame::body;  ///< what the point is fixed in
    Window window;                    ///< when it acts
    std::string body = "";            ///< the name of the body that it acts on, in a scene of several; else empty
};

/// An impulse at one time. A sample at that very time shows the motion after it.
struct Impulse {
    Vector3<double> vector;           ///< N s
    Frame frame = Frame::world;       ///< the axes of `vector`
    Vector3<double> point;            ///< m, from the origin of `point_frame`
    Frame point_frame = Frame::body;  ///< what the point is fixed in
    double at = 0;                    ///< s
    std::string body = "";            ///< the name of the body that it acts on, in a scene of several; else empty
};

/// Linear drag: the torque -c_i omega_i along each body axis and the force -c v at the centre of mass.
struct Drag {
    Vector3<double> rotational;  ///< c_1, c_2, c_3 along the body axes, N m s
    double translational = 0;    ///< c, N s/m
    Window window;               ///< when it acts
    std::string body = "";       ///< the name of the body that it acts on, in a scene of several; else empty
};

/// A torsional spring. With r = q_rest* q, of scalar part r_w and vector part r_v, and the angle between the attitude
/// and the one at rest: its potential is 2 k |r_v|^2 = k (1 - cos angle), its torque in body axes -2 k r_w r_v.
struct Spring {
    double stiffness = 0;                 ///< k, N m
    Quaternion<double> rest_orientation;  ///< q_rest, body to world; it stands for its normalised value
    Window window;                        ///< when it acts
    std::string body = "";                ///< the name of the body that it acts on, in a scene of several; else empty
};

/// What a torque of the user's own is given: q is not normalised; position and velocity are zero where the scene's
/// translation is not integrated.
using LoadState = Sample;

/// A torque of the user's own (N m, body axes), smooth in its arguments. It has no file form, no derivative and no
/// truth: methods that need a derivative answer `unsupported`.
struct UserTorque {
    std::string name;                                           ///< for messages
    std::function<Vector3<double>(const LoadState&)> torque_B;  ///< N m
    Window window;                                              ///< when it acts
};

/// A generalized force on a joint of one degree of freedom: along its axis on the child, the opposite on the parent.
struct Motor {
    std::string joint;  ///< the name of a revolute or a prismatic joint
    double force = 0;   ///< N m on a revolute joint, N on a prismatic one
    Window window;      ///< when it acts
};

/// A spring between two points, each fixed in a body or in the world, with the potential k (d - d0)^2 / 2 of their
/// distance d: it pulls each towards the other with k (d - d0).
struct PointSpring {
    std::string first = "world";   ///< a body's name, or "world"
    Vector3<double> first_point;   ///< m, from that body's origin, its axes
    std::string second = "world";  ///< a body's name, or "world"
    Vector3<double> second_point;  ///< m, from that body's origin, its axes
    double stiffness = 0;          ///< k, N/m
    double rest_length = 0;        ///< d0, m
    Window window;                 ///< when it acts
};

/// Whatever acts on a body, or between bodies.
using Load = std::variant<Gravity, Torque, Force, Impulse, Drag, Spring, UserTorque, Motor, PointSpring>;

/// What a body is made of: shapes, parts, points, a mesh or a robot description (scene/body_source.h).
struct BodySource;

/// A rigid body by its mass properties.
struct Body {
    double mass = 1;  ///< kg
    /// The inertia tensor about the centre of mass, kg m^2, with -int xy dm off its diagonal.
    Matrix3<double> inertia_B = diagonal(Vector3<double>(1, 1, 1));
    Vector3<double> center_of_mass;  ///< m, from the body's origin, body axes
    /// What it is made of, where that was given in place of the numbers: they are then rounded from it, and whoever
    /// alters them lets go of it. See scene/body_source.h.
    std::shared_ptr<const BodySource> source = nullptr;
};

/// An immovable plane: the body stays where normal . x > offset. An impact reverses the normal speed of the point that
/// touches `restitution`-fold; `friction` is Coulomb's coefficient.
struct Plane {
    Vector3<double> normal_W{0, 0, 1};  ///< of any length but zero
    double offset = 0;                  ///< m, where the normal is a unit vector
    double restitution = 1;             ///< 0..1
    double friction = 0;                ///< >= 0
};

/// How the motion starts, at t = 0.
struct Initial {
    Quaternion<double> orientation;              ///< body to world; kept as given, it stands for its normalised value
    Vector3<double> angular_velocity;            ///< rad/s
    Frame angular_velocity_frame = Frame::body;  ///< the axes of `angular_velocity`
    Vector3<double> position_W;                  ///< of the centre of mass, m
    Vector3<double> velocity_W;                  ///< of the centre of mass, m/s
};

/// A body of a mechanism.
struct NamedBody {
    std::string name;  ///< not "world", and no other body's
    Body body;         ///< its mass properties
    Initial initial;   ///< how it starts: of a free base, which no joint carries
    /// Of an imported robot, its place in the robot's file, for messages: "arm.urdf: line 5". No file form.
    std::string place = "";
};

/// How a joint lets its child move against its parent.
enum class JointType {
    revolute,   ///< turn about one axis
    prismatic,  ///< slide along one axis
    spherical,  ///< turn about a point
    universal,  ///< turn about two axes, one after the other
    fixed,      ///< not at all
};

/// A joint of a tree. With q0 = parent_orientation: q_child = q_parent q0 J, where J = exp(axis x) of a revolute joint,
/// exp(axes[0] x) exp(axes[1] y) of a universal one, a quaternion of its own of a spherical one, 1 otherwise. The
/// child's `child_point` lies at the parent's `parent_point`, of a prismatic joint moved from there along the axis.
struct Joint {
    std::string name;                       ///< no other joint's or loop's
    JointType type = JointType::revolute;   ///< how the child may move
    std::string parent = "world";           ///< a body's name, or "world"
    std::string child;                      ///< a body's name; each is the child of one joint at most
    Vector3<double> parent_point;           ///< m, from the parent's origin, its axes
    Vector3<double> child_point;            ///< m, from the child's origin, its axes
    Quaternion<double> parent_orientation;  ///< q0, child axes at coordinate zero to parent axes; stands normalised
    /// Revolute, prismatic: the first, in the child's axes. Universal: the first in the middle frame (and in the
    /// child's axes where the second angle is zero), the second in the child's. Of any length but zero.
    std::array<Vector3<double>, 2> axes;
    std::array<double, 2> coordinate{};   ///< x at t = 0, rad or m; the second of a universal joint only
    std::array<double, 2> rate{};         ///< its rate at t = 0, rad/s or m/s
    Quaternion<double> orientation;       ///< J at t = 0 of a spherical joint; stands normalised
    Vector3<double> angular_velocity;     ///< at t = 0 of a spherical joint: child against parent, child axes, rad/s
    bool dependent = false;               ///< its start is moved until the loops close; only of one coordinate
    std::array<double, 2> stiffness{};    ///< k: generalized force -k (x - rest), N m/rad or N/m
    std::array<double, 2> rest{};         ///< rad or m; angles count turns
    Quaternion<double> rest_orientation;  ///< spherical: torque on the child -2 k r_w r_v, r = rest* J, child axes
    std::array<double, 2> damping{};      ///< c: generalized force -c x', N m s or N s/m; spherical: -c w, child axes
    std::string place = "";               ///< as NamedBody::place
};

/// What closes a chain.
enum class LoopType {
    spherical,  ///< two points coincide
    revolute,   ///< two points coincide, and two axes
    distance,   ///< two points are at a fixed distance
};

/// A constraint between two bodies that closes a loop of joints.
struct Loop {
    std::string name;                     ///< no other joint's or loop's
    LoopType type = LoopType::spherical;  ///< what it holds
    std::string first = "world";          ///< a body's name, or "world"
    Vector3<double> first_point;          ///< m, from that body's origin, its axes
    std::string second = "world";         ///< a body's name, or "world"
    Vector3<double> second_point;         ///< m, from that body's origin, its axes
    Vector3<double> first_axis;           ///< revolute: in the first body's axes, of any length but zero
    Vector3<double> second_axis;          ///< revolute: in the second body's axes, of any length but zero
    double length = 0;                    ///< distance: m, > 0
};

/// A scene: which body moves, how it starts, what acts on it and for how long. validate() says what makes one valid.
struct Scene {
    std::string directory;                 ///< that the files it names are relative to; empty for the working directory
    std::string name;                      ///< for messages and tables
    std::string about;                     ///< what it shows, a sentence
    std::string source;                    ///< where its parameters come from
    double duration = 0;                   ///< of the motion, s, > 0
    Body body;                             ///< what moves
    Initial initial;                       ///< how it starts
    std::optional<Vector3<double>> pivot;  ///< body point (from the body's origin) held at the world's origin, m
    /// Several bodies, in place of `body`, `initial` and `pivot`; empty in a scene of one body.
    std::vector<NamedBody> bodies;
    std::vector<Joint> joints;  ///< of several bodies: trees, each body the child of one joint at most
    std::vector<Loop> loops;    ///< what closes chains of joints
    std::vector<Load> loads;    ///< what acts on the body or the bodies
    std::vector<Plane> planes;  ///< beside a body that has a shape, without a pivot
    /// The errors that `check` lets pass, by the names in tolerated_blocks: attitude (rad), angular_velocity (rad/s),
    /// position (m), velocity (m/s), energy and momentum (relative to the largest of the run); of several bodies also
    /// joint_gap (m) and joint_turn (rad).
    std::map<std::string, double> tolerated;
    /// Constructs of an imported robot's file that change its motion and are not modelled, a phrase each. No file form.
    std::vector<std::string> omitted;
    /// Values of an imported robot that its file does not state, or that were repaired, a phrase each. No file form.
    std::vector<std::string> assumed;
};

/// Whether a scene is one of several bodies, with joints: `bodies` in place of `body`.
inline bool is_mechanism(const Scene& scene) { return !scene.bodies.empty(); }

/// What a scene can tolerate errors of.
inline constexpr std::array<std::string_view, 8> tolerated_blocks{
    "attitude", "angular_velocity", "position", "velocity", "energy", "momentum", "joint_gap", "joint_turn"};
/// Of these the ones that a scene of several bodies alone has.
constexpr bool is_of_joints(std::string_view block) { return block == "joint_gap" || block == "joint_turn"; }

/// The error of a block that the scene tolerates, if it says so.
std::optional<double> tolerated_error(const Scene& scene, std::string_view block);

/// Throws InputError where the scene breaks a rule of the file format: a number that is not finite, a mass or a
/// principal moment that is not positive (of several bodies: negative, or moments without mass), triangle inequality or
/// symmetry broken by more than 1e-12 of the largest moment, | |q| - 1 | > 1e-6, an empty window, a position beside a
/// pivot, a plane beside a body without a shape or above where it starts; of several bodies, names that are missing or
/// there twice, joints that form no trees. Whether loops close is not looked at. `file` is named in the message.
void validate(const Scene& scene, const std::string& file);

/// When a load acts: its window, or all time for an impulse, which has none.
Window window_of(const Load& load);

/// The name of the body that a load acts on, of several: empty where it acts on all, between two or on the only one.
std::string load_body(const Load& load);

}  // namespace polhode
