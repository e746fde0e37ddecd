// A scene: data only. Which body, how it starts, what acts on it and for how long. No scene knows a method.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "body/algebra.h"
#include "text/message.h"

namespace polhode {

/// The axes a vector is given in, or the frame a point is fixed in.
enum class Frame { body, world };

/// A load acts for from <= t < until (s).
struct Window {
    double from = -std::numeric_limits<double>::infinity();
    double until = std::numeric_limits<double>::infinity();
};

/// Uniform acceleration (m/s^2, world axes); its force acts at the centre of mass.
struct Gravity {
    Vector3<double> acceleration_W;
    Window window;
};

/// A torque (N m) constant in `frame`.
struct Torque {
    Vector3<double> vector;
    Frame frame = Frame::body;
    Window window;
};

/// A force (N) constant in `frame`, acting at `point` (m), which is fixed in the body (from its origin) or in the
/// world.
struct Force {
    Vector3<double> vector;
    Frame frame = Frame::world;
    Vector3<double> point;
    Frame point_frame = Frame::body;
    Window window;
};

/// An impulse (N s) at time `at` (s); frames as for Force. A sample at that very time shows the motion after it.
struct Impulse {
    Vector3<double> vector;
    Frame frame = Frame::world;
    Vector3<double> point;
    Frame point_frame = Frame::body;
    double at = 0;
};

/// Torque -c_i omega_i in body axes (c in N m s) and force -c v at the centre of mass (c in N s/m).
struct Drag {
    Vector3<double> rotational;
    double translational = 0;
    Window window;
};

/// Torsional spring: r = q_rest* q, potential 2 k |r_vec|^2 = k (1 - cos angle), torque_B = -2 k r_w r_vec (k in N m).
struct Spring {
    double stiffness = 0;
    Quaternion<double> rest_orientation;
    Window window;
};

/// What a user's own torque is told: time (s), attitude as the method has it (not normalised), rates and position.
struct LoadState {
    double t = 0;
    Quaternion<double> q;
    Vector3<double> angular_velocity_B;  ///< rad/s
    Vector3<double> position_W;  ///< of the centre of mass, m; zero where the scene's translation is not integrated
    Vector3<double> velocity_W;  ///< m/s, likewise
};

/// A torque of the user's own (N m, body axes), smooth in its arguments. It has no file form, no derivative and no
/// truth: methods that need a derivative answer `unsupported`.
struct UserTorque {
    std::string name;
    std::function<Vector3<double>(const LoadState&)> torque_B;
    Window window;
};

using Load = std::variant<Gravity, Torque, Force, Impulse, Drag, Spring, UserTorque>;

struct BodySource;

/// Mass (kg), inertia tensor about the centre of mass (kg m^2, body axes, off-diagonal entries -int xy dm), and the
/// centre of mass from the body's origin (m).
struct Body {
    double mass = 1;
    Matrix3<double> inertia_B = diagonal(Vector3<double>(1, 1, 1));
    Vector3<double> center_of_mass;
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

/// Where the motion starts at t = 0. The orientation is kept as given; it stands for its normalised value.
struct Initial {
    Quaternion<double> orientation;
    Vector3<double> angular_velocity;  ///< rad/s, in angular_velocity_frame
    Frame angular_velocity_frame = Frame::body;
    Vector3<double> position_W;  ///< of the centre of mass, m
    Vector3<double> velocity_W;  ///< m/s
};

struct Scene {
    std::string directory;  ///< that the files it names are relative to; empty for the working directory
    std::string name;
    std::string about;
    std::string source;
    double duration = 0;  ///< s
    Body body;
    Initial initial;
    std::optional<Vector3<double>> pivot;  ///< body point (from the body's origin) held at the world's origin, m
    std::vector<Load> loads;
    std::vector<Plane> planes;                 ///< beside a body that has a shape, without a pivot
    std::optional<double> tolerated_attitude;  ///< rad
};

/// Throws InputError (file = the scene's name) where the scene breaks a rule of the file format: not finite, mass or
/// principal moment not positive, triangle inequality or symmetry broken by more than 1e-12 of the largest moment,
/// | |q| - 1 | > 1e-6, an empty window, a position beside a pivot, a plane beside a body without a
/// shape or above where it starts. `file` is named in the message.
void validate(const Scene& scene, const std::string& file);

/// The window of any load but an impulse, which has none.
Window window_of(const Load& load);

}  // namespace polhode
