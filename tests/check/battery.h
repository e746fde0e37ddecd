// Test battery for `check`: three small engines run the scenes of scenes() with the faults of faults(). They share no
// code with the catalogue or with the predictions of `check`. Faults of impacts are in check/plane_battery.h.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "check/convention.h"
#include "motion/exact_body.h"
#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode::battery {

using V3 = Vector3<double>;

/// Faults in an engine's code.
struct Knobs {
    double gyroscopic = 1, damping = 0, linear_damping = 0, gravity = 1, torque = 1, turn = 1, clock = 1;
    double speed_limit = std::numeric_limits<double>::infinity();
    bool first_order = false, swap_torque_axes = false, wrong_side = false, frozen = false, stuck = false;
    double asleep_after = std::numeric_limits<double>::infinity();  ///< s
    double damping_a_step = 0;                                      ///< part of w and v that is lost in each step
    /// The matrix used as inertia tensor in world axes instead of R I R^T.
    enum class Tensor { right, not_turned, turned_back, diagonal, inverse_diagonal } tensor = Tensor::right;
    enum class Clamp { length, body, world } clamp = Clamp::length;
    bool coasting_only = false;      ///< damping and limit act only without torque or force
    bool in_place = false;           ///< the quaternion is updated in place, component by component
    bool drag_each_step = false;     ///< the drag's torque and force are not multiplied by the step
    bool drag_on_rate = false;       ///< drag coefficients are used as decay rates of w
    bool first_rate = false;         ///< every substep rotates the attitude by the rate at the start of the row
    int normalised_every = 1;        ///< the stored quaternion is normalised every n rows
    bool integrates_origin = false;  ///< integrates the motion of the origin instead of the centre of mass
    bool has_centripetal = true, has_euler = true;  ///< terms of the origin's acceleration
    double arm = 1;                                 ///< factor of the arms of forces
    bool arm_in_world = false;                      ///< arms in body axes are used in world axes
    bool drag_in_world = false;                     ///< drag coefficients in body axes are used in world axes
    bool spring_in_world = false;                   ///< the spring's torque in body axes is applied in world axes
    bool world_rate_right = false;                  ///< uses dq/dt = 1/2 q (R w), with w integrated in body axes
    bool lose_last = false;                         ///< damping and limit act after the attitude has been rotated
};

enum class EngineKind {
    world_rate,  ///< semi-implicit Euler: w in world axes, the gyroscopic term explicit
    momentum,    ///< semi-implicit Euler: L in world axes, an orientation matrix
    midpoint,    ///< the explicit midpoint rule in body axes
};

/// The three engines.
template <class Real>
class Engine {
    using V = Vector3<Real>;
    using Q = Quaternion<Real>;

  public:
    Engine(const Scene& scene, const Knobs& knobs, EngineKind kind) : scene_(scene), k_(knobs), kind_(kind) {
        const ExactBody<double> b = exact_body<double>(scene);
        mass_ = Real(b.mass), held_ = b.pivoted;
        I_ = cast<Real>(b.inertia_B), inverse_I_ = cast<Real>(inverse(b.inertia_B));
        own_I_ = I_, own_inverse_ = inverse_I_;
        take_tensor(cast<Real>(b.q));
        arm_ = cast<Real>(b.arm), center_ = cast<Real>(b.center), origin_ = cast<Real>(b.origin);
        q_ = cast<Real>(b.q), w_ = cast<Real>(b.angular_velocity_B);
        x_ = cast<Real>(b.position_W), v_ = cast<Real>(b.velocity_W);
        kick(-1, 0);
        place();
    }

    void step(double t, double h) {
        if (t + 0.5 * h > k_.asleep_after || k_.frozen) return;
        const Real dt = static_cast<Real>(h * k_.clock);
        if (k_.integrates_origin) x_ = x_ - rotated(q_, center_), v_ = v_ - arm_velocity();
        const V w0 = w_, v0 = v_;
        const Q q0 = q_;
        take_tensor(q0);
        coasting_ = coasts(t);
        per_step_ = k_.drag_each_step ? 1 / dt : Real(1);
        if (kind_ == EngineKind::midpoint) {
            const V x0 = x_;
            const V dw = rate(t, dt / 2), dv = point_acceleration(t);
            const Q turn0 = quarter(turning(q0, w0), dt / 2);
            w_ = w0 + (dt / 2) * dw, v_ = v0 + (dt / 2) * dv, x_ = x0 + (dt / 2) * v0;
            q_ = k_.first_rate ? next_attitude(q0, w0, dt / 2) : unit(side(q0, turn0));
            const V dw2 = rate(t + 0.5 * h, dt / 2), dv2 = point_acceleration(t + 0.5 * h), middle = turning(q_, w_);
            const V v_middle = v_;
            w_ = w0 + dt * dw2, v_ = v0 + dt * dv2, x_ = x0 + dt * v_middle;
            q_ = next_attitude(q0, middle, dt);
        } else if (kind_ == EngineKind::world_rate) {
            const V tau = torque(t);
            V w = w0 + dt * (inverse_I_ * tau);
            w = w - (dt * Real(k_.gyroscopic)) * (inverse_I_ * cross(w, I_ * w));
            const V dv = point_acceleration(t);
            w_ = w;
            if (!k_.lose_last) lose(dt);
            v_ = v0 + dt * dv;
            lose_speed(dt);
            q_ = next_attitude(q0, turning(q0, w_), dt);
            if (k_.lose_last) lose(dt);
            // the rate is integrated in world axes
            if (k_.first_rate) w_ = rotated_back(q_, rotated(q0, w_));
            x_ = x_ + dt * v_;
        } else {
            const V tau = torque(t), dv = point_acceleration(t);
            // the engine integrates L; it follows from w by the tensor whose inverse gave w
            const V L = rotated(q0, (k_.tensor == Knobs::Tensor::right ? I_ : inverse(inverse_I_)) * w0) +
                        dt * rotated(q0, tau);
            const V w = inverse_I_ * rotated_back(q0, L);
            w_ = w;
            lose(dt);
            const Real momentum_factor = length_of(w) > 0 ? length_of(w_) / length_of(w) : Real(1);
            v_ = v0 + dt * dv;
            lose_speed(dt);
            q_ = next_attitude(q0, turning(q0, w_), dt);
            take_tensor(q_);
            if (k_.gyroscopic == 1 && !k_.wrong_side) w_ = momentum_factor * (inverse_I_ * rotated_back(q_, L));
            x_ = x_ + dt * v_;
        }
        if (kind_ == EngineKind::midpoint) lose(dt), lose_speed(dt);
        if (k_.stuck) q_ = q0;
        if (k_.integrates_origin) x_ = x_ + rotated(q_, center_), v_ = v_ + arm_velocity();
        kick(t, t + h);
        place();
    }

