#include "check/hypotheses.h"

#include <fmt/format.h>

#include <numbers>

#include "body/orientation.h"
#include "check/convention.h"
#include "check/engine_faults.h"
#include "motion/exact_body.h"

namespace polhode {
namespace {

constexpr double degree = std::numbers::pi / 180;

using Explained = std::optional<Explanation>;

// w in other units or axes, beside the scene's motion
struct WrittenRate {
    const char* fault;
    double unit;
    bool in_body;
    const char *what, *remedy, *convention;
};

Hypothesis written_rate(const WrittenRate& w) {
    return {w.fault, About::rate, alike, false, [w](const ComparedRows& rows) -> Explained {
                const double scale = rows.largest_own_rate();
                if (!rows.file().has_angular_velocity || scale == 0) return {};
                const auto error = [&](double unit, bool in_body) {
                    return root_mean_square(
                               rows.size(),
                               [&](std::size_t k) {
                                   const Sample& own = rows.own()[k];
                                   const Vector3<double> rate = unit * rows.row(k).angular_velocity_W;
                                   return length(rate - (in_body ? own.angular_velocity_B : world_rate(own)));
                               }) /
                           scale;
                };
                const double as_written = error(1, false), explained = error(w.unit, w.in_body);
                // a rate many times too large is made small by any smaller unit
                if (as_written < plain_error || !(explained < 1 / alike)) return {};
                return Explanation{as_written, explained, w.what, w.remedy, w.convention};
            }};
}

// The position columns hold the other of the body's origin and its centre of mass.
Hypothesis written_position(const char* fault, bool origin, const char* what, const char* remedy) {
    return {fault, About::position, alike, false, [=](const ComparedRows& rows) -> Explained {
                const Vector3<double>& center = rows.scene().body.center_of_mass;
                if (!(origin ? rows.file().has_origin : rows.file().has_position) || length(center) == 0) return {};
                // sense: the factor of R center that is added to the column to reach the centre of mass
                const auto error = [&](double sense) {
                    return root_mean_square(rows.size(), [&](std::size_t k) {
                        const Sample& own = rows.own()[k];
                        const Vector3<double> arm = (sense / squared_norm(own.q)) * rotate(own.q, center);
                        return length(rows.row(k).position_W + arm - own.position_W);
                    });
                };
                const double as_written = error(origin ? 1 : 0);
                if (as_written < plain_error * length(center)) return {};
                return Explanation{as_written, error(origin ? 0 : 1), what, remedy};
            }};
}

struct Reading {
    Axes axes = Axes::z_up_right;
    bool scalar_last = false, inverse = false;

