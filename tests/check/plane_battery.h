// Test battery for faults of impacts: a small engine simulates balls and tumbling boxes on a plane. It shares no code
// with the catalogue or with `check`.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "motion/trajectory_csv.h"
#include "scene/scene.h"
#include "scene/scene_file.h"

namespace polhode::plane_battery {

using V3 = Vector3<double>;

/// How the engine treats contacts.
enum class Contact {
    timed,     ///< the step is split at the time of contact
    mirrored,  ///< the velocity is reversed after a full step of gravity
    late,      ///< a contact is detected one step later, and the velocity before gravity is reversed
    kept,      ///< `mirrored` without energy gain at rest; the depth is never corrected
    missed,    ///< there is no plane
};

struct Knobs {
    Contact contact = Contact::timed;
    double restitution_factor = 1;  ///< factor of the scene's restitution
    int restitution_power = 1;      ///< 2: the restitution is applied twice
    double threshold = 0;           ///< slower impacts do not rebound, m/s
    double sunk = 0;                ///< the engine's plane is lower by this distance, m
};

/// Semi-implicit Euler with a plane without friction. A body with radius > 0 is a ball with constant angular
/// velocity. Otherwise it is a box with corners at +-half and an explicit gyroscopic term.
class Engine {
  public:
    Engine(const Scene& scene, double radius, const V3& half, const Knobs& knobs)
        : k_(knobs), radius_(radius), mass_(scene.body.mass), q_(scene.initial.orientation) {
        const Plane& plane = scene.planes.front();
        const double size = std::sqrt(dot(plane.normal_W, plane.normal_W));
        n_ = (1 / size) * plane.normal_W, offset_ = plane.offset / size - knobs.sunk;
        e_ = std::pow(knobs.restitution_factor * plane.restitution, knobs.restitution_power);
        for (const Load& load : scene.loads)
            if (const auto* g = std::get_if<Gravity>(&load)) g_ = g_ + g->acceleration_W;
        s_ = {scene.initial.position_W, scene.initial.velocity_W, rotate(q_, scene.initial.angular_velocity)};
        for (int i = 0; i < 8; ++i)
            corners_.push_back({i & 1 ? half[0] : -half[0], i & 2 ? half[1] : -half[1], i & 4 ? half[2] : -half[2]});
        for (int i = 0; i < 3; ++i) {
            const double a = half[(i + 1) % 3], b = half[(i + 2) % 3];
            I_[i] = mass_ * (a * a + b * b) / 3;
        }
    }

    void step(double h) {
        switch (k_.contact) {
            case Contact::timed:
                timed_step(h);
                break;
            case Contact::missed:
                fly(h);
                break;
            case Contact::mirrored: {
                s_.v = s_.v + h * g_;
                const double speed = dot(n_, s_.v);
                if (depth() - speed * h > 0 && speed < 0) s_.v = s_.v - (1 + back(-speed)) * speed * n_;
                s_.x = s_.x + h * s_.v;
                turn_ball(h);
                break;
            }
            case Contact::late: {
                const double speed = dot(n_, s_.v);
                if (depth() > 0 && speed < 0)
                    s_.v = s_.v - (1 + back(-speed)) * speed * n_;
                else
                    s_.v = s_.v + h * g_;
                s_.x = s_.x + h * s_.v;
                turn_ball(h);
                break;
            }
            case Contact::kept: {
                s_.v = s_.v + h * g_;
                const double speed = dot(n_, s_.v);
                const double rest = -4 * h * dot(n_, g_);
                if (depth() > 0 && speed < 0) s_.v = s_.v - (1 + (-speed < rest ? 0 : back(-speed))) * speed * n_;
                s_.x = s_.x + h * s_.v;
                turn_ball(h);
                break;
            }
        }
    }

    TrajectoryRow row(double t) const { return {t, q_, s_.w, s_.x, s_.v}; }

  private:
    struct State {
        V3 x, v, w;  // w in world axes
    };

    Knobs k_;
    double radius_, mass_, offset_ = 0, e_ = 1;
    Quaternion<double> q_;
    V3 n_, g_, I_;
    State s_;
    std::vector<V3> corners_;
    bool resting_ = false;

    double back(double speed) const { return speed < k_.threshold ? 0 : e_; }
    // the deepest point, from the centre of mass
    V3 deepest() const {
        if (radius_ > 0) return -radius_ * n_;
        V3 lowest;
        double least = std::numeric_limits<double>::infinity();
        for (const V3& corner : corners_)
            if (const V3 r = rotate(q_, corner); dot(n_, r) < least) least = dot(n_, r), lowest = r;
        return lowest;
    }
    double depth() const { return offset_ - dot(n_, s_.x + deepest()); }