    /// Must be called before the first step of each row.
    void start_row() { first_rate_W_ = rotated(q_, w_); }
    /// Must be called after the last step of each row.
    void end_row() {
        if (++rows_ % k_.normalised_every == 0) stored_length_ = 1;
    }

    TrajectoryRow row(double t) const {
        TrajectoryRow r;
        const Q stored = {stored_length_ * q_.w, stored_length_ * q_.x, stored_length_ * q_.y, stored_length_ * q_.z};
        r.t = t, r.q = cast<double>(stored), r.angular_velocity_W = cast<double>(rotated(q_, w_));
        r.position_W = cast<double>(x_), r.velocity_W = cast<double>(v_);
        return r;
    }

  private:
    const Scene& scene_;
    Knobs k_;
    EngineKind kind_;
    Real mass_;
    bool held_;
    Matrix3<Real> I_, inverse_I_, own_I_, own_inverse_;
    bool coasting_ = false;
    Real per_step_ = 1;
    V first_rate_W_;
    int rows_ = 0;
    Real stored_length_ = 1;  // length of the written quaternion; q_ itself is normalised
    V arm_, center_, origin_;
    Q q_;
    V w_, x_, v_;

    static Real length_of(const V& v) { return std::sqrt(dot(v, v)); }
    static Q unit(const Q& q) {
        const Real n = std::sqrt(squared_norm(q));
        return {q.w / n, q.x / n, q.y / n, q.z / n};
    }
    static V rotated(const Q& q, const V& v) { return rotation_matrix(q) * v; }
    static V rotated_back(const Q& q, const V& v) { return transposed(rotation_matrix(q)) * v; }

    // the quaternion of a rotation by w for a time dt
    Q quarter(const V& w, Real dt) const {
        const V half = (Real(k_.turn) * dt / 2) * w;
        if (k_.first_order || k_.in_place) return {1, half[0], half[1], half[2]};
        const Real angle = length_of(half), s = angle > 0 ? std::sin(angle) / angle : Real(1);
        return {std::cos(angle), s * half[0], s * half[1], s * half[2]};
    }
    V turning(const Q& q, const V& w) const { return k_.world_rate_right ? rotated(q, w) : w; }
    Q next_attitude(const Q& q, const V& w, Real dt) {
        if (k_.first_rate) return unit(quarter(first_rate_W_, dt) * q);
        const Q turn = quarter(w, dt);
        if (k_.normalised_every > 1) stored_length_ *= std::sqrt(squared_norm(turn));
        return unit(side(q, turn));
    }
    // velocity of the centre of mass relative to the origin, world axes
    V arm_velocity() const { return rotated(q_, cross(w_, center_)); }
    // acceleration of the point whose motion is integrated, world axes
    V point_acceleration(double t) const {
        V a = acceleration(t);
        if (!k_.integrates_origin) return a;
        if (k_.has_euler) a = a - rotated(q_, cross(rate(t, 0), center_));
        if (k_.has_centripetal) a = a - rotated(q_, cross(w_, cross(w_, center_)));
        return a;
    }
    Q side(const Q& q, const Q& turn) const {
        if (!k_.in_place) return k_.wrong_side ? turn * q : q * turn;
        Q r = q;
        r.w = r.w - turn.x * r.x - turn.y * r.y - turn.z * r.z;
        r.x = r.x + turn.x * r.w + turn.z * r.y - turn.y * r.z;
        r.y = r.y + turn.y * r.w + turn.x * r.z - turn.z * r.x;
        r.z = r.z + turn.z * r.w + turn.y * r.x - turn.x * r.y;
        return r;
    }

