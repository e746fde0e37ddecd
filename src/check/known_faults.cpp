// Table of known faults of engines and their files. To add a fault, add a row.
#include <cmath>
#include <numbers>
#include <tuple>

#include "check/fault_effects.h"

namespace polhode {
namespace {

using namespace fault_effects;

constexpr double degree = std::numbers::pi / 180;
constexpr double revolution_per_minute = std::numbers::pi / 30;

using Apply = std::function<bool(Cause&, double)>;
using Values = std::vector<double> (*)(const FileFacts&);

// A fault, with a fitted number if `values` is given.
Hypothesis fitted_fault(std::string fault, Subject subject, std::string what, std::string remedy, Apply apply,
                        Values values = nullptr, std::string convention = "") {
    Hypothesis h{.fault = std::move(fault),
                 .subject = subject,
                 .what = std::move(what),
                 .remedy = std::move(remedy),
                 .apply = std::move(apply),
                 .values = {},
                 .convention = std::move(convention)};
    if (values) h.values = values;
    return h;
}
// A fault with a fixed number.
Hypothesis fixed_fault(std::string fault, Subject subject, std::string what, std::string remedy,
                       bool (*apply)(Cause&, double), double x = 1) {
    return fitted_fault(std::move(fault), subject, std::move(what), std::move(remedy),
                        [apply, x](Cause& c, double) { return apply(c, x); });
}
Hypothesis reading_fault(std::string fault, Subject subject, std::string what, std::string remedy,
                         void (*change)(Reading&), std::string convention = "") {
    return fitted_fault(std::move(fault), subject, std::move(what), std::move(remedy), change_reading(change), nullptr,
                        std::move(convention));
}
Hypothesis engine_fault(std::string fault, Subject subject, std::string what, std::string remedy,
                        void (*change)(EngineFault&, double)) {
    return fitted_fault(std::move(fault), subject, std::move(what), std::move(remedy), change_engine(change));
}

// Factors closer to 1 than this can be caused by truncation errors.
bool is_plain(double factor) { return std::abs(std::log(factor)) > 0.02; }

// Returns count + 1 values from `from` to `to`, equally spaced in their logarithms.
std::vector<double> logarithmic(double from, double to, int count) {
    std::vector<double> values;
    for (int i = 0; i <= count; ++i) values.push_back(from * std::pow(to / from, static_cast<double>(i) / count));
    return values;
}

std::vector<double> factors(const FileFacts&) { return logarithmic(0.05, 20, 40); }
// Decay rates: from slow over the whole run to fast within a row.
std::vector<double> damping_rates(const FileFacts& facts) {
    return logarithmic(3e-3 / std::max(facts.duration, 1e-9), 0.5 / std::max(facts.row, 1e-12), 48);
}
// Step rates, from one to about 20 steps per row.
std::vector<double> steps_per_second(const FileFacts& facts) {
    return logarithmic(0.9 / std::max(facts.row, 1e-12), 22 / std::max(facts.row, 1e-12), 24);
}
std::vector<double> time_factors(const FileFacts&) { return logarithmic(0.2, 5, 60); }
// Speed limits: near the median or the largest speed, where a limit shows.
std::vector<double> speed_limits(const FileFacts& facts) {
    std::vector<double> values;
    for (const double rate : {facts.usual_rate, facts.largest_rate})
        for (const double factor : {0.98, 0.99, 1.0, 1.01, 1.02}) values.push_back(factor * rate);
    std::sort(values.begin(), values.end());
    return values;
}

// Limits on components of w: near their largest values.
template <LimitedQuantity quantity>
std::vector<double> component_limits(const FileFacts& facts) {
    std::vector<double> values;
    const Vector3<double>& most =
        quantity == LimitedQuantity::body_axes ? facts.largest_rates_B : facts.largest_rates_W;
    for (int i = 0; i < 3; ++i)
        for (const double factor : {0.98, 0.99, 1.0, 1.01, 1.02})
            if (most[i] > 1e-6 * facts.largest_rate) values.push_back(factor * most[i]);
    std::sort(values.begin(), values.end());
    return values;
}

// A fault that scales a quantity of the scene by a fitted factor.
Hypothesis scaled_fault(std::string fault, Subject subject, std::string what, std::string remedy,
                        bool (*apply)(Cause&, double)) {
    return fitted_fault(
        std::move(fault), subject, std::move(what), std::move(remedy),
        [apply](Cause& c, double x) { return is_plain(x) && apply(c, x); }, factors);
}

// Reads the position columns as the other point: origin or centre of mass.
bool read_other_point(Cause& c, bool origin) {
    if (c.reading.origin != origin || !(length(c.scene.body.center_of_mass) > 0)) return false;
    c.reading.origin = !origin;
    return true;
}
bool read_velocity_of_origin(Cause& c) {
    c.reading.velocity_of_origin = true;
    return length(c.scene.body.center_of_mass) > 0;
}

std::vector<Hypothesis> readings() {
    using S = Subject;
    std::vector<Hypothesis> all{
        reading_fault(
            "scalar_last_quaternion", S::quaternion,
            "the quaternion is scalar-last: the columns qw,qx,qy,qz hold x, y, z, w", "give --convention scalar-last",
            [](Reading& r) { r.scalar_last = true; }, "scalar-last"),
        reading_fault("inverted_orientation", S::quaternion,
                      "the attitude is inverted (transposed): it maps world to body", "write the conjugate quaternion",
                      [](Reading& r) { r.inverted = true; }),
        reading_fault(
            "scalar_last_and_inverted", S::quaternion,
            "the quaternion is scalar-last and inverted: the columns hold x, y, z, w of the map from world to body",
            "write the conjugate and give --convention scalar-last",
            [](Reading& r) { r.scalar_last = true, r.inverted = true; }),
        reading_fault(
            "other_axes", S::axes, "the file is written y-up, right-handed", "give --convention y-up",
            [](Reading& r) { r.axes = Axes::y_up_right; }, "y-up"),
        reading_fault(
            "other_axes", S::axes, "the file is written y-up, left-handed", "give --convention y-up,left-handed",
            [](Reading& r) { r.axes = Axes::y_up_left; }, "y-up,left-handed"),
        reading_fault(
            "other_axes", S::axes, "the file is written z-up, left-handed", "give --convention left-handed",
            [](Reading& r) { r.axes = Axes::z_up_left; }, "left-handed"),
        reading_fault(
            "angular_velocity_in_body_axes", S::rate_columns, "wx,wy,wz are in body axes",
            "write them in world axes, or give --convention body-rates", [](Reading& r) { r.rate_in_body = true; },
            "body-rates"),
        reading_fault(
            "angular_velocity_in_degrees", S::rate_columns, "wx,wy,wz are in degrees per second",
            "write radians per second, or give --convention degrees", [](Reading& r) { r.rate_unit = degree; },
            "degrees"),
        reading_fault("angular_velocity_in_rpm", S::rate_columns, "wx,wy,wz are in revolutions per minute",
                      "write radians per second", [](Reading& r) { r.rate_unit = revolution_per_minute; }),
        reading_fault("angular_velocity_in_revolutions", S::rate_columns, "wx,wy,wz are in revolutions per second",
                      "write radians per second", [](Reading& r) { r.rate_unit = 2 * std::numbers::pi; }),
        reading_fault("angular_velocity_negated", S::rate_columns, "wx,wy,wz have the opposite sign",
                      "negate the angular velocity", [](Reading& r) { r.rate_unit = -1; }),
        reading_fault(
            "angular_velocity_in_degrees_and_body_axes", S::rate_columns,
            "wx,wy,wz are in degrees per second and in body axes", "write radians per second, in world axes",
            [](Reading& r) { r.rate_unit = degree, r.rate_in_body = true; }, "degrees,body-rates"),
        reading_fault("angular_velocity_in_rpm_and_body_axes", S::rate_columns,
                      "wx,wy,wz are in revolutions per minute and in body axes",
                      "write radians per second, in world axes",
                      [](Reading& r) { r.rate_unit = revolution_per_minute, r.rate_in_body = true; }),
        reading_fault("angular_velocity_negated_and_in_body_axes", S::rate_columns,
                      "wx,wy,wz have the opposite sign and are in body axes",
                      "negate them and write them in world axes",
                      [](Reading& r) { r.rate_unit = -1, r.rate_in_body = true; }),
        reading_fault("positions_in_centimetres", S::lengths, "positions are in centimetres, but velocities are not",
                      "write metres", [](Reading& r) { r.position_unit = 0.01; }),
        reading_fault("velocities_in_centimetres", S::lengths,
                      "velocities are in centimetres per second, but positions are not", "write metres per second",
                      [](Reading& r) { r.velocity_unit = 0.01; }),
        reading_fault("velocity_negated", S::lengths, "vx,vy,vz have the opposite sign", "negate the velocity",
                      [](Reading& r) { r.velocity_unit = -1; }),
        reading_fault("one_row_late", S::rows,
                      "each row shows the state of the previous row: the file is written before the step, or from the "
                      "previous frame",
                      "write each row after its step", [](Reading& r) { r.rows_late = 1; }),
        reading_fault("one_row_early", S::rows,
                      "each row shows the state of the next row: the initial state is missing",
                      "write the initial state as the first row, or start the times one step later",
                      [](Reading& r) { r.rows_late = -1; }),
    };
    for (const char* unit : {"centimetres", "millimetres", "inches", "feet"})
        all.push_back({.fault = std::string("lengths_in_") + unit,
                       .subject = S::lengths,
                       .what = std::string("positions and velocities are in ") + unit,
                       .remedy = std::string("write metres, or give --convention ") + unit,
                       .apply =
                           [metres = *length_unit(unit)](Cause& c, double) {
                               c.reading.length_unit = metres;
                               return true;
                           },
                       .convention = unit});
    all.push_back({.fault = "origin_for_center_of_mass",
                   .subject = S::point,
                   .what = "the position is the body's origin, not its centre of mass",
                   .remedy = "name the columns ox,oy,oz, or write the position of the centre of mass",
                   .apply = [](Cause& c, double) { return read_other_point(c, false); }});
    all.push_back({.fault = "center_of_mass_for_origin",
                   .subject = S::point,
                   .what = "ox,oy,oz are the centre of mass, not the body's origin",
                   .remedy = "name the columns px,py,pz",
                   .apply = [](Cause& c, double) { return read_other_point(c, true); }});
    all.push_back({.fault = "velocity_of_origin",
                   .subject = S::point,
                   .what = "vx,vy,vz are the velocity of the body's origin, not of its centre of mass",
                   .remedy = "write v + w x r, with r from the origin to the centre of mass",
                   .apply = [](Cause& c, double) { return read_velocity_of_origin(c); }});
    all.push_back({.fault = "origin_for_center_of_mass",
                   .subject = S::point,
                   .what = "position and velocity are those of the body's origin, not of its centre of mass",
                   .remedy = "name the position columns ox,oy,oz, and write v + w x r, with r from the origin to the "
                             "centre of mass",
                   .apply = [](Cause& c, double) { return read_other_point(c, false) && read_velocity_of_origin(c); }});
    return all;
}

std::vector<Hypothesis> engine_faults() {
    using S = Subject;
    return {
        engine_fault("gyroscopic_term_missing", S::gyroscopic, "the gyroscopic term is missing",
                     "enable the engine's gyroscopic term", [](EngineFault& e, double) { e.gyroscopic = 0; }),
        engine_fault("gyroscopic_term_reversed", S::gyroscopic, "the gyroscopic term has the wrong sign",
                     "use I dw/dt = tau - w x I w", [](EngineFault& e, double) { e.gyroscopic = -1; }),
        engine_fault("gyroscopic_term_twice", S::gyroscopic, "the gyroscopic term is applied twice",
                     "use I dw/dt = tau - w x I w", [](EngineFault& e, double) { e.gyroscopic = 2; }),
        engine_fault("attitude_turned_at_half_rate", S::turn, "the attitude rotates at half the angular velocity w",
                     "use dq/dt = 1/2 w q, with the factor 1/2 once",
                     [](EngineFault& e, double) { e.rotation_factor = 0.5; }),
        engine_fault(
            "attitude_turned_at_twice_the_rate", S::turn, "the attitude rotates at twice the angular velocity w",
            "use dq/dt = 1/2 w q: the factor 1/2 is missing", [](EngineFault& e, double) { e.rotation_factor = 2; }),
        engine_fault("attitude_turned_backwards", S::turn, "the attitude rotates at the angular velocity -w",
                     "negate w in the quaternion update", [](EngineFault& e, double) { e.rotation_factor = -1; }),
        engine_fault("body_rate_multiplied_on_the_left", S::turn,
                     "the quaternion update multiplies the rate in body axes on the left: w q instead of q w",
                     "use dq/dt = 1/2 q w for a rate in body axes",
                     [](EngineFault& e, double) { e.rotation_rate = AttitudeRate::body_rate_in_world; }),
        engine_fault("world_rate_multiplied_on_the_right", S::turn,
                     "the quaternion update multiplies the rate in world axes on the right: q w instead of w q",
                     "use dq/dt = 1/2 w q for a rate in world axes",
                     [](EngineFault& e, double) { e.rotation_rate = AttitudeRate::world_rate_in_body; }),
        engine_fault("world_rate_multiplied_on_the_right", S::turn,
                     "the quaternion update multiplies the rate in world axes on the right: q w instead of w q (w is "
                     "integrated in body axes)",
                     "use dq/dt = 1/2 w q for a rate in world axes",
                     [](EngineFault& e, double) { e.rotation_rate = AttitudeRate::world_rate_in_body_w_in_body; }),
        engine_fault(
            "quaternion_updated_in_place", S::turn,
            "the quaternion is updated in place: qx is computed with the new qw, qy with both, and so on (body rate)",
            "keep the old components until all four are computed",
            [](EngineFault& e, double) { e.in_place = InPlace::body_rate; }),
        engine_fault(
            "quaternion_updated_in_place", S::turn,
            "the quaternion is updated in place: qx is computed with the new qw, qy with both, and so on (world rate)",
            "keep the old components until all four are computed",
            [](EngineFault& e, double) { e.in_place = InPlace::world_rate; }),
        engine_fault("attitude_turned_by_first_rate", S::turn,
                     "all substeps of a row rotate the attitude by the angular velocity at the start of the row (w is "
                     "integrated in world axes)",
                     "rotate the attitude in each substep by the angular velocity of that substep",
                     [](EngineFault& e, double) { e.rotation_rate = AttitudeRate::first_rate_of_row_w_in_world; }),
        engine_fault("attitude_turned_by_first_rate", S::turn,
                     "all substeps of a row rotate the attitude by the angular velocity at the start of the row (w is "
                     "integrated in body axes)",
                     "rotate the attitude in each substep by the angular velocity of that substep",
                     [](EngineFault& e, double) { e.rotation_rate = AttitudeRate::first_rate_of_row_w_in_body; }),
        engine_fault("rotation_frozen", S::rest, "the attitude never changes",
                     "integrate the attitude, or wake the body", [](EngineFault& e, double) { e.no_rotation = true; }),
        {.fault = "position_frozen",
         .subject = S::rest,
         .what = "the position never changes",
         .remedy = "integrate the position",
         .apply =
             [](Cause& c, double) {
                 c.engine.no_translation = true;
                 return !c.scene.pivot;
             }},
        fitted_fault("speed_clamped", S::limit, "the angular speed is clamped at {} rad/s",
                     "raise the engine's limit on angular speed",
                     change_engine([](EngineFault& e, double x) { e.speed_limit = x; }), speed_limits),
        fitted_fault("speed_clamped_by_axis", S::limit, "each component of w is clamped at {} rad/s in body axes",
                     "raise the engine's limit on angular speed", change_engine([](EngineFault& e, double x) {
                         e.speed_limit = x, e.limited_quantity = LimitedQuantity::body_axes;
                     }),
                     component_limits<LimitedQuantity::body_axes>),
        fitted_fault("speed_clamped_by_axis", S::limit, "each component of w is clamped at {} rad/s in world axes",
                     "raise the engine's limit on angular speed", change_engine([](EngineFault& e, double x) {
                         e.speed_limit = x, e.limited_quantity = LimitedQuantity::world_axes;
                     }),
                     component_limits<LimitedQuantity::world_axes>),
        fitted_fault("speed_clamped", S::limit, "the angular speed is clamped at {} rad/s at the end of each step",
                     "raise the engine's limit on angular speed",
                     change_engine([](EngineFault& e, double x) { e.speed_limit = x, e.damping_last = true; }),
                     speed_limits),
        fitted_fault("speed_clamped_by_axis", S::limit,
                     "each component of w is clamped at {} rad/s in body axes at the end of each step",
                     "raise the engine's limit on angular speed", change_engine([](EngineFault& e, double x) {
                         e.speed_limit = x, e.limited_quantity = LimitedQuantity::body_axes, e.damping_last = true;
                     }),
                     component_limits<LimitedQuantity::body_axes>),
        fitted_fault("speed_clamped_by_axis", S::limit,
                     "each component of w is clamped at {} rad/s in world axes at the end of each step",
                     "raise the engine's limit on angular speed", change_engine([](EngineFault& e, double x) {
                         e.speed_limit = x, e.limited_quantity = LimitedQuantity::world_axes, e.damping_last = true;
                     }),
                     component_limits<LimitedQuantity::world_axes>),
        fitted_fault(
            "speed_clamped_while_coasting", S::limit,
            "the angular speed is clamped at {} rad/s while no torque or force acts",
            "raise the engine's limit on angular speed",
            [](Cause& c, double x) {
                c.engine.speed_limit = x, c.engine.coasting_only = true;
                return has_pushes(c.scene);
            },
            speed_limits),
        fitted_fault(
            "damping_while_coasting", S::damping,
            "w decays {} 1/s faster than in the scene while no torque or force acts",
            "disable the engine's angular damping",
            [](Cause& c, double x) {
                c.engine.angular_damping = x, c.engine.coasting_only = true;
                return has_pushes(c.scene);
            },
            damping_rates),
        fitted_fault(
            "damping_while_coasting", S::damping,
            "w decays {} 1/s faster than in the scene while no torque or force acts, at the end of each step",
            "disable the engine's angular damping",
            [](Cause& c, double x) {
                c.engine.angular_damping = x, c.engine.coasting_only = c.engine.damping_last = true;
                return has_pushes(c.scene);
            },
            damping_rates),
        {.fault = "drag_applied_to_w",
         .subject = S::damping,
         .what =
             "the drag coefficient c is used as a decay rate: dw/dt = -c w, without division by the moment of inertia",
         .remedy = "apply the torque -c w",
         .apply = drag_on_rate},
        {.fault = "drag_applied_to_w",
         .subject = S::damping,
         .what =
             "the drag coefficient c is used as a decay rate at the end of each step: dw/dt = -c w, without division "
             "by the moment of inertia",
         .remedy = "apply the torque -c w",
         .apply =
             [](Cause& c, double x) {
                 c.engine.damping_last = true;
                 return drag_on_rate(c, x);
             }},
        engine_fault(
            "inertia_not_rotated", S::inertia,
            "the inertia tensor is not rotated with the body: the tensor in body axes is used in world axes, or "
            "Euler's equations in body axes are used for the rate in world axes",
            "use I_W = R I R^T in each step", [](EngineFault& e, double) { e.tensor = WorldTensor::fixed; }),
        engine_fault("inertia_rotated_backwards", S::inertia,
                     "the inertia tensor is rotated the wrong way: R^T I R instead of R I R^T", "use I_W = R I R^T",
                     [](EngineFault& e, double) { e.tensor = WorldTensor::turned_back; }),
        engine_fault("inertia_diagonal_in_world_axes", S::inertia,
                     "only the diagonal of the inertia tensor in world axes is used", "use the full tensor R I R^T",
                     [](EngineFault& e, double) { e.tensor = WorldTensor::diagonal; }),
        engine_fault("inertia_diagonal_in_world_axes", S::inertia,
                     "only the diagonal of the inverse inertia tensor in world axes is used",
                     "use the full tensor R I^-1 R^T",
                     [](EngineFault& e, double) { e.tensor = WorldTensor::inverse_diagonal; }),
        fitted_fault("damping_left_on", S::damping, "damping is left on: w decays {} 1/s faster than in the scene",
                     "disable the engine's angular damping",
                     change_engine([](EngineFault& e, double x) { e.angular_damping = x; }), damping_rates),
        fitted_fault("damping_left_on", S::damping,
                     "damping is left on: w decays {} 1/s faster than in the scene, at the end of each step",
                     "disable the engine's angular damping",
                     change_engine([](EngineFault& e, double x) { e.angular_damping = x, e.damping_last = true; }),
                     damping_rates),
        fitted_fault(
            "linear_damping_left_on", S::linear_damping,
            "linear damping is left on: v decays {} 1/s faster than in the scene",
            "disable the engine's linear damping",
            [](Cause& c, double x) {
                c.engine.linear_damping = x;
                return !c.scene.pivot;
            },
            damping_rates),
        {.fault = "damping_left_on",
         .subject = S::damping,
         .what = "damping is left on: w and v decay {} 1/s faster than in the scene",
         .remedy = "disable the engine's damping",
         .apply =
             [](Cause& c, double x) {
                 c.engine.angular_damping = c.engine.linear_damping = x;
                 return !c.scene.pivot;
             },
         .values = damping_rates},
        fitted_fault(
            "wrong_time_step", S::time,
            "the step is wrong: simulated time passes {} times as fast as the times of the rows",
            "give the step in s, and take as many steps as the times of the rows need",
            [](Cause& c, double x) {
                c.engine.time = x;
                return is_plain(x);
            },
            time_factors),
    };
}

std::vector<Hypothesis> body_faults() {
    using S = Subject;
    const char* const order = "give the moments in the order of the body axes";
    return {
        fixed_fault("inertia_axes_permuted", S::inertia, "the moments of inertia about x and y are exchanged", order,
                    permute_axes<1, 0, 2>),
        fixed_fault("inertia_axes_permuted", S::inertia, "the moments of inertia about y and z are exchanged", order,
                    permute_axes<0, 2, 1>),
        fixed_fault("inertia_axes_permuted", S::inertia, "the moments of inertia about x and z are exchanged", order,
                    permute_axes<2, 1, 0>),
        fixed_fault("inertia_axes_permuted", S::inertia, "the moments of inertia are in the order y, z, x", order,
                    permute_axes<1, 2, 0>),
        fixed_fault("inertia_axes_permuted", S::inertia, "the moments of inertia are in the order z, x, y", order,
                    permute_axes<2, 0, 1>),
        fixed_fault("products_of_inertia_dropped", S::inertia, "the products of inertia are missing",
                    "give the engine the full tensor, or its principal axes", scale_products, 0),
        fixed_fault("products_of_inertia_reversed", S::inertia,
                    "the products of inertia have the opposite sign: int xy dm instead of -int xy dm",
                    "negate the tensor's off-diagonal elements", scale_products, -1),
        fixed_fault("principal_frame_transposed", S::inertia, "the rotation to the principal axes is transposed",
                    "use I = R D R^T, where R maps principal axes to body axes", transpose_principal_frame),
        fixed_fault("principal_frame_forgotten", S::inertia,
                    "the principal moments are used about the body axes: the rotation to the principal axes is missing",
                    "give the engine the rotation to the principal axes", drop_principal_frame),
        fixed_fault("inertia_taken_for_a_ball", S::inertia, "one mean moment of inertia is used about all axes",
                    "give the engine the full tensor", mean_moment),
        fixed_fault("center_of_mass_for_origin", S::center_of_mass,
                    "the centre of mass is assumed to be at the body's origin: arms and pivot are measured from there",
                    "give the engine the body's centre of mass", center_at_origin),
        fixed_fault("center_of_mass_for_origin", S::center_of_mass,
                    "forces act as if the centre of mass were at the body's origin: only the inertia uses its position",
                    "give the engine the body's centre of mass", inertia_about_origin),
        fixed_fault(
            "inertia_not_shifted_to_pivot", S::inertia,
            "the tensor about the centre of mass is used about the pivot: the term m (r.r 1 - r r^T) is missing",
            "add the parallel-axis term", add_parallel_axis, -1),
        fixed_fault("inertia_shifted_twice", S::inertia, "the tensor is shifted to the pivot twice",
                    "add the parallel-axis term once", add_parallel_axis, 1),
        fixed_fault(
            "origin_without_centripetal_term", S::origin_centripetal,
            "the engine integrates the motion of the body's origin without the term w x (w x r) of its acceleration, "
            "where r points from the origin to the centre of mass",
            "use a_origin = F/m - dw/dt x r - w x (w x r), or integrate the motion of the centre of mass",
            origin_without_centripetal_term),
        fixed_fault(
            "origin_without_euler_term", S::origin_euler,
            "the engine integrates the motion of the body's origin without the term dw/dt x r of its acceleration, "
            "where r points from the origin to the centre of mass",
            "use a_origin = F/m - dw/dt x r - w x (w x r), or integrate the motion of the centre of mass",
            origin_without_euler_term),
        scaled_fault("inertia_scaled", S::mass, "the moments of inertia are {} times the scene's",
                     "check the unit of length and the density used for the tensor", scale_inertia),
        scaled_fault("mass_scaled", S::mass, "the mass is {} times the scene's", "check the mass or the density",
                     scale_mass),
        scaled_fault("density_scaled", S::mass, "mass and moments of inertia are {} times the scene's",
                     "check the density or the unit of mass", scale_density),
    };
}

std::vector<Hypothesis> start_faults() {
    using S = Subject;
    const char* const unit = "convert the initial angular velocity to the engine's unit";
    return {
        fixed_fault("degrees_for_radians", S::start_rate,
                    "the initial angular velocity in rad/s is used as degrees per second", unit, scale_start_rate,
                    degree),
        fixed_fault("degrees_for_radians", S::start_rate,
                    "the initial angular velocity in degrees per second is used as rad/s", unit, scale_start_rate,
                    1 / degree),
        fixed_fault("rpm_for_radians", S::start_rate,
                    "the initial angular velocity in rad/s is used as revolutions per minute", unit, scale_start_rate,
                    revolution_per_minute),
        fixed_fault("rpm_for_radians", S::start_rate,
                    "the initial angular velocity in revolutions per minute is used as rad/s", unit, scale_start_rate,
                    1 / revolution_per_minute),
        fixed_fault("start_rate_negated", S::start_rate, "the initial angular velocity has the opposite sign",
                    "negate the initial angular velocity", scale_start_rate, -1),
        fixed_fault("start_without_rate", S::start_rate, "the body starts without its initial angular velocity",
                    "set the initial angular velocity", scale_start_rate, 0),
        fixed_fault("body_for_world_angular_velocity", S::start_rate,
                    "the initial angular velocity in body axes is used in world axes",
                    "convert it to the engine's axes first", start_rate_in_other_frame<Frame::body>),
        fixed_fault("body_for_world_angular_velocity", S::start_rate,
                    "the initial angular velocity in world axes is used in body axes",
                    "convert it to the engine's axes first", start_rate_in_other_frame<Frame::world>),
        fixed_fault("inverted_initial_orientation", S::start_attitude,
                    "the initial orientation is inverted (transposed)", "start from the conjugate quaternion",
                    start_inverted),
        fixed_fault("scalar_last_initial_orientation", S::start_attitude,
                    "the initial orientation is read as scalar-last: w, x, y, z are used as x, y, z, w",
                    "give the components in the engine's order", start_scalar_last),
        fixed_fault("start_without_orientation", S::start_attitude, "the body starts without its initial orientation",
                    "set the initial orientation", start_without_orientation),
        fixed_fault("start_velocity_negated", S::start_position, "the initial velocity has the opposite sign",
                    "negate the initial velocity", start_velocity_factor, -1),
        fixed_fault("start_without_velocity", S::start_position, "the body starts without its initial velocity",
                    "set the initial velocity", start_velocity_factor, 0),
    };
}

std::vector<Hypothesis> formula_faults() {
    using S = Subject;
    constexpr const char* frame = "convert the vector to the axes in which it is used";
    constexpr const char* once = "apply each load once per step";
    std::vector<Hypothesis> all;
    const auto add = [&](const std::string& load, S subject, bool (*scale)(Cause&, double), const std::string& what) {
        all.push_back(fixed_fault(load + "_missing", subject, what + " is missing", "apply it", scale, 0));
        all.push_back(
            fixed_fault(load + "_reversed", subject, what + " has the opposite sign", "negate it", scale, -1));
        all.push_back(fixed_fault(load + "_twice", subject, what + " is applied twice", once, scale, 2));
        all.push_back(scaled_fault(load + "_scaled", subject, what + " is {} times the scene's",
                                   "check its unit and parameters", scale));
    };
    add("formula_torque", S::torque, scale_formulas<true>, "the torque given by a formula");
    add("formula_force", S::force, scale_formulas<false>, "the force given by a formula");
    for (const auto& [subject, load, to_world, to_body] :
         {std::tuple{S::torque, "torque", &formula_in_other_frame<FormulaKind::torque, Frame::body>,
                     &formula_in_other_frame<FormulaKind::torque, Frame::world>},
          std::tuple{S::force, "force", &formula_in_other_frame<FormulaKind::force, Frame::body>,
                     &formula_in_other_frame<FormulaKind::force, Frame::world>}}) {
        const std::string fault = fmt::format("formula_{}_in_other_axes", load);
        all.push_back(fixed_fault(fault, subject,
                                  fmt::format("the {} given by a formula in body axes is applied in world axes", load),
                                  frame, to_world));
        all.push_back(fixed_fault(fault, subject,
                                  fmt::format("the {} given by a formula in world axes is applied in body axes", load),
                                  frame, to_body));
    }
    all.push_back(fixed_fault("formula_held", S::torque,
                              "the formulas are evaluated once per row and held until the next row",
                              "evaluate the formulas in each step", hold_formulas));
    return all;
}

std::vector<Hypothesis> load_faults() {
    using S = Subject;
    const char* const frame = "convert the vector to the axes in which it is used";
    const char* const once = "apply each load once per step";
    return {
        fixed_fault("gravity_reversed", S::gravity, "gravity has the opposite sign", "negate the gravity vector",
                    scale_gravity, -1),
        fixed_fault("gravity_missing", S::gravity, "gravity is missing", "enable the engine's gravity", scale_gravity,
                    0),
        fixed_fault("gravity_twice", S::gravity, "gravity is applied twice", once, scale_gravity, 2),
        fixed_fault("gravity_along_y", S::gravity, "gravity acts along y instead of z", "set the engine's up axis",
                    gravity_along_y),
        fixed_fault("gravity_in_body_axes", S::gravity, "gravity rotates with the body", frame, gravity_in_body_axes),
        scaled_fault("gravity_scaled", S::gravity, "gravity is {} times the scene's",
                     "give the engine the scene's gravity, in its unit of length", scale_gravity),
        fixed_fault("torque_missing", S::torque, "the torque is missing", "apply the torque", scale_vectors<Torque>, 0),
        fixed_fault("torque_reversed", S::torque, "the torque has the opposite sign", "negate the torque",
                    scale_vectors<Torque>, -1),
        fixed_fault("torque_twice", S::torque, "the torque is applied twice", once, scale_vectors<Torque>, 2),
        fixed_fault("torque_in_other_axes", S::torque, "the torque in body axes is applied in world axes", frame,
                    in_other_frame<Torque, Frame::body>),
        fixed_fault("torque_in_other_axes", S::torque, "the torque in world axes is applied in body axes", frame,
                    in_other_frame<Torque, Frame::world>),
        scaled_fault("torque_scaled", S::torque, "the torque is {} times the scene's", "check the torque's unit",
                     scale_vectors<Torque>),
        fixed_fault("force_missing", S::force, "the force is missing", "apply the force", scale_vectors<Force>, 0),
        fixed_fault("force_reversed", S::force, "the force has the opposite sign", "negate the force",
                    scale_vectors<Force>, -1),
        fixed_fault("force_twice", S::force, "the force is applied twice", once, scale_vectors<Force>, 2),
        scaled_fault("force_scaled", S::force, "the force is {} times the scene's", "check the force's unit",
                     scale_vectors<Force>),
        fixed_fault("force_in_other_axes", S::force, "the force in body axes is applied in world axes", frame,
                    in_other_frame<Force, Frame::body>),
        fixed_fault("force_in_other_axes", S::force, "the force in world axes is applied in body axes", frame,
                    in_other_frame<Force, Frame::world>),
        fixed_fault("force_at_center_of_mass", S::force, "the force acts at the centre of mass: its torque is missing",
                    "apply the force at its point", at_center<Force>),
        fixed_fault("force_at_wrong_point", S::force,
                    "the force's point is measured from the centre of mass instead of the body's origin",
                    "measure the point from the body's origin", from_center<Force>),
        fixed_fault("force_at_wrong_point", S::force,
                    "the arm of the force has the opposite sign: the torque is F x r instead of r x F",
                    "use the torque (point - centre of mass) x F", arm_negated<Force>),
        fixed_fault(
            "force_at_wrong_point", S::force,
            "the arm of the force is not rotated with the body: its components in body axes are used in world axes",
            "rotate the arm to world axes before computing r x F", arm_in_world),
        fixed_fault("force_at_wrong_point", S::force,
                    "the force's point is fixed in the body, but is used as fixed in the world",
                    "move the point with the body", point_in_other_frame<Force, Frame::body>),
        fixed_fault("force_at_wrong_point", S::force,
                    "the force's point is fixed in the world, but is used as fixed in the body",
                    "convert the point to body axes in each step", point_in_other_frame<Force, Frame::world>),
        fixed_fault("impulse_missing", S::impulse, "the impulse is missing", "apply the impulse",
                    scale_vectors<Impulse>, 0),
        fixed_fault("impulse_reversed", S::impulse, "the impulse has the opposite sign", "negate the impulse",
                    scale_vectors<Impulse>, -1),
        fixed_fault("impulse_twice", S::impulse, "the impulse is applied twice", "apply the impulse once",
                    scale_vectors<Impulse>, 2),
        scaled_fault("impulse_scaled", S::impulse, "the impulse is {} times the scene's", "check the impulse's unit",
                     scale_vectors<Impulse>),
        fixed_fault("impulse_in_other_axes", S::impulse, "the impulse in body axes is applied in world axes", frame,
                    in_other_frame<Impulse, Frame::body>),
        fixed_fault("impulse_in_other_axes", S::impulse, "the impulse in world axes is applied in body axes", frame,
                    in_other_frame<Impulse, Frame::world>),
        fixed_fault("impulse_at_wrong_point", S::impulse,
                    "the impulse acts at the centre of mass: its angular impulse is missing",
                    "apply the impulse at its point", at_center<Impulse>),
        fixed_fault("impulse_at_wrong_point", S::impulse,
                    "the impulse's point is measured from the centre of mass instead of the body's origin",
                    "measure the point from the body's origin", from_center<Impulse>),
        fixed_fault("impulse_at_wrong_point", S::impulse,
                    "the arm of the impulse has the opposite sign: the angular impulse is J x r instead of r x J",
                    "use the angular impulse (point - centre of mass) x J", arm_negated<Impulse>),
        fixed_fault("spring_missing", S::spring, "the spring is missing", "apply the spring's torque", scale_spring, 0),
        fixed_fault("spring_reversed", S::spring, "the spring's torque has the opposite sign",
                    "use a torque towards the rest orientation", scale_spring, -1),
        fixed_fault("spring_twice", S::spring, "the spring is twice as stiff as the scene's",
                    "use the torque k sin(angle) about the axis", scale_spring, 2),
        scaled_fault("spring_scaled", S::spring, "the spring is {} times as stiff as the scene's",
                     "check the spring's stiffness", scale_spring),
        fixed_fault("spring_in_other_axes", S::spring, "the spring's torque in body axes is applied in world axes",
                    frame, spring_in_other_axes<TorqueAxes::body_in_world>),
        fixed_fault("spring_in_other_axes", S::spring, "the spring's torque in world axes is applied in body axes",
                    frame, spring_in_other_axes<TorqueAxes::world_in_body>),
        fixed_fault("drag_missing", S::drag, "the scene's drag is missing", "apply the scene's drag", scale_drag, 0),
        fixed_fault("drag_twice", S::drag, "the scene's drag is applied twice", once, scale_drag, 2),
        fixed_fault("drag_reversed", S::drag, "the scene's drag has the opposite sign", "apply drag against the motion",
                    scale_drag, -1),
        fixed_fault("drag_in_other_axes", S::drag, "the drag coefficients in body axes are used in world axes",
                    "use the torque -R C R^T w", drag_in_world),
        fitted_fault(
            "drag_per_step", S::drag,
            "the scene's drag is applied per step instead of per second: it is {} times too strong",
            "multiply the drag by the step", [](Cause& c, double x) { return is_plain(x) && scale_drag(c, x); },
            steps_per_second),
        scaled_fault("drag_scaled", S::drag, "the drag is {} times the scene's", "check the drag coefficient",
                     scale_drag),
        fixed_fault("loads_missing", S::torque, "torque and spring are missing", "apply the torque and the spring",
                    scale_all_torques, 0),
    };
}

}  // namespace

// Of equally good explanations, the first in this table is reported first: a wrong load before a wrong mass.
const std::vector<Hypothesis>& known_faults() {
    static const std::vector<Hypothesis> all = [] {
        std::vector<Hypothesis> list;
        for (auto&& part :
             {readings(), engine_faults(), load_faults(), formula_faults(), body_faults(), start_faults()})
            list.insert(list.end(), part.begin(), part.end());
        return list;
    }();
    return all;
}

}  // namespace polhode
