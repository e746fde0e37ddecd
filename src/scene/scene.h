// A scene as data: the body or bodies, their initial state, the loads and the duration. Independent of methods.
//
// Main types: Scene, Body (mass properties), Initial, the loads of the variant Load, Joint and Loop for several
// bodies, Plane for impacts. All quantities are in SI units. Scene files are read by scene_file.h and checked by
// validate(). Numbers are kept as written; derived quantities are computed from them exactly (body_source.h).
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

/// The axes of a vector, or the frame in which a point is fixed.
enum class Frame {
    body,   ///< fixed in the body, with its own origin
    world,  ///< inertial, with z up
};

/// The time interval in which a load acts: from <= t < until. Default: always.
struct Window {
    double from = -std::numeric_limits<double>::infinity();  ///< s
    double until = std::numeric_limits<double>::infinity();  ///< s
};

/// Uniform gravity. Its force acts at the centre of mass.
struct Gravity {
    Vector3<double> acceleration_W;  ///< m/s^2
    Window window;                   ///< when it acts
};

/// A torque that is constant in body or world axes.
struct Torque {
    Vector3<double> vector;     ///< N m
    Frame frame = Frame::body;  ///< the axes of `vector`
    Window window;              ///< when it acts
    std::string body = "";      ///< name of the body that it acts on; empty in a scene of one body
};

/// A force that is constant in body or world axes and acts at a point fixed in the body or in the world.
struct Force {
    Vector3<double> vector;           ///< N
    Frame frame = Frame::world;       ///< the axes of `vector`
    Vector3<double> point;            ///< m, from the origin of `point_frame`
    Frame point_frame = Frame::body;  ///< the frame in which the point is fixed
    Window window;                    ///< when it acts
    std::string body = "";            ///< name of the body that it acts on; empty in a scene of one body
};

/// An impulse at one time. A sample at that time shows the motion after the impulse.
struct Impulse {
    Vector3<double> vector;           ///< N s
    Frame frame = Frame::world;       ///< the axes of `vector`
    Vector3<double> point;            ///< m, from the origin of `point_frame`
    Frame point_frame = Frame::body;  ///< the frame in which the point is fixed
    double at = 0;                    ///< s
    std::string body = "";            ///< name of the body that it acts on; empty in a scene of one body
};

/// Linear drag: the torque -c_i omega_i along each body axis and the force -c v at the centre of mass.
struct Drag {
    Vector3<double> rotational;  ///< c_1, c_2, c_3 along the body axes, N m s
    double translational = 0;    ///< c, N s/m
    Window window;               ///< when it acts
    std::string body = "";       ///< name of the body that it acts on; empty in a scene of one body
};

/// A torsional spring. With r = q_rest* q, scalar part r_w and vector part r_v, its potential is
/// 2 k |r_v|^2 = k (1 - cos angle), where angle is that between the attitude and the rest orientation. Its torque in
/// body axes is -2 k r_w r_v.
struct Spring {
    double stiffness = 0;                 ///< k, N m
    Quaternion<double> rest_orientation;  ///< q_rest, body to world; normalised when used
    Window window;                        ///< when it acts
    std::string body = "";                ///< name of the body that it acts on; empty in a scene of one body
};

/// The argument of a user-defined torque. q is not normalised. Position and velocity are zero if the scene's
/// translation is not integrated.
using LoadState = Sample;

/// A user-defined torque (N m, body axes), a smooth function of its argument. It has no file form, no derivative and
/// no reference solution. Methods that need a derivative return `unsupported`.
struct UserTorque {
    std::string name;                                           ///< for messages
    std::function<Vector3<double>(const LoadState&)> torque_B;  ///< N m
    Window window;                                              ///< when it acts
};

/// A generalized force on a joint of one degree of freedom: along its axis on the child, with the opposite reaction
/// on the parent.
struct Motor {
    std::string joint;  ///< the name of a revolute or a prismatic joint
    double force = 0;   ///< N m on a revolute joint, N on a prismatic one
    Window window;      ///< when it acts
};

/// A spring between two points, each fixed in a body or in the world. Its potential is k (d - d0)^2 / 2 with the
/// distance d; it pulls the points together with the force k (d - d0).
struct PointSpring {
    std::string first = "world";   ///< a body's name, or "world"
    Vector3<double> first_point;   ///< m, from that body's origin, its axes
    std::string second = "world";  ///< a body's name, or "world"
    Vector3<double> second_point;  ///< m, from that body's origin, its axes
    double stiffness = 0;          ///< k, N/m
    double rest_length = 0;        ///< d0, m
    Window window;                 ///< when it acts
};