    const char* fault() const {
        return axes != Axes::z_up_right ? "other_axes"
               : scalar_last            ? "scalar_last_quaternion"
                                        : "inverted_orientation";
    }
};

// The file's quaternions read in other ways: of equals the one that changes least. One that is told under another word
// than `fault` is that one's.
Explained other_reading(const ComparedRows& rows, const std::string& fault) {
    const std::vector<Sample>& own = rows.own();
    const auto read = [](const Reading& reading, const Quaternion<double>& q) {
        Quaternion<double> r = reading.scalar_last ? Quaternion<double>{q.z, q.w, q.x, q.y} : q;
        if (reading.inverse) r = conjugate(r);
        return quaternion_from(reading.axes, r);
    };
    std::optional<Reading> best;
    double least_error = rows.error() / alike;
    for (const bool inverse : {false, true})
        for (const Axes axes : {Axes::z_up_right, Axes::y_up_right, Axes::y_up_left, Axes::z_up_left})
            for (const bool scalar_last : {false, true}) {
                const Reading reading{axes, scalar_last, inverse};
                const double error = root_mean_square(own.size(), [&](std::size_t k) {
                    return rotation_angle_between(own[k].q, read(reading, rows.row(k).q));
                });
                const bool changes = inverse || scalar_last || axes != Axes::z_up_right;
                if (changes && error < (best ? least_error / 2 : least_error)) best = reading, least_error = error;
            }
    if (!best) return {};
    Convention convention;
    convention.axes = best->axes;
    if (best->scalar_last) convention.quaternion = QuaternionColumns::scalar_last;
    std::string what;
    const auto say = [&](const std::string& part) { what += (what.empty() ? "" : " and ") + part; };
    if (best->axes != Axes::z_up_right) {
        Convention axes;
        axes.axes = best->axes;
        say("the attitude is written " + name_of(axes));
    }
    if (best->scalar_last) say("the quaternion is scalar-last: the columns qw,qx,qy,qz hold x, y, z, w");
    if (best->inverse) say("the attitude is inverted (transposed): it maps world to body");
    if (fault != best->fault()) return {};
    const std::string by_name = name_of(convention), named = best->inverse ? "" : by_name;
    const std::string remedy = !best->inverse ? "give --convention " + named
                                              : "write the conjugate quaternion" +
                                                    (by_name.empty() ? "" : ", and give --convention " + by_name);
    return Explanation{rows.error(), least_error, what, remedy, named};
}
Hypothesis reading(const char* fault) {
    return {fault, About::attitude, alike, false,
            [fault](const ComparedRows& rows) { return other_reading(rows, fault); }};
}

// Another scene that the engine was given in place of this one; `change` says whether there is one.
Hypothesis other_scene(const char* fault, bool (*change)(Scene&), const char* what, const char* remedy) {
    return {fault, About::attitude, alike, false, [=](const ComparedRows& rows) -> Explained {
                Scene other = rows.scene();
                if (!change(other)) return {};
                return Explanation{rows.error(), rows.attitude_error(other, {}), what, remedy, "", "", [&rows, other] {
                                       return rows.rates_left(other, {});
                                   }};
            }};
}

bool center_at_origin(Scene& scene) {
    if (!(length(scene.body.center_of_mass) > 0)) return false;
    scene.body.source = nullptr, scene.body.center_of_mass = {};
    return true;
}

bool inertia_about_origin(Scene& scene) {
    if (!scene.pivot || length(*scene.pivot) != 0) return false;
    const Vector3<double> center = scene.body.center_of_mass;
    if (!center_at_origin(scene)) return false;
    scene.body.inertia_B = scene.body.inertia_B + parallel_axis(scene.body.mass, center);
    return true;
}

template <Frame written>
bool rate_in_other_frame(Scene& scene) {
    if (scene.initial.angular_velocity_frame != written) return false;
    scene.initial.angular_velocity_frame = written == Frame::body ? Frame::world : Frame::body;
    return true;
}

}  // namespace

std::span<const Hypothesis> hypotheses() {
    static const std::vector<Hypothesis> all{
        written_rate(
            {"angular_velocity_in_body_axes", 1, true, "wx,wy,wz are in body axes", "write them in world axes", ""}),
        written_rate({"angular_velocity_in_degrees", degree, false, "wx,wy,wz are in degrees per second",
                      "write radians per second, or give --convention degrees", "degrees"}),
        written_rate({"angular_velocity_in_degrees_and_body_axes", degree, true,
                      "wx,wy,wz are in degrees per second and in body axes", "write radians per second, in world axes",
                      ""}),
        written_position("origin_for_center_of_mass", false, "px,py,pz are the body's origin, not its centre of mass",
                         "name the columns ox,oy,oz"),
        written_position("center_of_mass_for_origin", true, "ox,oy,oz are the centre of mass, not the body's origin",
                         "name the columns px,py,pz"),
        reading("other_axes"),
        reading("scalar_last_quaternion"),
        reading("inverted_orientation"),
        {"first_order_quaternion_update", About::attitude, 1, false, first_order},
        {"wrong_time_step", About::attitude, fitted_alike, true, wrong_time},
        {"gyroscopic_term_missing", About::attitude, alike, false, without_gyroscopic_term},
        {"gyroscopic_term_reversed", About::attitude, alike, false, reversed_gyroscopic_term},
        {"speed_clamped", About::attitude, alike, true, clamped_speed},
        {"damping_left_on", About::attitude, fitted_alike, true, left_damping},
        other_scene("center_of_mass_for_origin", center_at_origin,
                    "the centre of mass is taken for the body's origin: arms and pivot are counted from there",
                    "give the engine the body's centre of mass"),
        other_scene("center_of_mass_for_origin", inertia_about_origin,
                    "forces act as if the centre of mass were the body's origin: the inertia alone knows where it is",
                    "give the engine the body's centre of mass"),
        other_scene(
            "degrees_for_radians",
            [](Scene& scene) {
                scene.initial.angular_velocity = degree * scene.initial.angular_velocity;
                return true;
            },
            "the initial angular velocity is taken for degrees per second", "start the engine in its own unit"),
        other_scene(
            "degrees_for_radians",
            [](Scene& scene) {
                scene.initial.angular_velocity = (1 / degree) * scene.initial.angular_velocity;
                return true;
            },
            "the initial angular velocity in rad/s is converted from degrees once too often",
            "start the engine in its own unit"),
        other_scene("body_for_world_angular_velocity", rate_in_other_frame<Frame::body>,
                    "the initial angular velocity is taken in world axes", "turn it into the engine's axes first"),
        other_scene("body_for_world_angular_velocity", rate_in_other_frame<Frame::world>,
                    "the initial angular velocity is taken in body axes", "turn it into the engine's axes first"),
        other_scene(
            "inverted_initial_orientation",
            [](Scene& scene) {
                scene.initial.orientation = conjugate(scene.initial.orientation);
                return true;
            },
            "the initial orientation is inverted (transposed)", "start from the conjugate"),
        other_scene(
            "scalar_last_initial_orientation",
            [](Scene& scene) {
                const Quaternion<double> q = scene.initial.orientation;
                scene.initial.orientation = {q.z, q.w, q.x, q.y};
                return true;
            },
            "the initial orientation is read scalar-last: w, x, y, z taken for x, y, z, w",
            "give the engine the components in its own order"),
    };
    return all;
}

}  // namespace polhode
