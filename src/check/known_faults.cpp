// The faults that engines and their files are known to have. Adding one is adding a row.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "body/elementary.h"
#include "body/fast_principal_frame.h"
#include "body/mass_properties.h"
#include "body/rigid_body.h"
#include "check/hypothesis.h"

namespace polhode {
namespace {

using Vector = Vector3<double>;
using Matrix = Matrix3<double>;

constexpr double degree = std::numbers::pi / 180;
constexpr double revolution_per_minute = std::numbers::pi / 30;
constexpr double inch = 0.0254;

// Changes of the cause: each says whether it means anything there.

auto read_as(void (*change)(Reading&)) {
    return [change](Cause& c, double) {
        change(c.reading);
        return true;
    };
}
auto engine_does(void (*change)(EngineFault&, double)) {
    return [change](Cause& c, double x) {
        change(c.engine, x);
        return true;
    };
}

// Whether the body is round enough that a change of its tensor's axes changes nothing.
bool same_tensor(const Matrix& a, const Matrix& b) {
    double change = 0, scale = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            change = std::max(change, std::abs(a[i][j] - b[i][j])), scale = std::max(scale, std::abs(a[i][j]));
    return change <= 1e-6 * scale;
}

bool give_tensor(Cause& c, const Matrix& tensor) {
    if (same_tensor(c.scene.body.inertia_B, tensor)) return false;
    // no body could have it: the engine is not asked, since products of inertia alone can make it impossible
    c.scene.body.inertia_B = tensor;
    return true;
}

// rows and columns taken in another order
template <int a, int b, int c>
bool permute_axes(Cause& cause, double) {
    constexpr std::array order{a, b, c};
    const Matrix I = cause.scene.body.inertia_B;
    Matrix permuted;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            permuted[i][j] = I[order[static_cast<std::size_t>(i)]][order[static_cast<std::size_t>(j)]];
    return give_tensor(cause, permuted);
}

bool change_products(Cause& c, double factor) {
    Matrix I = c.scene.body.inertia_B;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (i != j) I[i][j] *= factor;
    return give_tensor(c, I);
}

bool drop_products(Cause& c, double) { return change_products(c, 0); }
bool reverse_products(Cause& c, double) { return change_products(c, -1); }

// R^T D R where R D R^T is right: R maps principal axes to body axes
bool transpose_principal_frame(Cause& c, double) {
    const PrincipalFrame frame = fast_principal_frame(c.scene.body.inertia_B);
    const Matrix R = rotation_matrix(frame.q_BP);
    return give_tensor(c, transposed(R) * diagonal(frame.moments) * R);
}

// the moments of the principal axes used as if those were the body's
bool forget_principal_frame(Cause& c, double) {
    return give_tensor(c, diagonal(fast_principal_frame(c.scene.body.inertia_B).moments));
}

bool mean_moment(Cause& c, double) {
    const Matrix& I = c.scene.body.inertia_B;
    const double mean = (I[0][0] + I[1][1] + I[2][2]) / 3;
    return give_tensor(c, diagonal(Vector(mean, mean, mean)));
}

// Whether a torque acts that does not come from the body's own mass.
bool has_load(const Scene& scene, auto&& is) { return std::any_of(scene.loads.begin(), scene.loads.end(), is); }
template <class T>
bool has(const Scene& scene) {
    return has_load(scene, [](const Load& load) { return std::holds_alternative<T>(load); });
}
template <class T>
void each(Scene& scene, auto&& change) {
    for (Load& load : scene.loads)
        if (T* one = std::get_if<T>(&load)) change(*one);
}

// Only where a torque stands against the moments does their size matter.
bool torque_matters(const Scene& scene) {
    return has<Torque>(scene) || has<Force>(scene) || has<Impulse>(scene) || has<Spring>(scene) ||
           has_load(scene,
                    [](const Load& load) {
                        const Drag* drag = std::get_if<Drag>(&load);
                        return drag && length(drag->rotational) > 0;
                    }) ||
           (has<Gravity>(scene) && scene.pivot);
}

bool scale_inertia(Cause& c, double factor) {
    if (!torque_matters(c.scene)) return false;
    for (Vector& row : c.scene.body.inertia_B.row) row = factor * row;
    return true;
}

bool mass_matters(const Scene& scene) {
    return has<Force>(scene) || has<Impulse>(scene) || has<Drag>(scene) || (scene.pivot && has<Gravity>(scene));
}
bool scale_mass(Cause& c, double factor) {
    if (!mass_matters(c.scene)) return false;
    c.scene.body.mass *= factor;
    return true;
}
// density or unit of mass: both at once
bool scale_density(Cause& c, double factor) {
    const bool mass = scale_mass(c, factor);
    return scale_inertia(c, factor) || mass;
}

bool center_at_origin(Cause& c, double) {
    Body& body = c.scene.body;
    if (!(length(body.center_of_mass) > 0)) return false;
    body.center_of_mass = {};
    return true;
}
bool inertia_about_origin(Cause& c, double) {
    Body& body = c.scene.body;
    if (!c.scene.pivot || length(*c.scene.pivot) != 0 || !(length(body.center_of_mass) > 0)) return false;
    body.inertia_B = body.inertia_B + parallel_axis(body.mass, body.center_of_mass);
    body.center_of_mass = {};
    return true;
}
// the tensor about the centre of mass used about the pivot
bool no_parallel_axis(Cause& c, double) {
    Body& body = c.scene.body;
    const Vector arm = body.center_of_mass - c.scene.pivot.value_or(body.center_of_mass);
    if (!(length(arm) > 0)) return false;
    body.inertia_B = body.inertia_B + parallel_axis(-body.mass, arm);
    return true;
}
// the tensor about the pivot given as the one about the centre of mass: shifted twice
bool parallel_axis_twice(Cause& c, double) {
    Body& body = c.scene.body;
    const Vector arm = body.center_of_mass - c.scene.pivot.value_or(body.center_of_mass);
    if (!(length(arm) > 0)) return false;
    body.inertia_B = body.inertia_B + parallel_axis(body.mass, arm);
    return true;
}

bool scale_start_rate(Cause& c, double factor) {
    if (!(length(c.scene.initial.angular_velocity) > 0)) return false;
    c.scene.initial.angular_velocity = factor * c.scene.initial.angular_velocity;
    return true;
}
template <Frame written>
bool start_rate_in_other_frame(Cause& c, double) {
    Initial& start = c.scene.initial;
    const Quaternion<double> q = normalized(start.orientation);
    if (start.angular_velocity_frame != written || !(length(start.angular_velocity) > 0) ||
        length(rotate(q, start.angular_velocity) - start.angular_velocity) < 1e-6 * length(start.angular_velocity))
        return false;
    start.angular_velocity_frame = written == Frame::body ? Frame::world : Frame::body;
    return true;
}
bool start_inverted(Cause& c, double) {
    Initial& start = c.scene.initial;
    if (length(vector_part(start.orientation)) < 1e-6) return false;
    start.orientation = conjugate(start.orientation);
    return true;
}
bool start_scalar_last(Cause& c, double) {
    const Quaternion<double> q = c.scene.initial.orientation;
    c.scene.initial.orientation = {q.z, q.w, q.x, q.y};
    return true;
}
bool start_without_turn(Cause& c, double) {
    if (length(vector_part(c.scene.initial.orientation)) < 1e-6) return false;
    c.scene.initial.orientation = {};
    return true;
}
bool start_without_rate(Cause& c, double) { return scale_start_rate(c, 0); }
bool start_velocity_factor(Cause& c, double factor) {
    if (c.scene.pivot || !(length(c.scene.initial.velocity_W) > 0)) return false;
    c.scene.initial.velocity_W = factor * c.scene.initial.velocity_W;
    return true;
}

bool scale_gravity(Cause& c, double factor) {
    if (!has<Gravity>(c.scene) || (c.scene.pivot && !(length(c.scene.body.center_of_mass - *c.scene.pivot) > 0)))
        return false;
    each<Gravity>(c.scene, [&](Gravity& g) { g.acceleration_W = factor * g.acceleration_W; });
    return true;
}
bool gravity_along_y(Cause& c, double) {
    bool along_z = false;
    each<Gravity>(c.scene, [&](Gravity& g) {
        along_z = along_z || g.acceleration_W[2] != 0;
        g.acceleration_W = {g.acceleration_W[0], g.acceleration_W[2], g.acceleration_W[1]};
    });
    return along_z;
}

bool scale_torque(Cause& c, double factor) {
    each<Torque>(c.scene, [&](Torque& t) { t.vector = factor * t.vector; });
    return has<Torque>(c.scene);
}
template <Frame written>
bool torque_in_other_frame(Cause& c, double) {
    bool any = false;
    each<Torque>(c.scene, [&](Torque& t) {
        if (t.frame == written) any = true, t.frame = written == Frame::body ? Frame::world : Frame::body;
    });
    return any;
}
bool scale_force(Cause& c, double factor) {
    each<Force>(c.scene, [&](Force& f) { f.vector = factor * f.vector; });
    return has<Force>(c.scene);
}
template <Frame written>
bool force_in_other_frame(Cause& c, double) {
    bool any = false;
    each<Force>(c.scene, [&](Force& f) {
        if (f.frame == written) any = true, f.frame = written == Frame::body ? Frame::world : Frame::body;
    });
    return any;
}
bool force_at_center(Cause& c, double) {
    bool any = false;
    const Vector center = c.scene.body.center_of_mass;
    each<Force>(c.scene, [&](Force& f) {
        if (f.point_frame == Frame::body && length(f.point - center) > 0) any = true, f.point = center;
    });
    return any && !c.scene.pivot;
}
bool scale_impulse(Cause& c, double factor) {
    each<Impulse>(c.scene, [&](Impulse& i) { i.vector = factor * i.vector; });
    return has<Impulse>(c.scene);
}
bool impulse_at_center(Cause& c, double) {
    bool any = false;
    const Vector center = c.scene.body.center_of_mass;
    each<Impulse>(c.scene, [&](Impulse& i) {
        if (i.point_frame == Frame::body && length(i.point - center) > 0) any = true, i.point = center;
    });
    return any && !c.scene.pivot;
}
bool impulse_from_center(Cause& c, double) {
    bool any = false;
    const Vector center = c.scene.body.center_of_mass;
    each<Impulse>(c.scene, [&](Impulse& i) {
        if (i.point_frame == Frame::body && length(center) > 0) any = true, i.point = i.point + center;
    });
    return any;
}
bool scale_spring(Cause& c, double factor) {
    each<Spring>(c.scene, [&](Spring& s) { s.stiffness *= factor; });
    return has<Spring>(c.scene);
}
bool scale_drag(Cause& c, double factor) {
    each<Drag>(c.scene, [&](Drag& d) { d.rotational = factor * d.rotational, d.translational *= factor; });
    return has<Drag>(c.scene);
}
bool scale_all_torques(Cause& c, double factor) {
    const bool torque = scale_torque(c, factor), spring = scale_spring(c, factor);
    return torque && spring;
}

// A fault of one number, known beforehand.
Hypothesis fixed(std::string fault, Subject subject, std::string what, std::string remedy,
                 bool (*apply)(Cause&, double), double x = 1) {
    return {.fault = std::move(fault),
            .subject = subject,
            .what = std::move(what),
            .remedy = std::move(remedy),
            .apply = [apply, x](Cause& c, double) { return apply(c, x); }};
}

Hypothesis reading(std::string fault, Subject subject, std::string what, std::string remedy, void (*change)(Reading&),
                   std::string convention = "") {
    return {.fault = std::move(fault),
            .subject = subject,
            .what = std::move(what),
            .remedy = std::move(remedy),
            .apply = read_as(change),
            .convention = std::move(convention)};
}

Hypothesis engine(std::string fault, Subject subject, std::string what, std::string remedy,
                  void (*change)(EngineFault&, double)) {
    return {.fault = std::move(fault),
            .subject = subject,
            .what = std::move(what),
            .remedy = std::move(remedy),
            .apply = engine_does(change)};
}

// a factor so near to 1 is a method's own error
bool is_plain(double factor) { return std::abs(std::log(factor)) > 0.02; }

// so many values from one to another, evenly in their logarithms
std::vector<double> logarithmic(double from, double to, int count) {
    std::vector<double> values;
    for (int i = 0; i <= count; ++i) values.push_back(from * std::pow(to / from, static_cast<double>(i) / count));
    return values;
}

std::vector<double> factors(const FileFacts&) { return logarithmic(0.05, 20, 40); }
// rates at which something dies away during a run, or within a step
std::vector<double> damping_rates(const FileFacts& facts) {
    return logarithmic(3e-3 / std::max(facts.duration, 1e-9), 0.5 / std::max(facts.row, 1e-12), 48);
}
std::vector<double> time_factors(const FileFacts&) { return logarithmic(0.2, 5, 60); }
// A limit shows in most rows, or in the fastest.
std::vector<double> speed_limits(const FileFacts& facts) {
    std::vector<double> values;
    for (const double rate : {facts.usual_rate, facts.largest_rate})
        for (const double factor : {0.98, 0.99, 1.0, 1.01, 1.02}) values.push_back(factor * rate);
    std::sort(values.begin(), values.end());
    return values;
}

// A factor of something in the scene.
Hypothesis scaled(std::string fault, Subject subject, std::string what, std::string remedy,
                  bool (*apply)(Cause&, double)) {
    return {.fault = std::move(fault),
            .subject = subject,
            .what = std::move(what),
            .remedy = std::move(remedy),
            .apply = [apply](Cause& c, double x) { return is_plain(x) && apply(c, x); },
            .values = factors};
}

Hypothesis fitted(std::string fault, Subject subject, std::string what, std::string remedy,
                  std::function<bool(Cause&, double)> apply, std::vector<double> (*values)(const FileFacts&)) {
    return {.fault = std::move(fault),
            .subject = subject,
            .what = std::move(what),
            .remedy = std::move(remedy),
            .apply = std::move(apply),
            .values = values};
}

// what the columns name is the other of the two points
bool read_other_point(Cause& c, bool origin) {
    if (c.reading.origin != origin || !(length(c.scene.body.center_of_mass) > 0)) return false;
    c.reading.origin = !origin;
    return true;
}

std::vector<Hypothesis> readings() {
    using S = Subject;
    std::vector<Hypothesis> all{
        reading(
            "scalar_last_quaternion", S::quaternion,
            "the quaternion is scalar-last: the columns qw,qx,qy,qz hold x, y, z, w", "give --convention scalar-last",
            [](Reading& r) { r.scalar_last = true; }, "scalar-last"),
        reading("inverted_orientation", S::quaternion, "the attitude is inverted (transposed): it maps world to body",
                "write the conjugate quaternion", [](Reading& r) { r.inverted = true; }),
        reading("scalar_last_and_inverted", S::quaternion,
                "the quaternion is scalar-last and inverted: the columns hold x, y, z, w of the map from world to body",
                "write the conjugate, and give --convention scalar-last",
                [](Reading& r) { r.scalar_last = true, r.inverted = true; }),
        reading(
            "other_axes", S::axes, "the file is written y-up, right-handed", "give --convention y-up",
            [](Reading& r) { r.axes = Axes::y_up_right; }, "y-up"),
        reading(
            "other_axes", S::axes, "the file is written y-up, left-handed", "give --convention y-up,left-handed",
            [](Reading& r) { r.axes = Axes::y_up_left; }, "y-up,left-handed"),
        reading(
            "other_axes", S::axes, "the file is written z-up, left-handed", "give --convention left-handed",
            [](Reading& r) { r.axes = Axes::z_up_left; }, "left-handed"),
        reading(
            "angular_velocity_in_body_axes", S::rate_columns, "wx,wy,wz are in body axes",
            "write them in world axes, or give --convention body-rates", [](Reading& r) { r.rate_in_body = true; },
            "body-rates"),
        reading(
            "angular_velocity_in_degrees", S::rate_columns, "wx,wy,wz are in degrees per second",
            "write radians per second, or give --convention degrees", [](Reading& r) { r.rate_unit = degree; },
            "degrees"),
        reading("angular_velocity_in_rpm", S::rate_columns, "wx,wy,wz are in revolutions per minute",
                "write radians per second", [](Reading& r) { r.rate_unit = revolution_per_minute; }),
        reading("angular_velocity_in_revolutions", S::rate_columns, "wx,wy,wz are in revolutions per second",
                "write radians per second", [](Reading& r) { r.rate_unit = 2 * std::numbers::pi; }),
        reading("angular_velocity_negated", S::rate_columns, "wx,wy,wz have the opposite sign",
                "turn the sign of the angular velocity", [](Reading& r) { r.rate_unit = -1; }),
        reading(
            "angular_velocity_in_degrees_and_body_axes", S::rate_columns,
            "wx,wy,wz are in degrees per second and in body axes", "write radians per second, in world axes",
            [](Reading& r) { r.rate_unit = degree, r.rate_in_body = true; }, "degrees,body-rates"),
        reading("angular_velocity_in_rpm_and_body_axes", S::rate_columns,
                "wx,wy,wz are in revolutions per minute and in body axes", "write radians per second, in world axes",
                [](Reading& r) { r.rate_unit = revolution_per_minute, r.rate_in_body = true; }),
        reading("angular_velocity_negated_and_in_body_axes", S::rate_columns,
                "wx,wy,wz have the opposite sign and are in body axes", "turn their sign, and write them in world axes",
                [](Reading& r) { r.rate_unit = -1, r.rate_in_body = true; }),
        reading(
            "lengths_in_centimetres", S::lengths, "positions and velocities are in centimetres",
            "write metres, or give --convention centimetres", [](Reading& r) { r.length_unit = 0.01; }, "centimetres"),
        reading(
            "lengths_in_millimetres", S::lengths, "positions and velocities are in millimetres",
            "write metres, or give --convention millimetres", [](Reading& r) { r.length_unit = 0.001; }, "millimetres"),
        reading(
            "lengths_in_inches", S::lengths, "positions and velocities are in inches",
            "write metres, or give --convention inches", [](Reading& r) { r.length_unit = inch; }, "inches"),
        reading(
            "lengths_in_feet", S::lengths, "positions and velocities are in feet",
            "write metres, or give --convention feet", [](Reading& r) { r.length_unit = 12 * inch; }, "feet"),
        reading("positions_in_centimetres", S::lengths, "positions are in centimetres, velocities are not",
                "write metres", [](Reading& r) { r.position_unit = 0.01; }),
        reading("velocities_in_centimetres", S::lengths, "velocities are in centimetres per second, positions are not",
                "write metres per second", [](Reading& r) { r.velocity_unit = 0.01; }),
        reading("velocity_negated", S::lengths, "vx,vy,vz have the opposite sign", "turn the sign of the velocity",
                [](Reading& r) { r.velocity_unit = -1; }),
        reading(
            "one_row_late", S::rows,
            "each row shows the state of the row before: the file is written before the step, or from the last frame",
            "write a row's state after its step", [](Reading& r) { r.rows_late = 1; }),
        reading("one_row_early", S::rows, "each row shows the state of the row that follows: the first step is missing",
                "write the start as the first row, or let the times begin one step later",
                [](Reading& r) { r.rows_late = -1; }),
    };
    all.push_back({.fault = "origin_for_center_of_mass",
                   .subject = S::point,
                   .what = "the position is the body's origin, not its centre of mass",
                   .remedy = "name the columns ox,oy,oz, or write the centre of mass",
                   .apply = [](Cause& c, double) { return read_other_point(c, false); }});
    all.push_back({.fault = "center_of_mass_for_origin",
                   .subject = S::point,
                   .what = "ox,oy,oz are the centre of mass, not the body's origin",
                   .remedy = "name the columns px,py,pz",
                   .apply = [](Cause& c, double) { return read_other_point(c, true); }});
    return all;
}

std::vector<Hypothesis> engine_faults() {
    using S = Subject;
    return {
        engine("gyroscopic_term_missing", S::gyroscopic, "the gyroscopic term is missing",
               "turn the engine's gyroscopic term on", [](EngineFault& e, double) { e.gyroscopic = 0; }),
        engine("gyroscopic_term_reversed", S::gyroscopic, "the gyroscopic term has the wrong sign",
               "let I dw/dt = tau - w x I w", [](EngineFault& e, double) { e.gyroscopic = -1; }),
        engine("attitude_turned_at_half_rate", S::turn, "the attitude turns at half the rate that w says",
               "let dq/dt = 1/2 w q, with the half once", [](EngineFault& e, double) { e.turn = 0.5; }),
        engine("attitude_turned_at_twice_the_rate", S::turn, "the attitude turns at twice the rate that w says",
               "let dq/dt = 1/2 w q: the half is missing", [](EngineFault& e, double) { e.turn = 2; }),
        engine("attitude_turned_backwards", S::turn, "the attitude turns against w",
               "turn the sign of the rate in the quaternion's update", [](EngineFault& e, double) { e.turn = -1; }),
        engine("body_rate_multiplied_on_the_left", S::turn,
               "the attitude is turned by the rate in body axes on the world's side: w q in place of q w",
               "let q go on as q w for a rate in body axes",
               [](EngineFault& e, double) { e.turned_by = TurnedBy::body_rate_in_world; }),
        engine("world_rate_multiplied_on_the_right", S::turn,
               "the attitude is turned by the rate in world axes on the body's side: q w in place of w q",
               "let q go on as w q for a rate in world axes",
               [](EngineFault& e, double) { e.turned_by = TurnedBy::world_rate_in_body; }),
        engine("rotation_frozen", S::rest, "the attitude never changes", "integrate the attitude, or wake the body up",
               [](EngineFault& e, double) { e.no_rotation = true; }),
        {.fault = "position_frozen",
         .subject = S::rest,
         .what = "the position never changes",
         .remedy = "integrate the position",
         .apply =
             [](Cause& c, double) {
                 c.engine.no_translation = true;
                 return !c.scene.pivot;
             }},
        fitted("speed_clamped", S::limit, "the angular speed is clamped at {} rad/s",
               "raise the engine's limit on angular speed",
               engine_does([](EngineFault& e, double x) { e.speed_limit = x; }), speed_limits),
        fitted("damping_left_on", S::damping, "damping is left on: w dies away at {} 1/s more than in the scene",
               "turn the engine's angular damping off",
               engine_does([](EngineFault& e, double x) { e.angular_damping = x; }), damping_rates),
        fitted(
            "linear_damping_left_on", S::linear_damping,
            "linear damping is left on: v dies away at {} 1/s more than in the scene",
            "turn the engine's linear damping off",
            [](Cause& c, double x) {
                c.engine.linear_damping = x;
                return !c.scene.pivot;
            },
            damping_rates),
        {.fault = "damping_left_on",
         .subject = S::damping,
         .what = "damping is left on: w and v die away at {} 1/s more than in the scene",
         .remedy = "turn the engine's damping off",
         .apply =
             [](Cause& c, double x) {
                 c.engine.angular_damping = c.engine.linear_damping = x;
                 return !c.scene.pivot;
             },
         .values = damping_rates},
        fitted(
            "wrong_time_step", S::time, "time runs at {} times its rate: a wrong step",
            "give the step in s, and as many of them as the clock says",
            [](Cause& c, double x) {
                c.engine.time = x;
                return is_plain(x);
            },
            time_factors),
    };
}

std::vector<Hypothesis> body_faults() {
    using S = Subject;
    const char* const order = "give the moments in the order of the body's own axes";
    return {
        fixed("inertia_axes_permuted", S::inertia, "the moments of inertia of x and y are exchanged", order,
              permute_axes<1, 0, 2>),
        fixed("inertia_axes_permuted", S::inertia, "the moments of inertia of y and z are exchanged", order,
              permute_axes<0, 2, 1>),
        fixed("inertia_axes_permuted", S::inertia, "the moments of inertia of x and z are exchanged", order,
              permute_axes<2, 1, 0>),
        fixed("inertia_axes_permuted", S::inertia, "the moments of inertia stand in the order y, z, x", order,
              permute_axes<1, 2, 0>),
        fixed("inertia_axes_permuted", S::inertia, "the moments of inertia stand in the order z, x, y", order,
              permute_axes<2, 0, 1>),
        fixed("products_of_inertia_dropped", S::inertia, "the products of inertia are dropped",
              "give the engine the full tensor, or its principal axes", drop_products),
        fixed("products_of_inertia_reversed", S::inertia,
              "the products of inertia have the opposite sign: int xy dm stands where -int xy dm belongs",
              "turn the sign of the tensor's off-diagonal elements", reverse_products),
        fixed("principal_frame_transposed", S::inertia, "the rotation to the principal axes is transposed",
              "let I = R D R^T where R maps principal axes to body axes", transpose_principal_frame),
        fixed(
            "principal_frame_forgotten", S::inertia,
            "the principal moments are used about the body's own axes: the rotation to the principal axes is left out",
            "give the engine the rotation to the principal axes", forget_principal_frame),
        fixed("inertia_taken_for_a_ball", S::inertia, "one mean moment of inertia is used about all axes",
              "give the engine the tensor", mean_moment),
        fixed("center_of_mass_for_origin", S::center_of_mass,
              "the centre of mass is taken for the body's origin: arms and pivot are counted from there",
              "give the engine the body's centre of mass", center_at_origin),
        fixed("center_of_mass_for_origin", S::center_of_mass,
              "forces act as if the centre of mass were the body's origin: the inertia alone knows where it is",
              "give the engine the body's centre of mass", inertia_about_origin),
        fixed("inertia_not_shifted_to_pivot", S::inertia,
              "the tensor about the centre of mass is used about the pivot: m (r.r 1 - r r^T) is missing",
              "add the parallel-axis term", no_parallel_axis),
        fixed("inertia_shifted_twice", S::inertia, "the tensor is shifted to the pivot twice",
              "add the parallel-axis term once", parallel_axis_twice),
        scaled("inertia_scaled", S::mass, "the moments of inertia are {} times what they should be",
               "check the unit of length and the density that the tensor is made with", scale_inertia),
        scaled("mass_scaled", S::mass, "the mass is {} times what it should be", "check the mass, or the density",
               scale_mass),
        scaled("density_scaled", S::mass, "mass and moments of inertia are {} times what they should be",
               "check the density, or the unit of mass", scale_density),
    };
}

std::vector<Hypothesis> start_faults() {
    using S = Subject;
    const char* const unit = "start the engine in its own unit";
    return {
        fixed("degrees_for_radians", S::start_rate, "the initial angular velocity is taken for degrees per second",
              unit, scale_start_rate, degree),
        fixed("degrees_for_radians", S::start_rate,
              "the initial angular velocity in rad/s is converted from degrees once too often", unit, scale_start_rate,
              1 / degree),
        fixed("rpm_for_radians", S::start_rate, "the initial angular velocity is taken for revolutions per minute",
              unit, scale_start_rate, revolution_per_minute),
        fixed("rpm_for_radians", S::start_rate,
              "the initial angular velocity in rad/s is converted from revolutions per minute once too often", unit,
              scale_start_rate, 1 / revolution_per_minute),
        fixed("start_rate_negated", S::start_rate, "the initial angular velocity has the opposite sign",
              "turn the sign of the initial angular velocity", scale_start_rate, -1),
        fixed("start_without_rate", S::start_rate, "the body starts without its angular velocity",
              "set the initial angular velocity", start_without_rate),
        fixed("body_for_world_angular_velocity", S::start_rate, "the initial angular velocity is taken in world axes",
              "turn it into the engine's axes first", start_rate_in_other_frame<Frame::body>),
        fixed("body_for_world_angular_velocity", S::start_rate, "the initial angular velocity is taken in body axes",
              "turn it into the engine's axes first", start_rate_in_other_frame<Frame::world>),
        fixed("inverted_initial_orientation", S::start_attitude, "the initial orientation is inverted (transposed)",
              "start from the conjugate", start_inverted),
        fixed("scalar_last_initial_orientation", S::start_attitude,
              "the initial orientation is read scalar-last: w, x, y, z taken for x, y, z, w",
              "give the engine the components in its own order", start_scalar_last),
        fixed("start_without_orientation", S::start_attitude, "the body starts without its initial orientation",
              "set the initial orientation", start_without_turn),
        fixed("start_velocity_negated", S::start_position, "the initial velocity has the opposite sign",
              "turn the sign of the initial velocity", start_velocity_factor, -1),
        fixed("start_without_velocity", S::start_position, "the body starts without its velocity",
              "set the initial velocity", start_velocity_factor, 0),
    };
}

std::vector<Hypothesis> load_faults() {
    using S = Subject;
    const char* const frame = "turn the vector into the axes that it is used in";
    const char* const once = "apply each load once a step";
    return {
        fixed("gravity_reversed", S::gravity, "gravity has the opposite sign", "let it point down", scale_gravity, -1),
        fixed("gravity_missing", S::gravity, "gravity is missing", "turn the engine's gravity on", scale_gravity, 0),
        fixed("gravity_twice", S::gravity, "gravity is applied twice", once, scale_gravity, 2),
        fixed("gravity_along_y", S::gravity, "gravity acts along y in place of z", "set the engine's up axis",
              gravity_along_y),
        scaled("gravity_scaled", S::gravity, "gravity is {} times the scene's",
               "give the engine the scene's gravity, in its unit of length", scale_gravity),
        fixed("torque_missing", S::torque, "the torque is missing", "apply the torque", scale_torque, 0),
        fixed("torque_reversed", S::torque, "the torque has the opposite sign", "turn the torque's sign", scale_torque,
              -1),
        fixed("torque_twice", S::torque, "the torque is applied twice", once, scale_torque, 2),
        fixed("torque_in_other_axes", S::torque, "the torque in body axes is applied in world axes", frame,
              torque_in_other_frame<Frame::body>),
        fixed("torque_in_other_axes", S::torque, "the torque in world axes is applied in body axes", frame,
              torque_in_other_frame<Frame::world>),
        scaled("torque_scaled", S::torque, "the torque is {} times the scene's", "check the torque's unit",
               scale_torque),
        fixed("force_missing", S::force, "the force is missing", "apply the force", scale_force, 0),
        fixed("force_reversed", S::force, "the force has the opposite sign", "turn the force's sign", scale_force, -1),
        fixed("force_in_other_axes", S::force, "the force in body axes is applied in world axes", frame,
              force_in_other_frame<Frame::body>),
        fixed("force_in_other_axes", S::force, "the force in world axes is applied in body axes", frame,
              force_in_other_frame<Frame::world>),
        fixed("force_at_center_of_mass", S::force, "the force acts at the centre of mass: its torque is missing",
              "apply the force at its point", force_at_center),
        fixed("impulse_missing", S::impulse, "the impulse is missing", "apply the impulse", scale_impulse, 0),
        fixed("impulse_reversed", S::impulse, "the impulse has the opposite sign", "turn the impulse's sign",
              scale_impulse, -1),
        fixed("impulse_twice", S::impulse, "the impulse is applied twice", "apply the impulse once", scale_impulse, 2),
        fixed("impulse_at_wrong_point", S::impulse, "the impulse acts at the centre of mass: its turn is missing",
              "apply the impulse at its point", impulse_at_center),
        fixed("impulse_at_wrong_point", S::impulse,
              "the impulse's point is counted from the centre of mass in place of the body's origin",
              "count the point from the body's origin", impulse_from_center),
        fixed("spring_missing", S::spring, "the spring is missing", "apply the spring's torque", scale_spring, 0),
        fixed("spring_reversed", S::spring, "the spring's torque has the opposite sign",
              "let the torque drive the body back to rest", scale_spring, -1),
        fixed("spring_twice", S::spring, "the spring is twice as stiff as the scene's",
              "let the torque be k sin(angle) about the axis", scale_spring, 2),
        scaled("spring_scaled", S::spring, "the spring is {} times as stiff as the scene's", "check the stiffness",
               scale_spring),
        fixed("drag_missing", S::drag, "the scene's drag is missing", "apply the scene's drag", scale_drag, 0),
        fixed("drag_twice", S::drag, "the scene's drag is applied twice", once, scale_drag, 2),
        fixed("drag_reversed", S::drag, "the scene's drag has the opposite sign", "let drag act against the motion",
              scale_drag, -1),
        scaled("drag_scaled", S::drag, "the drag is {} times the scene's", "check the drag coefficient", scale_drag),
        fixed("loads_missing", S::torque, "torque and spring are missing", "apply them", scale_all_torques, 0),
    };
}

}  // namespace

const std::vector<Hypothesis>& known_faults() {
    static const std::vector<Hypothesis> all = [] {
        std::vector<Hypothesis> list;
        for (auto&& part : {readings(), engine_faults(), body_faults(), start_faults(), load_faults()})
            list.insert(list.end(), part.begin(), part.end());
        return list;
    }();
    return all;
}

}  // namespace polhode