/// What the value of a FormulaLoad is.
enum class FormulaKind {
    torque,     ///< a torque, N m, a vector
    force,      ///< a force, N, a vector
    potential,  ///< a potential, J, a scalar; force and torque are its exact derivatives
    motor,      ///< a generalized force on a joint of one degree of freedom, N m or N, a scalar
};

/// A load given by a formula of time and state.
struct FormulaLoad {
    FormulaKind kind = FormulaKind::torque;  ///< what the value of the formula is
    std::string formula;                     ///< as written; three scalars are written "[x, y, z]"
    Frame frame = Frame::body;               ///< torque, force: the axes of the value
    Vector3<double> point;                   ///< force: where it acts, m, from the origin of `point_frame`
    Frame point_frame = Frame::body;         ///< force: the frame in which the point is fixed
    bool has_point = false;                  ///< force: false: it acts at the centre of mass
    std::string joint = "";                  ///< motor: the name of a revolute or a prismatic joint
    Window window;                           ///< when it acts
    std::string body = "";                   ///< name of the body that it acts on; empty in a scene of one body
};

/// Any load on a body or between bodies.
using Load = std::variant<Gravity, Torque, Force, Impulse, Drag, Spring, UserTorque, Motor, PointSpring, FormulaLoad>;

/// A number that formulas use by its name.
struct FormulaParameter {
    std::string name;  ///< an identifier
    double value = 0;  ///< SI units
};

/// How a table is evaluated between its points. Outside its range it has the value of the nearest end.
enum class TableInterpolation {
    linear,  ///< piecewise linear
    cubic,   ///< piecewise cubic, continuously differentiable, monotone where the points are
};

/// A function of one variable, given by points, that formulas use as table(name, x).
struct FormulaTable {
    std::string name;                                         ///< an identifier
    std::vector<double> x;                                    ///< strictly increasing
    std::vector<double> y;                                    ///< the values at x
    TableInterpolation between = TableInterpolation::linear;  ///< how y is evaluated between points
    std::string file = "";  ///< the file that x and y were read from, relative to the scene's; empty: none
};

/// A named sub-expression of formulas.
struct FormulaDefinition {
    std::string name;     ///< an identifier
    std::string formula;  ///< may use the definitions before it
};

/// How the body is described: shapes, parts, points, a mesh or a robot description (scene/body_source.h).
struct BodySource;

/// The mass properties of a rigid body.
struct Body {
    double mass = 1;  ///< kg
    /// The inertia tensor about the centre of mass, kg m^2. Off-diagonal entries are -int xy dm.
    Matrix3<double> inertia_B = diagonal(Vector3<double>(1, 1, 1));
    Vector3<double> center_of_mass;  ///< m, from the body's origin, body axes
    /// The description from which the numbers were rounded, if they were not given directly. Reset it when you change
    /// the numbers. See scene/body_source.h.
    std::shared_ptr<const BodySource> source = nullptr;
};

/// How the coefficient of restitution e defines the end of an impact. The laws agree without friction, and for
/// spheres.
enum class RestitutionLaw {
    stronge,  ///< the normal work of restitution is -e^2 times that of compression
    poisson,  ///< the normal impulse of restitution is e times that of compression
    newton,   ///< the normal velocity after the impact is -e times that before; can create energy
};

/// An immovable plane: the body stays where normal . x > offset. `friction` is Coulomb's coefficient, static and
/// kinetic, with a circular cone.
struct Plane {
    Vector3<double> normal_W{0, 0, 1};  ///< of any nonzero length
    double offset = 0;                  ///< m, for a normal of unit length
    double restitution = 1;             ///< 0..1
    double friction = 0;                ///< >= 0
    double torsional_friction = 0;      ///< m; limit of the torque about the normal, divided by the normal force
    double rolling_friction = 0;        ///< m; limit of the torque against rolling, divided by the normal force
    RestitutionLaw restitution_law = RestitutionLaw::stronge;  ///< the law that `restitution` belongs to
    std::string name = "";  ///< for messages and tables; empty: "plane 1" for the first, and so on
};

/// Contact of two spheres of a scene of several bodies without joints, or of all pairs that no other entry names.
struct SphereContact {
    std::string first;       ///< name of a body; empty if `all`
    std::string second;      ///< name of another body; empty if `all`
    bool all = false;        ///< every pair that no other entry names
    double restitution = 1;  ///< 0..1
    double friction = 0;     ///< Coulomb's coefficient, >= 0
};

/// The initial state, at t = 0.
struct Initial {
    Quaternion<double> orientation;              ///< body to world; kept as given, normalised when used
    Vector3<double> angular_velocity;            ///< rad/s
    Frame angular_velocity_frame = Frame::body;  ///< the axes of `angular_velocity`
    Vector3<double> position_W;                  ///< centre of mass, m
    Vector3<double> velocity_W;                  ///< centre of mass, m/s
};