    // converts the engine's tensor in world axes at an attitude to body axes
    void take_tensor(const Q& q) {
        using T = Knobs::Tensor;
        if (k_.tensor == T::right) return;
        const Matrix3<Real> R = rotation_matrix(q), B = transposed(R);
        const auto only_diagonal = [](Matrix3<Real> m) {
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t j = 0; j < 3; ++j)
                    if (i != j) m[i][j] = 0;
            return m;
        };
        Matrix3<Real> world = own_I_, inverse_world = own_inverse_;
        if (k_.tensor == T::turned_back) world = B * world * R, inverse_world = B * inverse_world * R;
        if (k_.tensor == T::diagonal) {
            world = only_diagonal(R * own_I_ * B);
            inverse_world = world;
            for (std::size_t i = 0; i < 3; ++i) inverse_world[i][i] = 1 / world[i][i];
        }
        if (k_.tensor == T::inverse_diagonal)
            world = R * own_I_ * B, inverse_world = only_diagonal(R * own_inverse_ * B);
        I_ = B * world * R, inverse_I_ = B * inverse_world * R;
    }
    bool coasts(double t) const {
        for (const Load& load : scene_.loads) {
            if (const auto* c = std::get_if<Torque>(&load); c && on(c->window, t)) return false;
            if (const auto* f = std::get_if<Force>(&load); f && on(f->window, t)) return false;
        }
        return true;
    }
    void lose(Real dt) {
        if (k_.drag_on_rate)
            for (const Load& load : scene_.loads)
                if (const auto* d = std::get_if<Drag>(&load))
                    for (int i = 0; i < 3; ++i) w_[i] *= 1 - Real(d->rotational[i]) * dt;
        if (k_.coasting_only && !coasting_) return;
        w_ = (std::max(Real(0), 1 - Real(k_.damping) * dt) * Real(1 - k_.damping_a_step)) * w_;
        const Real speed = length_of(w_), most = Real(k_.speed_limit);
        if (k_.clamp == Knobs::Clamp::length) {
            if (speed > most) w_ = (most / speed) * w_;
            return;
        }
        const bool world = k_.clamp == Knobs::Clamp::world;
        V given = world ? rotated(q_, w_) : w_;
        for (int i = 0; i < 3; ++i) given[i] = std::min(std::max(given[i], -most), most);
        w_ = world ? rotated_back(q_, given) : given;
    }
    void lose_speed(Real dt) {
        v_ = (std::max(Real(0), 1 - Real(k_.linear_damping) * dt) * Real(1 - k_.damping_a_step)) * v_;
    }
    static bool on(const Window& window, double t) { return window.from <= t && t < window.until; }

    V rate(double t, Real) const { return inverse_I_ * (torque(t) - Real(k_.gyroscopic) * cross(w_, I_ * w_)); }
    V force_W(const Force& f) const {
        return f.frame == Frame::world ? cast<Real>(f.vector) : rotated(q_, cast<Real>(f.vector));
    }
    // sum of all torques, body axes
    V torque(double t) const {
        V sum;
        for (const Load& load : scene_.loads) {
            if (const auto* g = std::get_if<Gravity>(&load); g && held_ && on(g->window, t))
                sum = sum + cross(arm_, rotated_back(q_, (Real(k_.gravity) * mass_) * cast<Real>(g->acceleration_W)));
            if (const auto* c = std::get_if<Torque>(&load); c && on(c->window, t)) {
                const V given = Real(k_.torque) * cast<Real>(c->vector);
                sum = sum + ((c->frame == Frame::body) != k_.swap_torque_axes ? given : rotated_back(q_, given));
            }
            if (const auto* d = std::get_if<Drag>(&load); d && on(d->window, t)) {
                V against;
                const V w = k_.drag_in_world ? rotated(q_, w_) : w_;
                for (int i = 0; i < 3 && !k_.drag_on_rate; ++i) against[i] = per_step_ * Real(d->rotational[i]) * w[i];
                sum = sum - (k_.drag_in_world ? rotated_back(q_, against) : against);
                if (held_) sum = sum - Real(d->translational) * cross(arm_, cross(w_, arm_));
            }
            if (const auto* f = std::get_if<Force>(&load); f && on(f->window, t)) {
                const V point = f->point_frame == Frame::body
                                    ? V(cast<Real>(f->point) - origin_)
                                    : rotated_back(q_, held_ ? cast<Real>(f->point) : V(cast<Real>(f->point) - x_));
                if (k_.arm_in_world && f->point_frame == Frame::body)
                    sum = sum + rotated_back(q_, cross(point, force_W(*f)));
                else
                    sum = sum + Real(k_.arm) * cross(point, rotated_back(q_, force_W(*f)));
            }
            if (const auto* s = std::get_if<Spring>(&load); s && on(s->window, t)) {
                const Q r = conjugate(unit(cast<Real>(s->rest_orientation))) * q_;
                const V back = (2 * Real(s->stiffness) * r.w) * V(r.x, r.y, r.z);
                sum = sum - (k_.spring_in_world ? rotated_back(q_, back) : back);
            }
        }
        return sum;
    }
    V acceleration(double t) const {
        V sum;
        if (held_) return sum;
        for (const Load& load : scene_.loads) {
            if (const auto* g = std::get_if<Gravity>(&load); g && on(g->window, t))
                sum = sum + Real(k_.gravity) * cast<Real>(g->acceleration_W);
            if (const auto* d = std::get_if<Drag>(&load); d && on(d->window, t))
                sum = sum - (per_step_ * Real(d->translational) / mass_) *
                                (k_.integrates_origin ? V(v_ + arm_velocity()) : v_);
            if (const auto* f = std::get_if<Force>(&load); f && on(f->window, t)) sum = sum + (1 / mass_) * force_W(*f);
        }
        return sum;
    }
    // applies impulses at from < t <= until
    void kick(double from, double until) {
        for (const Load& load : scene_.loads)
            if (const auto* i = std::get_if<Impulse>(&load); i && from < i->at && i->at <= until + 1e-12) {
                const V J = i->frame == Frame::world ? rotated_back(q_, cast<Real>(i->vector)) : cast<Real>(i->vector);
                const V point = i->point_frame == Frame::body
                                    ? V(cast<Real>(i->point) - origin_)
                                    : rotated_back(q_, held_ ? cast<Real>(i->point) : V(cast<Real>(i->point) - x_));
                w_ = w_ + inverse_I_ * cross(point, J);
                if (!held_) v_ = v_ + (1 / mass_) * rotated(q_, J);
            }
    }
    void place() {
        if (!held_) return;
        x_ = rotated(q_, arm_), v_ = rotated(q_, cross(w_, arm_));
    }
};

/// Whether a fault is possible in an engine. For example, an engine that integrates L has no gyroscopic term.
inline bool has(EngineKind kind, const Knobs& knobs) {
    if ((knobs.tensor != Knobs::Tensor::right || knobs.in_place) && kind == EngineKind::midpoint) return false;
    // with a tensor that is not rotated, constant L means constant w: the gyroscopic term is missing
    if (knobs.tensor == Knobs::Tensor::not_turned && kind == EngineKind::momentum) return false;
    // L is constant in free motion: substeps by the row's first rate equal one explicit step
    if (knobs.first_rate && kind == EngineKind::momentum) return false;
    if (knobs.lose_last && kind != EngineKind::world_rate) return false;
    if (knobs.world_rate_right && kind == EngineKind::momentum) return false;
    return kind != EngineKind::momentum || ((knobs.gyroscopic == 0 || knobs.gyroscopic == 1) && !knobs.wrong_side);
}

