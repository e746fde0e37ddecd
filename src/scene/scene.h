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
};

/// A force that is constant in the body's or in the world's axes and acts at a point fixed in the body or in the world.
struct Force {
    Vector3<double> vector;           ///< N
    Frame frame = Frame::world;       ///< the axes of `vector`
    Vector3<double> point;            ///< m, from the origin of `point_frame`
    Frame point_frame = Frame::body;  ///< what the point is fixed in
    Window window;                    ///< when it acts
};

/// An impulse at one time. A sample at that very time shows the motion after it.
struct Impulse {
    Vector3<double> vector;           ///< N s
    Frame frame = Frame::world;       ///< the axes of `vector`
    Vector3<double> point;            ///< m, from the origin of `point_frame`
    Frame point_frame = Frame::body;  ///< what the point is fixed in
    double at = 0;                    ///< s
};

/// Linear drag: the torque -c_i omega_i along each body axis and the force -c v at the centre of mass.
struct Drag {
    Vector3<double> rotational;  ///< c_1, c_2, c_3 along the body axes, N m s
    double translational = 0;    ///< c, N s/m
    Window window;               ///< when it acts
};

/// A torsional spring. With r = q_rest* q, of scalar part r_w and vector part r_v, and the angle between the attitude
/// and the one at rest: its potential is 2 k |r_v|^2 = k (1 - cos angle), its torque in body axes -2 k r_w r_v.
struct Spring {
    double stiffness = 0;                 ///< k, N m
    Quaternion<double> rest_orientation;  ///< q_rest, body to world; it stands for its normalised value
    Window window;                        ///< when it acts
};

/// What a user's own torque is told of the motion.
struct LoadState {
    double t = 0;                        ///< s
    Quaternion<double> q;                ///< body to world, as the method has it (not normalised)
    Vector3<double> angular_velocity_B;  ///< rad/s
    Vector3<double> position_W;  ///< of the centre of mass, m; zero where the scene's translation is not integrated
    Vector3<double> velocity_W;  ///< of the centre of mass, m/s; zero where the scene's translation is not integrated
};

/// A torque of the user's own (N m, body axes), smooth in its arguments. It has no file form, no derivative and no
/// truth: methods that need a derivative answer `unsupported`.
struct UserTorque {
    std::string name;                                           ///< for messages
    std::function<Vector3<double>(const LoadState&)> torque_B;  ///< N m
    Window window;                                              ///< when it acts
};

/// Whatever acts on a body.
using Load = std::variant<Gravity, Torque, Force, Impulse, Drag, Spring, UserTorque>;

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
    std::vector<Load> loads;               ///< what acts on the body
    std::vector<Plane> planes;             ///< beside a body that has a shape, without a pivot
    /// The errors that `check` lets pass, by the names in tolerated_blocks: attitude (rad), angular_velocity (rad/s),
    /// position (m), velocity (m/s), energy and momentum (relative to the largest of the run).
    std::map<std::string, double> tolerated;
};

/// What a scene can tolerate errors of.
inline constexpr std::array<std::string_view, 6> tolerated_blocks{"attitude", "angular_velocity", "position",
                                                                  "velocity", "energy",           "momentum"};

/// The error of a block that the scene tolerates, if it says so.
std::optional<double> tolerated_error(const Scene& scene, std::string_view block);

/// Throws InputError where the scene breaks a rule of the file format: a number that is not finite, a mass or a
/// principal moment that is not positive, triangle inequality or symmetry broken by more than 1e-12 of the largest
/// moment, | |q| - 1 | > 1e-6, an empty window, a position beside a pivot, a plane beside a body without a shape or
/// above where it starts. `file` is named in the message.
void validate(const Scene& scene, const std::string& file);

/// When a load acts: its window, or all time for an impulse, which has none.
Window window_of(const Load& load);

}  // namespace polhode
