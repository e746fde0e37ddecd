// Hypotheses about a wrong trajectory: how the file's columns are read, the scene that its engine ran, engine faults.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "check/convention.h"
#include "scene/scene.h"

namespace polhode {

/// How a file's columns are read, if not as they are named.
struct Reading {
    Axes axes = Axes::z_up_right;     ///< axes of all vectors and the quaternion
    bool scalar_last = false;         ///< the columns of the quaternion hold x, y, z, w
    bool inverted = false;            ///< the quaternion maps world to body
    double rate_unit = 1;             ///< unit of the angular velocity, rad/s; negative if its sign is reversed
    bool rate_in_body = false;        ///< the angular velocity is in body axes
    double length_unit = 1;           ///< unit of positions and velocities, m or m/s
    double position_unit = 1;         ///< additional factor of positions
    double velocity_unit = 1;         ///< additional factor of velocities
    bool origin = false;              ///< the position is the origin's, not the centre of mass's
    bool velocity_of_origin = false;  ///< the velocity is the origin's, not the centre of mass's
    int rows_late = 0;                ///< number of rows by which each state is late
};

/// Which rate rotates the attitude.
enum class AttitudeRate {
    own_rate,            ///< dq/dt = 1/2 q w_B, correct
    body_rate_in_world,  ///< dq/dt = 1/2 w_B q: the rate in body axes, multiplied on the left
    world_rate_in_body,  ///< dq/dt = 1/2 q w_W: the rate in world axes, multiplied on the right
    /// dq/dt = 1/2 q w_W in an engine that integrates w in body axes and converts it to world axes for the attitude.
    world_rate_in_body_w_in_body,
    /// Every substep of a row uses the rate at the start of the row. The angular velocity is integrated in world
    /// axes.
    first_rate_of_row_w_in_world,
    /// Every substep of a row uses the rate at the start of the row. The angular velocity is integrated in body axes.
    first_rate_of_row_w_in_body,
};

/// The terms of the origin's acceleration that an engine computes if it integrates the motion of the body's origin
/// instead of the centre of mass: a_origin = a_center - dw/dt x r - w x (w x r), with r from the origin to the centre
/// of mass.
struct OriginTerms {
    bool is_integrated = false;  ///< false: the engine integrates the motion of the centre of mass
    bool has_centripetal = true, has_euler = true;
};

/// The matrix that an engine uses as inertia tensor in world axes.
enum class WorldTensor {
    turned,            ///< R I R^T, correct
    fixed,             ///< I: not rotated with the body
    turned_back,       ///< R^T I R: rotated the wrong way
    diagonal,          ///< the diagonal of R I R^T
    inverse_diagonal,  ///< R I R^T, but the diagonal of R I^-1 R^T as its inverse
};

/// A first-order quaternion update that overwrites components that it still needs: x is computed with the new w, and
/// so on.
enum class InPlace {
    none,
    body_rate,   ///< q w_B
    world_rate,  ///< w_W q
};

/// The axes in which an engine applies a torque.
enum class TorqueAxes {
    own,            ///< correct axes
    body_in_world,  ///< its components in body axes are used as components in world axes
    world_in_body,  ///< its components in world axes are used as components in body axes
};

/// The quantity that a limit on the angular velocity clamps.
enum class LimitedQuantity {
    length,      ///< |w|
    body_axes,   ///< each component in body axes
    world_axes,  ///< each component in world axes
};

/// Faults of an engine's equations of motion:
/// I dw/dt = tau - gyroscopic w x I w - angular_damping I w, dv/dt = .. - linear_damping v, |w| <= speed_limit.
struct EngineFault {
    double gyroscopic = 1;                ///< 0: no term; -1: its sign is reversed; 2: twice
    TorqueAxes spring = TorqueAxes::own;  ///< axes of the springs' torque
    bool drag_in_world = false;           ///< coefficients of rotational drag in body axes are used along world axes
    bool arm_not_rotated = false;         ///< arms of forces in body axes are used in world axes
    double angular_damping = 0;           ///< 1/s
    Vector3<double> axis_damping_B;       ///< 1/s, of each component of w_B, in addition
    double linear_damping = 0;            ///< 1/s
    double speed_limit = std::numeric_limits<double>::infinity();  ///< rad/s
    LimitedQuantity limited_quantity = LimitedQuantity::length;    ///< what the limit clamps
    bool coasting_only = false;                           ///< damping and limit act only without torque or force
    bool damping_last = false;                            ///< damping and limit act after the attitude has been rotated
    WorldTensor tensor = WorldTensor::turned;             ///< the inertia tensor in world axes
    double rotation_factor = 1;                           ///< factor of the rate that rotates the attitude
    AttitudeRate rotation_rate = AttitudeRate::own_rate;  ///< which rate rotates the attitude
    double time = 1;                                      ///< simulated seconds per second of the rows
    InPlace in_place = InPlace::none;                     ///< how the quaternion is overwritten
    OriginTerms origin;                                   ///< how the origin's acceleration is computed
    bool formulas_held = false;                           ///< formulas are evaluated at the start of each row only
    bool no_rotation = false;                             ///< the attitude stays constant
    bool no_translation = false;                          ///< the position stays constant
};

/// The cause of a file: how to read it, the scene that its engine ran, and the engine's faults.
struct Cause {
    Reading reading;
    Scene scene;
    EngineFault engine;
};

/// Properties of a file that the trial values of hypotheses depend on.
struct FileFacts {
    double duration = 0;      ///< time from the first to the last row, s
    double row = 0;           ///< mean time between rows, s
    double largest_rate = 0;  ///< rad/s, from w or, without w, from the attitudes
    double usual_rate = 0;    ///< rad/s, the median instead of the largest
    /// The largest |component| of w in the file or, without w, from its attitudes, rad/s.
    Vector3<double> largest_rates_B, largest_rates_W;
};

/// The subject of a hypothesis. Two hypotheses with the same subject are not combined.
enum class Subject {
    quaternion,
    axes,
    rate_columns,
    lengths,
    point,
    gyroscopic,
    inertia,
    mass,
    center_of_mass,
    origin_centripetal,
    origin_euler,
    start_rate,
    start_attitude,
    start_position,
    gravity,
    torque,
    force,
    impulse,
    spring,
    drag,
    damping,
    linear_damping,
    limit,
    turn,
    time,
    rows,
    rest,
};

/// A known fault of engines or files. All are listed in check/known_faults.cpp.
struct Hypothesis {
    std::string fault;   ///< identifier for programs; hypotheses may share it
    Subject subject;     ///< what the fault is about
    std::string what;    ///< for users, without a full stop; {} stands for the fitted number
    std::string remedy;  ///< what to do about it
    /// Applies the fault to a sound cause. x: the fitted number, or 1. Returns false if the fault does not apply to
    /// the scene.
    std::function<bool(Cause&, double x)> apply;
    /// The trial numbers, at least three, in increasing order. The best is refined between its neighbours. Empty: no
    /// number is fitted.
    std::function<std::vector<double>(const FileFacts&)> values = {};
    std::string convention = {};  ///< the --convention that corrects the file, if there is one
};

/// All known faults of engines and files.
const std::vector<Hypothesis>& known_faults();

}  // namespace polhode