/// Runs an engine with steps of h and writes `rows` rows after the first, one every `every` steps.
template <class Real>
TrajectoryFile run(const Scene& scene, const Knobs& knobs, EngineKind kind, double h, int every, int rows) {
    Engine<Real> engine(scene, knobs, kind);
    TrajectoryFile file;
    file.has_angular_velocity = file.has_position = file.has_velocity = true;
    file.rows.push_back(engine.row(0));
    for (int k = 1; k <= rows; ++k) {
        engine.start_row();
        for (int i = 0; i < every; ++i) engine.step(((k - 1) * every + i) * h, h);
        engine.end_row();
        file.rows.push_back(engine.row(k * every * h));
    }
    return file;
}

/// A fault of an engine or its file.
struct Fault {
    std::string name;
    std::vector<std::string> words;  ///< correct diagnoses
    /// Changes the engine's scene and its code. Returns false if the fault does not apply to the scene.
    std::function<bool(Scene&, Knobs&)> engine = [](Scene&, Knobs&) { return true; };
    std::function<bool(const Scene&, TrajectoryFile&)> file = [](const Scene&, TrajectoryFile&) { return true; };
    bool needs_rates = false;  ///< the fault cannot be recognised in a file without w
    int substeps = 1;          ///< steps per row
};

template <class T>
bool any(const Scene& scene) {
    for (const Load& load : scene.loads)
        if (std::holds_alternative<T>(load)) return true;
    return false;
}
template <class T, class F>
bool change_each(Scene& scene, F change) {
    for (Load& load : scene.loads)
        if (T* one = std::get_if<T>(&load)) change(*one);
    return any<T>(scene);
}
inline bool turns(const Scene& scene) {
    return dot(scene.initial.angular_velocity, scene.initial.angular_velocity) > 0;
}
inline bool asymmetric(const Scene& scene) {
    const Matrix3<double>& I = scene.body.inertia_B;
    return std::abs(I[0][0] - I[1][1]) > 1e-3 && std::abs(I[1][1] - I[2][2]) > 1e-3;
}
inline bool has_products(const Scene& scene) {
    const Matrix3<double>& I = scene.body.inertia_B;
    return I[0][1] != 0 || I[0][2] != 0 || I[1][2] != 0;
}
inline bool each_row(TrajectoryFile& file, const std::function<void(TrajectoryRow&)>& change) {
    for (TrajectoryRow& row : file.rows) change(row);
    return true;
}
inline bool moves(const Scene& scene) {
    return !scene.pivot && dot(scene.initial.velocity_W, scene.initial.velocity_W) > 0;
}