/// A body of a mechanism.
struct NamedBody {
    std::string name;  ///< unique among the bodies, and not "world"
    Body body;         ///< its mass properties
    Initial initial;   ///< initial state of a free base, a body that is not the child of a joint
    /// For an imported robot: place in the robot's file, for messages ("arm.urdf: line 5"). No file form.
    std::string place = "";
};

/// How the child of a joint can move relative to its parent.
enum class JointType {
    revolute,   ///< rotation about one axis
    prismatic,  ///< translation along one axis
    spherical,  ///< rotation about a point
    universal,  ///< rotation about two successive axes
    fixed,      ///< no motion
};

/// The range of a joint's coordinate.
struct JointLimits {
    double lower = -std::numeric_limits<double>::infinity();  ///< rad or m
    double upper = std::numeric_limits<double>::infinity();   ///< rad or m
    double restitution = 0;                                   ///< coefficient of the impact at a limit, 0..1

    /// Whether the coordinate has a limit.
    bool any() const {
        return lower > -std::numeric_limits<double>::infinity() || upper < std::numeric_limits<double>::infinity();
    }
};

/// A joint of a tree. With q0 = parent_orientation: q_child = q_parent q0 J, where J = exp(axis x) for a revolute
/// joint, exp(axes[0] x) exp(axes[1] y) for a universal joint, a free quaternion for a spherical joint, and 1
/// otherwise. The child's `child_point` coincides with the parent's `parent_point`; in a prismatic joint it is
/// displaced from there along the axis.
struct Joint {
    std::string name;                       ///< unique among joints and loops
    JointType type = JointType::revolute;   ///< how the child may move
    std::string parent = "world";           ///< a body's name, or "world"
    std::string child;                      ///< a body's name; each body is the child of at most one joint
    Vector3<double> parent_point;           ///< m, from the parent's origin, its axes
    Vector3<double> child_point;            ///< m, from the child's origin, its axes
    Quaternion<double> parent_orientation;  ///< q0: child axes at coordinate zero to parent axes; normalised
    /// Revolute, prismatic: axes[0], in the child's axes. Universal: axes[0] in the middle frame (which has the
    /// child's axes when the second angle is zero), axes[1] in the child's axes. Any nonzero length.
    std::array<Vector3<double>, 2> axes;
    std::array<double, 2> coordinate{};   ///< x at t = 0, rad or m; [1] only for a universal joint
    std::array<double, 2> rate{};         ///< rate at t = 0, rad/s or m/s
    Quaternion<double> orientation;       ///< spherical: J at t = 0; normalised when used
    Vector3<double> angular_velocity;     ///< spherical, at t = 0: child relative to parent, child axes, rad/s
    bool dependent = false;               ///< adjust the initial state until the loops close; only if one coordinate
    std::array<double, 2> stiffness{};    ///< k: generalized force -k (x - rest), N m/rad or N/m
    std::array<double, 2> rest{};         ///< rad or m; angles count full revolutions
    Quaternion<double> rest_orientation;  ///< spherical: torque on the child -2 k r_w r_v, r = rest* J, child axes
    std::array<double, 2> damping{};      ///< c: generalized force -c x', N m s or N s/m; spherical: -c w, child axes
    std::string place = "";               ///< see NamedBody::place
    /// Reflected inertia of a rotor: added to the coordinate's diagonal entry of the mass matrix, kg m^2 or kg;
    /// spherical: [0], about each axis.
    std::array<double, 2> armature{};
    double friction = 0;  ///< Coulomb friction, static and kinetic, N m or N; revolute and prismatic joints
    JointLimits limits;   ///< range of the coordinate; revolute and prismatic joints
    /// Prescribed motion: a formula of t for the coordinate, rad or m; revolute and prismatic joints. Empty: none.
    std::string motion = "";
};

/// A constraint between the coordinates of two joints, each revolute or prismatic: second = ratio * first + offset.
/// Gears, mimic joints, rack and pinion.
struct Coupling {
    std::string first;   ///< name of a joint
    std::string second;  ///< name of another joint
    double ratio = 1;    ///< coordinate of the second per coordinate of the first
    double offset = 0;   ///< rad or m
};

/// The kind of a loop constraint.
enum class LoopType {
    spherical,  ///< two points coincide
    revolute,   ///< two points coincide, and two axes
    distance,   ///< two points are at a fixed distance
};

/// A constraint between two bodies that closes a loop of joints.
struct Loop {
    std::string name;                     ///< unique among joints and loops
    LoopType type = LoopType::spherical;  ///< the kind of constraint
    std::string first = "world";          ///< a body's name, or "world"
    Vector3<double> first_point;          ///< m, from that body's origin, its axes
    std::string second = "world";         ///< a body's name, or "world"
    Vector3<double> second_point;         ///< m, from that body's origin, its axes
    Vector3<double> first_axis;           ///< revolute: in the first body's axes, of any nonzero length
    Vector3<double> second_axis;          ///< revolute: in the second body's axes, of any nonzero length
    double length = 0;                    ///< distance: m, > 0
};

