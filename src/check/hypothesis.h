// What may be wrong with a trajectory: how the file has to be read, and what its engine does.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "check/convention.h"
#include "scene/scene.h"

namespace polhode {

/// How a file's columns have to be read in place of what they are named.
struct Reading {
    Axes axes = Axes::z_up_right;     ///< that all vectors and the quaternion are written in
    bool scalar_last = false;         ///< the columns of the quaternion hold x, y, z, w
    bool inverted = false;            ///< the quaternion maps world to body
    double rate_unit = 1;             ///< rad/s in the unit of the angular velocity; negative where its sign is turned
    bool rate_in_body = false;        ///< the angular velocity is in body axes
    double length_unit = 1;           ///< m in the unit of positions and velocities
    double position_unit = 1;         ///< the same of positions alone
    double velocity_unit = 1;         ///< the same of velocities alone
    bool origin = false;              ///< the position is the origin's, not the centre of mass's
    bool velocity_of_origin = false;  ///< the velocity is the origin's, not the centre of mass's
    int rows_late = 0;                ///< how many rows later than its time each state stands
};

/// Which rate turns the attitude.
enum class TurnedBy {
    own_rate,            ///< dq/dt = 1/2 q w_B, as it should be
    body_rate_in_world,  ///< dq/dt = 1/2 w_B q: the rate in body axes, multiplied on the world's side
    world_rate_in_body,  ///< dq/dt = 1/2 q w_W: the rate in world axes, multiplied on the body's side
    /// The same of an engine that integrates w in body axes, and converts it to world axes to turn the attitude.
    world_rate_in_body_w_in_body,
    /// Every substep of a row uses the rate at the start of the row. The angular velocity is integrated in world axes.
    first_rate_of_row_w_in_world,
    /// Every substep of a row uses the rate at the start of the row. The angular velocity is integrated in body axes.
    first_rate_of_row_w_in_body,
};

/// Which terms of the acceleration of the body's origin an engine computes when it integrates the motion of the origin
/// in place of that of the centre of mass. With r from the origin to the centre of mass,
/// a_origin = a_center - dw/dt x r - w x (w x r).
struct OriginTerms {
    bool is_integrated = false;  ///< false: the engine integrates the motion of the centre of mass
    bool has_centripetal = true, has_euler = true;
};

/// What an engine takes for the inertia tensor in world axes, R I R^T as it should be.
enum class WorldTensor {
    turned,            ///< R I R^T
    fixed,             ///< I: it is not turned with the body
    turned_back,       ///< R^T I R: it is turned the wrong way
    diagonal,          ///< the diagonal of R I R^T
    inverse_diagonal,  ///< R I R^T, and for its inverse the diagonal of R I^-1 R^T
};

/// A first-order quaternion update that overwrites components which it still needs: the new w stands in for the old one
/// in x, and so on.
enum class InPlace {
    none,
    body_rate,   ///< of q w_B
    world_rate,  ///< of w_W q
};

/// In which axes an engine applies a torque that it computes in axes of its own.
enum class TorqueAxes {
    own,
    body_in_world,  ///< its components in body axes are taken for those in world axes
    world_in_body,  ///< its components in world axes are taken for those in body axes
};

/// What a limit on the angular velocity holds.
enum class LimitOf {
    length,      ///< |w|
    body_axes,   ///< each component in body axes
    world_axes,  ///< each component in world axes
};

/// What an engine does to Euler's equations and to the attitude's beside what the scene says:
/// I dw/dt = tau - gyroscopic w x I w - angular_damping I w, dv/dt = .. - linear_damping v, |w| <= speed_limit.
struct EngineFault {
    double gyroscopic = 1;                ///< 0: no term; -1: its sign is reversed; 2: twice
    TorqueAxes spring = TorqueAxes::own;  ///< of the springs' torque
    bool drag_in_world = false;           ///< coefficients of rotational drag in body axes are used along world axes
    bool arm_not_rotated = false;         ///< arms of forces in body axes are used in world axes
    double angular_damping = 0;           ///< 1/s
    Vector3<double> axis_damping_B;       ///< 1/s, of each component of w_B, beside the other
    double linear_damping = 0;            ///< 1/s
    double speed_limit = std::numeric_limits<double>::infinity();  ///< rad/s
    LimitOf limit_of = LimitOf::length;                            ///< what the limit holds
    bool only_coasting = false;                                    ///< both act only where no torque or force does
    bool damped_last = false;  ///< damping and limit act at the end of a step, after the attitude has turned
    WorldTensor tensor = WorldTensor::turned;  ///< the inertia tensor in world axes
    double turn = 1;                           ///< factor of the rate that turns the attitude
    TurnedBy turned_by = TurnedBy::own_rate;   ///< which rate that is
    double time = 1;                           ///< so much time passes in a second of its clock
    InPlace in_place = InPlace::none;          ///< how the quaternion is overwritten
    OriginTerms origin;                        ///< how the origin's acceleration is computed
    bool no_rotation = false;                  ///< the attitude stays as it is
    bool no_translation = false;               ///< the position stays as it is
};

/// A file explained: how to read it, the scene that its engine was given, and what the engine does.
struct Cause {
    Reading reading;
    Scene scene;
    EngineFault engine;
};

/// What is known of a file before any hypothesis is tried.
struct FileFacts {
    double duration = 0;      ///< s, of its rows
    double row = 0;           ///< s, between two of them (the median)
    double largest_rate = 0;  ///< rad/s, in the file or, without w, by its attitudes
    double usual_rate = 0;    ///< rad/s, the median of the same
    /// The largest |component| of w in the file or, without w, by its attitudes, rad/s.
    Vector3<double> most_in_body_axes, most_in_world_axes;
};

/// What a hypothesis is about: two that are about the same thing are not tried together.
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

/// A fault that engines and their files are known to have. All stand in one table, check/known_faults.cpp.
struct Hypothesis {
    std::string fault;   ///< a word for programs: "gyroscopic_term_missing"; several rows may share it
    Subject subject;     ///< what it is about
    std::string what;    ///< for people, without a full stop; {} stands for the number fitted
    std::string remedy;  ///< what to do about it
    /// Makes the fault's cause of a sound one; x is the number fitted, or 1. False where it means nothing in the scene.
    std::function<bool(Cause&, double x)> apply;
    /// The numbers to try, in increasing order, three at least: the best is refined between its neighbours. Nothing is
    /// fitted without.
    std::function<std::vector<double>(const FileFacts&)> values = {};
    std::string convention = {};  ///< the words of --convention that mend the file, if any do
};

/// All that are known.
const std::vector<Hypothesis>& known_faults();

}  // namespace polhode