inline std::vector<Fault> faults() {
    std::vector<Fault> all;
    const auto engine = [&](std::string name, std::vector<std::string> words, std::function<bool(Scene&, Knobs&)> f) {
        all.push_back({std::move(name), std::move(words), std::move(f), {}, false});
        all.back().file = [](const Scene&, TrajectoryFile&) { return true; };
    };
    const auto file = [&](std::string name, std::vector<std::string> words,
                          std::function<bool(const Scene&, TrajectoryFile&)> f, bool rates = false) {
        all.push_back({std::move(name), std::move(words), [](Scene&, Knobs&) { return true; }, std::move(f), rates});
    };
    const auto spins = [](const Scene& s) { return turns(s); };
    engine("gyroscopic term missing", {"gyroscopic_term_missing"}, [=](Scene& s, Knobs& k) {
        k.gyroscopic = 0;
        return spins(s) && asymmetric(s);
    });
    engine("gyroscopic term reversed", {"gyroscopic_term_reversed"}, [=](Scene& s, Knobs& k) {
        k.gyroscopic = -1;
        return spins(s) && asymmetric(s);
    });
    engine("gyroscopic term twice", {"gyroscopic_term_twice"}, [=](Scene& s, Knobs& k) {
        k.gyroscopic = 2;
        return spins(s) && asymmetric(s);
    });
    engine("world rate on the right", {"world_rate_multiplied_on_the_right"}, [=](Scene& s, Knobs& k) {
        k.world_rate_right = true;
        return spins(s) && asymmetric(s);
    });
    engine("damping at the end of a step", {"damping_left_on"}, [=](Scene& s, Knobs& k) {
        k.damping = 0.23, k.lose_last = true;
        return spins(s);
    });
    engine("speed clamped at the end of a step", {"speed_clamped"}, [=](Scene& s, Knobs& k) {
        k.speed_limit = 0.8 * std::sqrt(dot(s.initial.angular_velocity, s.initial.angular_velocity));
        k.lose_last = true;
        return spins(s);
    });
    engine("damping left on", {"damping_left_on"}, [=](Scene& s, Knobs& k) {
        k.damping = 0.1;
        return spins(s);
    });
    engine("damping per step", {"damping_left_on"}, [=](Scene& s, Knobs& k) {
        k.damping_a_step = 0.002;
        return spins(s);
    });
    engine("linear damping", {"linear_damping_left_on"}, [](Scene& s, Knobs& k) {
        k.linear_damping = 0.2;
        return moves(s);
    });
    engine("speed clamped", {"speed_clamped"}, [=](Scene& s, Knobs& k) {
        k.speed_limit = 0.7 * std::sqrt(dot(s.initial.angular_velocity, s.initial.angular_velocity));
        return spins(s);
    });
    engine("half rate", {"attitude_turned_at_half_rate"}, [=](Scene& s, Knobs& k) {
        k.turn = 0.5;
        return spins(s);
    });
    engine("double rate", {"attitude_turned_at_twice_the_rate"}, [=](Scene& s, Knobs& k) {
        k.turn = 2;
        return spins(s);
    });
    engine("turned backwards", {"attitude_turned_backwards", "angular_velocity_negated"}, [=](Scene& s, Knobs& k) {
        k.turn = -1;
        return spins(s);
    });
    engine("body rate on the left", {"body_rate_multiplied_on_the_left", "angular_velocity_in_body_axes"},
           [=](Scene& s, Knobs& k) {
               k.wrong_side = true;
               return spins(s) && asymmetric(s);
           });
    for (const double factor : {0.5, 1.2, 5.0 / 6})
        engine("clock " + std::to_string(factor).substr(0, 4), {"wrong_time_step"}, [=](Scene& s, Knobs& k) {
            k.clock = factor;
            return spins(s);
        });
    engine("rotation frozen", {"rotation_frozen", "motion_stopped"}, [=](Scene& s, Knobs& k) {
        k.stuck = true;
        return spins(s);
    });
    engine("never moves", {"motion_stopped"}, [=](Scene& s, Knobs& k) {
        k.frozen = true;
        return spins(s);
    });
    engine("falls asleep", {"motion_stopped"}, [=](Scene& s, Knobs& k) {
        k.asleep_after = 0.4;
        return spins(s);
    });
    const auto permuted = [](Scene& s, int a, int b, int c) {
        const std::array order{a, b, c};
        const Matrix3<double> I = s.body.inertia_B;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j)
                s.body.inertia_B[i][j] = I[static_cast<std::size_t>(order[i])][static_cast<std::size_t>(order[j])];
        return asymmetric(s) && turns(s);
    };
    engine("moments x, y exchanged", {"inertia_axes_permuted"}, [=](Scene& s, Knobs&) { return permuted(s, 1, 0, 2); });
    engine("moments y, z exchanged", {"inertia_axes_permuted"}, [=](Scene& s, Knobs&) { return permuted(s, 0, 2, 1); });
    engine("moments rolled", {"inertia_axes_permuted"}, [=](Scene& s, Knobs&) { return permuted(s, 1, 2, 0); });
    const auto products = [](Scene& s, double factor) {
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j)
                if (i != j) s.body.inertia_B[i][j] *= factor;
        return true;
    };
    engine("products dropped", {"products_of_inertia_dropped"},
           [=](Scene& s, Knobs&) { return has_products(s) && products(s, 0); });
    engine("products reversed", {"products_of_inertia_reversed", "principal_frame_transposed"},
           [=](Scene& s, Knobs&) { return has_products(s) && products(s, -1); });
    engine("taken for a ball", {"inertia_taken_for_a_ball", "gyroscopic_term_missing"}, [=](Scene& s, Knobs&) {
        const Matrix3<double>& I = s.body.inertia_B;
        const double mean = (I[0][0] + I[1][1] + I[2][2]) / 3;
        s.body.inertia_B = diagonal(V3(mean, mean, mean));
        return spins(s);
    });
    const auto driven = [](const Scene& s) {
        return any<Torque>(s) || any<Force>(s) || any<Spring>(s) || any<Drag>(s) || (s.pivot && any<Gravity>(s));
    };
    engine("inertia ten times", {"inertia_scaled", "density_scaled", "mass_scaled"}, [=](Scene& s, Knobs&) {
        for (std::size_t i = 0; i < 3; ++i) s.body.inertia_B[i] = 10.0 * s.body.inertia_B[i];
        return driven(s);
    });
    engine("centre of mass at origin", {"center_of_mass_for_origin"}, [](Scene& s, Knobs&) {
        const bool off = dot(s.body.center_of_mass, s.body.center_of_mass) > 0;
        s.body.center_of_mass = {};
        return off && s.pivot;
    });
    engine("start in degrees", {"degrees_for_radians"}, [=](Scene& s, Knobs&) {
        s.initial.angular_velocity = (std::numbers::pi / 180) * s.initial.angular_velocity;
        return spins(s);
    });
    engine("start negated", {"start_rate_negated"}, [=](Scene& s, Knobs&) {
        s.initial.angular_velocity = -s.initial.angular_velocity;
        return spins(s);
    });
    const auto tilted = [](const Scene& s) {
        return std::abs(s.initial.orientation.x) + std::abs(s.initial.orientation.y) > 0.1;
    };
    engine("start's w in world axes", {"body_for_world_angular_velocity"}, [=](Scene& s, Knobs&) {
        s.initial.angular_velocity_frame = Frame::world;
        return spins(s) && tilted(s);
    });
    engine("start inverted", {"inverted_initial_orientation"}, [=](Scene& s, Knobs&) {
        s.initial.orientation = conjugate(s.initial.orientation);
        return tilted(s);
    });
    engine("start without orientation", {"start_without_orientation"}, [=](Scene& s, Knobs&) {
        s.initial.orientation = {};
        return tilted(s);
    });
    const auto weighs = [](const Scene& s) { return any<Gravity>(s); };
    engine("gravity reversed", {"gravity_reversed"}, [=](Scene& s, Knobs& k) {
        k.gravity = -1;
        return weighs(s);
    });
    engine("gravity missing", {"gravity_missing"}, [=](Scene& s, Knobs& k) {
        k.gravity = 0;
        return weighs(s);
    });
    engine("gravity twice", {"gravity_twice"}, [=](Scene& s, Knobs& k) {
        k.gravity = 2;
        return weighs(s);
    });
    engine("gravity in centimetres", {"gravity_scaled"}, [=](Scene& s, Knobs& k) {
        k.gravity = 0.37;
        return weighs(s);
    });
    engine("gravity along y", {"gravity_along_y"}, [](Scene& s, Knobs&) {
        return change_each<Gravity>(s, [](Gravity& g) { std::swap(g.acceleration_W[1], g.acceleration_W[2]); });
    });
    engine("torque missing", {"torque_missing"}, [](Scene& s, Knobs& k) {
        k.torque = 0;
        return any<Torque>(s);
    });
    engine("torque reversed", {"torque_reversed"}, [](Scene& s, Knobs& k) {
        k.torque = -1;
        return any<Torque>(s);
    });
    engine("torque in other axes", {"torque_in_other_axes"}, [](Scene& s, Knobs& k) {
        k.swap_torque_axes = true;
        return any<Torque>(s);
    });
    engine("force at the centre of mass", {"force_at_center_of_mass"}, [](Scene& s, Knobs&) {
        const V3 c = s.body.center_of_mass;
        return change_each<Force>(s, [&](Force& f) { f.point = c, f.point_frame = Frame::body; }) && !s.pivot;
    });
    engine("arm of the force negated", {"force_at_wrong_point"}, [](Scene& s, Knobs& k) {
        k.arm = -1;
        return any<Force>(s);
    });
    const auto has_body_point = [](const Scene& s) {
        return std::ranges::any_of(s.loads, [](const Load& load) {
            const auto* f = std::get_if<Force>(&load);
            return f && f->point_frame == Frame::body;
        });
    };
    engine("arm of the force not rotated", {"force_at_wrong_point"}, [=](Scene& s, Knobs& k) {
        k.arm_in_world = true;
        return has_body_point(s);
    });
    engine("point of the force in the world", {"force_at_wrong_point"}, [=](Scene& s, Knobs&) {
        const bool means = has_body_point(s);
        change_each<Force>(s, [](Force& f) { f.point_frame = Frame::world; });
        return means;
    });
    engine("spring in other axes", {"spring_in_other_axes"}, [=](Scene& s, Knobs& k) {
        k.spring_in_world = true;
        return any<Spring>(s) && spins(s);
    });
    engine("drag in other axes", {"drag_in_other_axes"}, [=](Scene& s, Knobs& k) {
        k.drag_in_world = true;
        return any<Drag>(s) && spins(s);
    });
    engine("impulse missing", {"impulse_missing"},
           [](Scene& s, Knobs&) { return change_each<Impulse>(s, [](Impulse& i) { i.vector = {}; }); });
    engine("impulse at the wrong point", {"impulse_at_wrong_point"}, [](Scene& s, Knobs&) {
        const V3 c = s.body.center_of_mass;
        return change_each<Impulse>(s, [&](Impulse& i) { i.point = c; }) && !s.pivot;
    });
    engine("spring missing", {"spring_missing"},
           [](Scene& s, Knobs&) { return change_each<Spring>(s, [](Spring& p) { p.stiffness = 0; }); });
    engine("spring reversed", {"spring_reversed"},
           [](Scene& s, Knobs&) { return change_each<Spring>(s, [](Spring& p) { p.stiffness *= -1; }); });
    engine("drag missing", {"drag_missing"}, [](Scene& s, Knobs&) {
        return change_each<Drag>(s, [](Drag& d) { d.rotational = {}, d.translational = 0; });
    });

    using Tensor = Knobs::Tensor;
    const auto tensor = [&](std::string name, std::string word, Tensor kind) {
        engine(std::move(name), {std::move(word)}, [=](Scene& s, Knobs& k) {
            k.tensor = kind;
            return turns(s) && asymmetric(s);
        });
    };
    tensor("tensor not turned", "inertia_not_rotated", Tensor::not_turned);
    tensor("tensor turned backwards", "inertia_rotated_backwards", Tensor::turned_back);
    tensor("diagonal of the world tensor", "inertia_diagonal_in_world_axes", Tensor::diagonal);
    tensor("diagonal of the inverse", "inertia_diagonal_in_world_axes", Tensor::inverse_diagonal);
    const auto loads = [&]<class T>(const char* name, T, std::vector<std::string> words, double factor) {
        engine(name, std::move(words), [=](Scene& s, Knobs&) {
            return change_each<T>(s, [&](T& load) { load.vector = factor * load.vector; });
        });
    };
    loads("torque scaled", Torque(), {"torque_scaled"}, 0.35);
    loads("force scaled", Force(), {"force_scaled"}, 0.25);
    loads("force twice", Force(), {"force_twice"}, 2);
    loads("force reversed", Force(), {"force_reversed"}, -1);
    loads("force missing", Force(), {"force_missing"}, 0);
    loads("impulse scaled", Impulse(), {"impulse_scaled"}, 0.4);
    loads("impulse twice", Impulse(), {"impulse_twice"}, 2);
    loads("impulse reversed", Impulse(), {"impulse_reversed"}, -1);
    engine("spring scaled", {"spring_scaled"},
           [](Scene& s, Knobs&) { return change_each<Spring>(s, [](Spring& p) { p.stiffness *= 0.6; }); });
    engine("drag scaled", {"drag_scaled"}, [](Scene& s, Knobs&) {
        return change_each<Drag>(s, [](Drag& d) { d.rotational = 3.0 * d.rotational, d.translational *= 3; });
    });
    engine("drag per step", {"drag_per_step"}, [](Scene& s, Knobs& k) {
        k.drag_each_step = true;
        return any<Drag>(s);
    });
    engine("force in other axes", {"force_in_other_axes"}, [](Scene& s, Knobs&) {
        return change_each<Force>(s, [](Force& f) { f.frame = f.frame == Frame::body ? Frame::world : Frame::body; });
    });
    engine("impulse in other axes", {"impulse_in_other_axes"}, [](Scene& s, Knobs&) {
        return change_each<Impulse>(s,
                                    [](Impulse& i) { i.frame = i.frame == Frame::body ? Frame::world : Frame::body; });
    });
    engine("gravity in body axes", {"gravity_in_body_axes"}, [=](Scene& s, Knobs&) {
        for (Load& load : s.loads)
            if (const auto* g = std::get_if<Gravity>(&load))
                load =
                    Force{s.body.mass * g->acceleration_W, Frame::body, s.body.center_of_mass, Frame::body, g->window};
            else
                continue;
        return any<Force>(s) && spins(s) && s.name != "pushed";
    });
    engine("quaternion in place", {"quaternion_updated_in_place"}, [=](Scene& s, Knobs& k) {
        k.in_place = true;
        return spins(s) && asymmetric(s);
    });
    engine("drag on w", {"drag_applied_to_w"}, [](Scene& s, Knobs& k) {
        k.drag_on_rate = true;
        return any<Drag>(s);
    });
    const auto pushed = [](const Scene& s) { return any<Torque>(s) || any<Force>(s); };
    engine("components clamped in body axes", {"speed_clamped_by_axis"}, [=](Scene& s, Knobs& k) {
        k.speed_limit = 1.4, k.clamp = Knobs::Clamp::body;
        return spins(s) && asymmetric(s);
    });
    // without w, limits of components and of |w| are indistinguishable
    all.back().needs_rates = true;
    engine("components clamped in world axes", {"speed_clamped_by_axis"}, [=](Scene& s, Knobs& k) {
        k.speed_limit = 1.4, k.clamp = Knobs::Clamp::world;
        return spins(s) && asymmetric(s);
    });
    all.back().needs_rates = true;
    engine("damping while coasting", {"damping_while_coasting"}, [=](Scene& s, Knobs& k) {
        k.damping = 0.3, k.coasting_only = true;
        return pushed(s) && spins(s) && s.name == "driven in world axes";
    });

    for (const int substeps : {3, 8}) {
        engine("attitude by the row's first rate, " + std::to_string(substeps) + " substeps",
               {"attitude_turned_by_first_rate"}, [=](Scene& s, Knobs& k) {
                   k.first_rate = true;
                   return spins(s) && asymmetric(s);
               });
        all.back().substeps = substeps;
    }
    for (const int rows : {2, 10})
        engine("q normalised every " + std::to_string(rows) + " rows", {"quaternion_seldom_normalised"},
               [=](Scene& s, Knobs& k) {
                   k.first_order = true, k.normalised_every = rows;
                   return spins(s);
               });
    const auto off_center = [](const Scene& s) {
        return !s.pivot && dot(s.body.center_of_mass, s.body.center_of_mass) > 0 && turns(s);
    };
    engine("origin without w x (w x r)", {"origin_without_centripetal_term"}, [=](Scene& s, Knobs& k) {
        k.integrates_origin = true, k.has_centripetal = false;
        return off_center(s);
    });
    engine("origin without dw/dt x r", {"origin_without_euler_term"}, [=](Scene& s, Knobs& k) {
        k.integrates_origin = true, k.has_euler = false;
        return off_center(s);
    });

    const double degrees = 180 / std::numbers::pi;
    const auto rates = [&](std::string name, std::vector<std::string> words, double factor) {
        file(
            std::move(name), std::move(words),
            [=](const Scene& s, TrajectoryFile& f) {
                each_row(f, [&](TrajectoryRow& r) { r.angular_velocity_W = factor * r.angular_velocity_W; });
                return turns(s);
            },
            true);
    };
    rates("w in degrees", {"angular_velocity_in_degrees"}, degrees);
    rates("w in rpm", {"angular_velocity_in_rpm"}, 30 / std::numbers::pi);
    rates("w negated", {"angular_velocity_negated"}, -1);
    file(
        "w in body axes", {"angular_velocity_in_body_axes"},
        [=](const Scene& s, TrajectoryFile& f) {
            each_row(f, [](TrajectoryRow& r) { r.angular_velocity_W = rotate_back(r.q, r.angular_velocity_W); });
            return turns(s) && asymmetric(s);
        },
        true);
    file("q conjugated", {"inverted_orientation"}, [](const Scene& s, TrajectoryFile& f) {
        each_row(f, [](TrajectoryRow& r) { r.q = conjugate(r.q); });
        return turns(s);
    });
    file("q scalar last", {"scalar_last_quaternion"}, [](const Scene& s, TrajectoryFile& f) {
        each_row(f, [](TrajectoryRow& r) { r.q = {r.q.x, r.q.y, r.q.z, r.q.w}; });
        return turns(s);
    });
    const auto axes = [&](std::string name, Axes there) {
        file(std::move(name), {"other_axes"}, [=](const Scene& s, TrajectoryFile& f) {
            each_row(f, [&](TrajectoryRow& r) {
                r.q = quaternion_to(there, r.q), r.angular_velocity_W = pseudovector_to(there, r.angular_velocity_W);
                r.position_W = vector_to(there, r.position_W), r.velocity_W = vector_to(there, r.velocity_W);
            });
            return turns(s) && asymmetric(s);
        });
    };
    axes("written y-up", Axes::y_up_right);
    axes("written y-up, left-handed", Axes::y_up_left);
    axes("written left-handed", Axes::z_up_left);
    const auto flies = [](const Scene& s) { return moves(s); };
    file("centimetres", {"lengths_in_centimetres"}, [=](const Scene& s, TrajectoryFile& f) {
        each_row(f, [](TrajectoryRow& r) { r.position_W = 100.0 * r.position_W, r.velocity_W = 100.0 * r.velocity_W; });
        return flies(s);
    });
    file("v negated", {"velocity_negated"}, [=](const Scene& s, TrajectoryFile& f) {
        each_row(f, [](TrajectoryRow& r) { r.velocity_W = -r.velocity_W; });
        return flies(s);
    });
    file("origin for centre of mass", {"origin_for_center_of_mass"}, [](const Scene& s, TrajectoryFile& f) {
        const V3 c = s.body.center_of_mass;
        each_row(f, [&](TrajectoryRow& r) { r.position_W = r.position_W - rotate(r.q, c); });
        return dot(c, c) > 0 && turns(s);
    });
    const auto velocity_of_origin = [](TrajectoryRow& r, const V3& c) {
        r.velocity_W = r.velocity_W - cross(r.angular_velocity_W, rotate(r.q, c));
    };
    file("velocity of the origin", {"velocity_of_origin"}, [=](const Scene& s, TrajectoryFile& f) {
        each_row(f, [&](TrajectoryRow& r) { velocity_of_origin(r, s.body.center_of_mass); });
        return off_center(s);
    });
    file("position and velocity of the origin", {"origin_for_center_of_mass"}, [=](const Scene& s, TrajectoryFile& f) {
        const V3 c = s.body.center_of_mass;
        each_row(f, [&](TrajectoryRow& r) {
            velocity_of_origin(r, c);
            r.position_W = r.position_W - rotate(r.q, c);
        });
        return off_center(s);
    });
    // mean rate over the interval that ends at each row; the first row uses that of the second
    const auto differenced = [](TrajectoryFile& f, bool in_body) {
        std::vector<V3> means(f.rows.size());
        for (std::size_t k = 1; k < f.rows.size(); ++k) {
            const Quaternion<double> turn =
                in_body ? conjugate(f.rows[k - 1].q) * f.rows[k].q : f.rows[k].q * conjugate(f.rows[k - 1].q);
            const V3 axis(turn.x, turn.y, turn.z);
            const double sine = std::sqrt(dot(axis, axis)), angle = 2 * std::atan2(sine, std::abs(turn.w));
            means[k] = (sine > 0 ? std::copysign(angle / sine, turn.w) / (f.rows[k].t - f.rows[k - 1].t) : 0.0) * axis;
        }
        means[0] = means[1];
        for (std::size_t k = 0; k < f.rows.size(); ++k) f.rows[k].angular_velocity_W = means[k];
        return true;
    };
    file(
        "w differenced in body axes", {"angular_velocity_in_body_axes"},
        [=](const Scene& s, TrajectoryFile& f) { return differenced(f, true) && turns(s) && asymmetric(s); }, true);
    file("one row late", {"one_row_late"}, [](const Scene& s, TrajectoryFile& f) {
        for (std::size_t k = f.rows.size(); k-- > 1;) {
            const double t = f.rows[k].t;
            f.rows[k] = f.rows[k - 1], f.rows[k].t = t;
        }
        return turns(s);
    });
    file("first step missing", {"one_row_early"}, [](const Scene& s, TrajectoryFile& f) {
        for (std::size_t k = 0; k + 1 < f.rows.size(); ++k) {
            const double t = f.rows[k].t;
            f.rows[k] = f.rows[k + 1], f.rows[k].t = t;
        }
        f.rows.pop_back();
        return turns(s);
    });
    return all;
}