/// A scene: the body or bodies, their initial state, the loads and the duration. validate() checks its rules.
struct Scene {
    std::string directory;                 ///< base of relative file names; empty: the working directory
    std::string name;                      ///< name in messages and tables
    std::string about;                     ///< one sentence on what it shows
    std::string source;                    ///< where its parameters come from
    double duration = 0;                   ///< duration of the motion, s, > 0
    Body body;                             ///< the body of a scene of one body
    Initial initial;                       ///< its initial state
    std::optional<Vector3<double>> pivot;  ///< body point held at the world's origin, from the body's origin, m
    /// Several bodies, in place of `body`, `initial` and `pivot`; empty in a scene of one body.
    std::vector<NamedBody> bodies;
    std::vector<Joint> joints;                 ///< joints of several bodies; they form trees
    std::vector<Loop> loops;                   ///< constraints that close chains of joints
    std::vector<Coupling> couplings;           ///< constraints between joint coordinates
    std::vector<Load> loads;                   ///< everything that acts on the body or bodies
    std::vector<Plane> planes;                 ///< require bodies with a shape and no pivot
    std::vector<SphereContact> contacts;       ///< contacts between free spheres; other pairs pass through each other
    std::vector<FormulaParameter> parameters;  ///< numbers that formulas use
    std::vector<FormulaTable> tables;          ///< functions that formulas use
    std::vector<FormulaDefinition> let;        ///< sub-expressions that formulas use
    /// Error limits of `check`, by the names in tolerated_blocks: attitude (rad), angular_velocity (rad/s), position
    /// (m), velocity (m/s), energy and momentum (relative to the run's largest value); for several bodies also
    /// joint_gap (m) and joint_turn (rad).
    std::map<std::string, double> tolerated;
    /// Constructs of an imported robot file that change the motion but are not modelled, one phrase each. No file
    /// form.
    std::vector<std::string> omitted;
    /// Values of an imported robot that its file does not state, or that were repaired, one phrase each. No file
    /// form.
    std::vector<std::string> assumed;
};

/// Whether a scene has several bodies with joints: `bodies` in place of `body`.
inline bool is_mechanism(const Scene& scene) { return !scene.bodies.empty(); }

/// A body of a scene, for code that treats one body and several alike. It refers to the scene.
struct SceneBody {
    std::string_view name;   ///< empty in a scene of one body
    const Body& body;        ///< its mass properties
    const Initial& initial;  ///< its initial state; joints determine that of a jointed body
};
/// The number of bodies of a scene, 1 or more.
inline std::size_t body_count(const Scene& scene) { return scene.bodies.empty() ? 1 : scene.bodies.size(); }
/// A body of a scene by its index below body_count().
inline SceneBody scene_body(const Scene& scene, std::size_t index) {
    if (scene.bodies.empty()) return {{}, scene.body, scene.initial};
    return {scene.bodies[index].name, scene.bodies[index].body, scene.bodies[index].initial};
}

/// The quantities for which a scene can set error limits.
inline constexpr std::array<std::string_view, 8> tolerated_blocks{
    "attitude", "angular_velocity", "position", "velocity", "energy", "momentum", "joint_gap", "joint_turn"};
/// Whether the quantity exists only for several bodies.
constexpr bool is_of_joints(std::string_view block) { return block == "joint_gap" || block == "joint_turn"; }
/// Whether the quantity exists for the scene.
inline bool has_quantity(const Scene& scene, std::string_view block) {
    return is_mechanism(scene) || !is_of_joints(block);
}

/// The scene's error limit of a quantity, if it sets one.
std::optional<double> tolerated_error(const Scene& scene, std::string_view block);

/// Throws InputError if the scene breaks a rule of the file format. The rules cover: numbers that are not finite; a
/// mass or principal moment that is not positive (several bodies: negative, or moments without mass); triangle
/// inequality or symmetry violated by more than 1e-12 of the largest moment; | |q| - 1 | > 1e-6; an empty window; a
/// position together with a pivot; a plane without a shape, or one that the body penetrates at the start; for several
/// bodies, missing or duplicate names and joints that do not form trees. Does not check whether loops close. `file`
/// is named in the message.
void validate(const Scene& scene, const std::string& file);

/// The time window in which a load acts. An impulse has none; all time is returned.
Window window_of(const Load& load);

/// The name of the body that a load acts on. Empty if it acts on all bodies, between two bodies, or on the only one.
std::string load_body(const Load& load);

}  // namespace polhode