    // the angular velocity of a ball is constant
    void turn_ball(double h) {
        const double speed = std::sqrt(dot(s_.w, s_.w)), angle = speed * h / 2,
                     s = angle > 0 ? std::sin(angle) / speed : 0;
        q_ = Quaternion<double>{std::cos(angle), s * s_.w[0], s * s_.w[1], s * s_.w[2]} * q_;
    }
    void fly(double h) {
        s_.v = s_.v + h * g_, s_.x = s_.x + h * s_.v;
        if (radius_ > 0) {
            turn_ball(h);
            return;
        }
        V3 w = rotate_back(q_, s_.w);
        const V3 L(I_[0] * w[0], I_[1] * w[1], I_[2] * w[2]), change = cross(w, L);
        for (int i = 0; i < 3; ++i) w[i] -= h * change[i] / I_[i];
        const double speed = std::sqrt(dot(w, w)), angle = speed * h / 2, s = angle > 0 ? std::sin(angle) / speed : 0;
        // w is converted by the attitude at the start of the step: rotation about w does not change w
        s_.w = rotate(q_, w);
        q_ = q_ * Quaternion<double>{std::cos(angle), s * w[0], s * w[1], s * w[2]};
    }
    void apply_impact() {
        const V3 r = deepest(), point = s_.v + cross(s_.w, r);
        const double speed = dot(n_, point);
        if (!(speed < 0)) return;
        double inverse = 1 / mass_;
        V3 turn;
        if (!(radius_ > 0)) {
            const V3 arm = rotate_back(q_, cross(r, n_));
            turn = rotate(q_, V3(arm[0] / I_[0], arm[1] / I_[1], arm[2] / I_[2]));
            inverse += dot(n_, cross(turn, r));
        }
        const double impulse = -(1 + back(-speed)) * speed / inverse;
        s_.v = s_.v + (impulse / mass_) * n_, s_.w = s_.w + impulse * turn;
    }
    // flies to each contact within the step, then applies the impact
    void timed_step(double h) {
        if (resting_) {
            turn_ball(h);
            return;
        }
        double left = h;
        for (int impacts = 0; left > 0; ++impacts) {
            const State from = s_;
            const Quaternion<double> from_q = q_;
            const auto fly_for = [&](double time) { s_ = from, q_ = from_q, fly(time); };
            fly_for(left);
            if (!(depth() > 0) || !(dot(n_, s_.v + cross(s_.w, deepest())) < 0)) return;
            double open = 0, closed = left;
            for (int i = 0; i < 60; ++i) {
                const double middle = (open + closed) / 2;
                fly_for(middle);
                (depth() > 0 ? closed : open) = middle;
            }
            fly_for(open);
            apply_impact();
            left -= open;
            // a ball that falls back within the step rests
            if (radius_ > 0 && (impacts > 3 || dot(n_, s_.v) < -0.5 * dot(n_, g_) * h)) {
                s_.v = s_.v - dot(n_, s_.v) * n_, resting_ = std::abs(dot(n_, g_)) > 0.999 * std::sqrt(dot(g_, g_));
                return;
            }
            if (impacts > 20) return;
        }
    }
};

/// A scene with the size of its body.
struct Case {
    Scene scene;
    double radius = 0;
    V3 half;
};

inline Case case_of(const std::string& name, const std::string& shape, const std::string& initial,
                    const std::string& plane, double duration, double radius, const V3& half) {
    const std::string text = R"({"name": ")" + name + R"(", "duration": )" + std::to_string(duration) +
                             R"(, "body": {"shape": )" + shape + R"(, "mass": 2}, "initial": )" + initial +
                             R"(, "loads": [{"type": "gravity", "acceleration": [0, 0, -9.81]}], "planes": [)" + plane +
                             "]}";
    return {parse_scene(text, name + ".json", ""), radius, half};
}

/// Bouncing balls and boxes.
inline std::vector<Case> cases() {
    const std::string ball = R"({"type": "sphere", "radius": 0.3})",
                      box = R"({"type": "box", "half_extents": [0.1, 0.2, 0.3]})";
    return {
        case_of("dropped", ball, R"({"position": [0, 0, 1.7]})", R"({"normal": [0, 0, 1], "restitution": 0.8})", 4, 0.3,
                {}),
        case_of("thrown", ball, R"({"position": [0, 0, 1.5], "velocity": [2, 1, 3]})",
                R"({"normal": [0, 0, 2], "offset": 0.2, "restitution": 0.5})", 4, 0.3, {}),
        case_of("elastic", ball, R"({"position": [1, 0, 2], "velocity": [0.5, 0, -1]})",
                R"({"normal": [0, 0, 1], "restitution": 1})", 4, 0.3, {}),
        case_of("on a slope", ball, R"({"position": [0, 0, 2]})", R"({"normal": [0.6, 0, 0.8], "restitution": 0.7})", 2,
                0.3, {}),
        case_of("spinning", ball, R"({"position": [0, 0, 1.9], "velocity": [0, 1, 0], "angular_velocity": [2, -1, 3]})",
                R"({"normal": [0, 0, 1], "restitution": 0.75})", 4, 0.3, {}),
        case_of("box", box, R"({"angular_velocity": [1, 4, 2], "position": [0, 0, 1]})",
                R"({"normal": [0, 0, 1], "restitution": 0.9})", 1.2, 0, {0.1, 0.2, 0.3}),
        case_of("thrown box", box,
                R"({"angular_velocity": [3, -1, 2], "position": [0, 0, 1.2], "velocity": [1, 0, 1]})",
                R"({"normal": [0, 0, 1], "restitution": 0.6})", 1.2, 0, {0.1, 0.2, 0.3}),
    };
}

/// A fault of impacts.
struct Fault {
    std::string name;
    std::vector<std::string> words;  ///< correct diagnoses
    Knobs knobs;
    bool of_balls = false;  ///< only balls get this diagnosis
};

inline std::vector<Fault> faults() {
    std::vector<Fault> all;
    const auto add = [&](std::string name, std::vector<std::string> words, bool of_balls, auto&& change) {
        Fault& f = all.emplace_back(Fault{std::move(name), std::move(words), {}, of_balls});
        change(f.knobs);
    };
    add("mirrored after gravity", {"bounce_gains_energy"}, true, [](Knobs& k) { k.contact = Contact::mirrored; });
    add("restitution applied twice", {"restitution_applied_twice"}, true, [](Knobs& k) { k.restitution_power = 2; });
    add("restitution a third", {"restitution_wrong"}, false, [](Knobs& k) { k.restitution_factor = 1.0 / 3; });
    add("threshold", {"bounce_dies_below_threshold"}, true, [](Knobs& k) { k.threshold = 2.5; });
    add("late", {"bounce_late"}, true, [](Knobs& k) { k.contact = Contact::late; });
    add("depth never corrected", {"penetration_kept"}, true,
        [](Knobs& k) { k.contact = Contact::kept, k.restitution_factor = 0; });
    add("rests inside", {"penetration_kept"}, true, [](Knobs& k) { k.sunk = 0.03, k.restitution_factor = 0.5; });
    add("missed", {"impact_missed"}, false, [](Knobs& k) { k.contact = Contact::missed; });
    return all;
}

/// Runs the engine with `hertz` steps and rows per second.
inline TrajectoryFile run(const Case& c, const Knobs& knobs, double hertz) {
    Engine engine(c.scene, c.radius, c.half, knobs);
    TrajectoryFile file;
    file.has_angular_velocity = file.has_position = file.has_velocity = true;
    file.rows.push_back(engine.row(0));
    const int rows = static_cast<int>(c.scene.duration * hertz);
    for (int k = 1; k <= rows; ++k) {
        engine.step(1 / hertz);
        file.rows.push_back(engine.row(k / hertz));
    }
    return file;
}

/// Whether the fault is visible in a run: the motion differs from the sound one by more than rounding. A penetration
/// must be clearly larger than the slop that engines leave.
inline bool is_visible(const Case& c, const Fault& f, double hertz) {
    if (f.of_balls && !(c.radius > 0)) return false;
    const TrajectoryFile broken = run(c, f.knobs, hertz), sound = run(c, {}, hertz);
    double apart = 0;
    for (std::size_t k = 0; k < broken.rows.size(); ++k) {
        const V3 d = broken.rows[k].position_W - sound.rows[k].position_W;
        apart = std::max(apart, std::sqrt(dot(d, d)));
    }
    if (f.words.front() != "penetration_kept") return apart > 1e-3;
    const Plane& plane = c.scene.planes.front();
    const double size = std::sqrt(dot(plane.normal_W, plane.normal_W));
    const TrajectoryRow& last = broken.rows.back();
    return plane.offset / size + c.radius - dot(plane.normal_W, last.position_W) / size > 0.04 * c.radius;
}

}  // namespace polhode::plane_battery