/// Engines without a fault. They must not get a diagnosis.
inline std::vector<Fault> sound_engines() {
    std::vector<Fault> all;
    const auto add = [&](std::string name, int substeps, std::function<bool(Scene&, Knobs&)> f) {
        all.push_back({std::move(name), {}, std::move(f), {}, false, substeps});
        all.back().file = [](const Scene&, TrajectoryFile&) { return true; };
    };
    add("sound", 1, [](Scene&, Knobs&) { return true; });
    add("sound, 4 steps per row", 4, [](Scene&, Knobs&) { return true; });
    add("sound, integrates the origin", 1, [](Scene& s, Knobs& k) {
        k.integrates_origin = true;
        return !s.pivot && dot(s.body.center_of_mass, s.body.center_of_mass) > 0;
    });
    return all;
}

/// Pairs of faults that one engine and its file have at the same time.
inline std::vector<std::array<std::string, 2>> pairs_of_faults() {
    return {
        {"gyroscopic term missing", "damping left on"},
        {"gyroscopic term missing", "half rate"},
        {"gyroscopic term missing", "speed clamped"},
        {"gyroscopic term missing", "one row late"},
        {"gyroscopic term reversed", "impulse missing"},
        {"gravity twice", "w in degrees"},
        {"gravity missing", "linear damping"},
        {"gravity reversed", "origin for centre of mass"},
        {"start negated", "torque missing"},
        {"start's w in world axes", "gyroscopic term missing"},
        {"start in degrees", "force missing"},
        {"moments x, y exchanged", "w in body axes"},
        {"torque in other axes", "q scalar last"},
        {"damping left on", "q conjugated"},
        {"drag missing", "w negated"},
        {"spring missing", "written y-up"},
    };
}

/// Thirteen scenes of 2 s each.
inline std::vector<Scene> scenes() {
    std::vector<Scene> all;
    const auto scene = [&](std::string name) -> Scene& {
        Scene& s = all.emplace_back();
        s.name = std::move(name), s.duration = 2;
        s.body.mass = 2, s.body.inertia_B = diagonal(V3(0.4, 0.7, 1.0));
        s.initial.angular_velocity = {1.1, 2.3, 0.7};
        s.initial.orientation = {0.8, 0.48, 0, 0.36};
        return s;
    };
    scene("free");
    scene("level").initial.orientation = {};
    {
        Scene& s = scene("products");
        s.body.inertia_B[0][1] = s.body.inertia_B[1][0] = 0.09, s.body.inertia_B[1][2] = s.body.inertia_B[2][1] = -0.13;
        s.body.inertia_B[0][2] = s.body.inertia_B[2][0] = 0.05;
    }
    {
        Scene& s = scene("fast");
        s.initial.angular_velocity = {0.5, 9, 1};
    }
    {
        Scene& s = scene("heavy");
        s.pivot = V3(0, 0, 0), s.body.center_of_mass = {0.05, -0.02, 0.3};
        s.loads.push_back(Gravity{{0, 0, -9.81}, {}});
        s.initial.angular_velocity = {0.4, 0.8, 6};
    }
    {
        Scene& s = scene("driven in body axes");
        s.loads.push_back(Torque{{0.6, -0.9, 0.4}, Frame::body, {}});
    }
    {
        Scene& s = scene("driven in world axes");
        s.loads.push_back(Torque{{0.5, 0.7, -0.8}, Frame::world, {0.3, 1.6}});
    }
    {
        Scene& s = scene("damped");
        s.loads.push_back(Drag{{0.2, 0.3, 0.25}, 0.4, {}});
        s.initial.velocity_W = {2, 1, 0.5};
    }
    {
        Scene& s = scene("sprung");
        s.loads.push_back(Spring{5, {0.96, 0, 0.28, 0}, {}});
    }
    {
        Scene& s = scene("thrown");
        s.loads.push_back(Gravity{{0, 0, -9.81}, {}});
        s.initial.velocity_W = {3, -1, 6}, s.initial.position_W = {0.5, 0.2, 1};
        s.body.center_of_mass = {0.1, 0.05, -0.2};
    }
    {
        Scene& s = scene("pushed");
        s.loads.push_back(Force{{1, 0.5, 2}, Frame::body, {0.2, -0.1, 0.1}, Frame::body, {}});
        s.loads.push_back(Gravity{{0, 0, -1.6}, {}});
        s.initial.velocity_W = {1, 0.5, 2};
    }
    {
        Scene& s = scene("struck");
        s.loads.push_back(Impulse{{1.5, -1, 2}, Frame::world, {0.3, 0.2, -0.1}, Frame::body, 0.75});
        s.initial.velocity_W = {1, 2, 0.5};
    }
    {
        Scene& s = scene("off centre");
        s.body.center_of_mass = {-0.15, 0.1, 0.2};
        s.loads.push_back(Force{{2, 1.5, -1}, Frame::body, {0.3, 0.2, -0.1}, Frame::body, {}});
        s.initial.velocity_W = {-1, 0.5, 1.5};
    }
    return all;
}

}  // namespace polhode::battery
