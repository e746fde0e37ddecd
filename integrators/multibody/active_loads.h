// Loads on the bodies of a mechanism in maximal coordinates, and the springs, dampers and motors of its joints, as
// forces and torques about the centres of mass in world axes.
//
// ActiveLoads holds the loads of one piece of the motion and adds them to one WorldWrench per body. add_joint_forces()
// adds the spring, damper and motor of a joint; update_coordinates() tracks its angles over whole rotations.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <variant>
#include <vector>

#include "integrators/multibody/moving_bodies.h"

namespace polhode::multibody {

/// Force and torque about the centre of mass, or linear and angular momentum; world axes.
template <class S>
struct WorldWrench {
    Vector3<S> force, torque;

    void add_force_at(const Vector3<S>& arm, const Vector3<S>& f) {
        force = force + f, torque = torque + cross(arm, f);
    }
};

/// The loads that act during one piece of the motion, each number rounded once to S.
template <class S>
class ActiveLoads {
  public:
    ActiveLoads() = default;
    /// Selects the loads that act from time `begin`, s, on.
    ActiveLoads(const maximal::Mechanism<double>& mechanism, double begin) {
        motors_.assign(mechanism.links.size(), S(0));
        for (const Load& load : mechanism.scene().loads) {
            const Window window = window_of(load);
            if (std::holds_alternative<Impulse>(load) || !(window.from <= begin && begin < window.until)) continue;
            add_load(mechanism, load);
        }
    }

    /// Sum of the motors on a joint: N m or N.
    S motor(std::size_t link) const { return motors_.empty() ? S(0) : motors_[link]; }

    /// Adds the loads on each body.
    void add_wrenches(const std::vector<MovingBody<S>>& bodies, std::vector<WorldWrench<S>>& wrenches) const {
        if (has_gravity_)
            for (std::size_t b = 0; b < wrenches.size(); ++b)
                wrenches[b].force = wrenches[b].force + bodies[b].mass * gravity_;
        for (const auto& load : torques_) {
            Vector3<S>& sum = wrenches[load.body].torque;
            sum = sum + (load.in_body ? bodies[load.body].R * load.vector : load.vector);
        }
        for (const PointLoad& load : forces_) add_point_load(load, bodies, wrenches);
        for (const auto& drag : drags_) {
            const MovingBody<S>& body = bodies[drag.body];
            const Vector3<S> w = transposed(body.R) * body.w;
            wrenches[drag.body].torque =
                wrenches[drag.body].torque -
                body.R * Vector3<S>(drag.rotational[0] * w[0], drag.rotational[1] * w[1], drag.rotational[2] * w[2]);
            wrenches[drag.body].force = wrenches[drag.body].force - drag.translational * body.v;
        }
        for (const auto& spring : springs_) {
            // q q_rest* rotates the rest attitude into the present one; its axis is in world axes
            const Quaternion<S> turn = bodies[spring.body].q * conjugate(spring.rest);
            wrenches[spring.body].torque =
                wrenches[spring.body].torque - (S(2) * spring.stiffness * turn.w) * vector_part(turn);
        }
        for (const auto& point_spring : point_springs_) {
            const MovingBody<S>&one = bodies[point_spring.first], &two = bodies[point_spring.second];
            const Vector3<S> r1 = one.R * point_spring.arm_first, r2 = two.R * point_spring.arm_second,
                             d = (two.x + r2) - (one.x + r1);
            S scale = point_spring.stiffness;
            if (point_spring.rest_length != S(0))
                scale = scale - point_spring.stiffness * point_spring.rest_length / length(d);
            const Vector3<S> pull = scale * d;
            wrenches[point_spring.first].add_force_at(r1, pull);
            wrenches[point_spring.second].add_force_at(r2, -pull);
        }
    }

    /// Adds the momenta of the impulses at exactly this time, each body as if free. Returns whether there are any.
    static bool add_impulses(const maximal::Mechanism<double>& mechanism, double time,
                             const std::vector<MovingBody<S>>& bodies, std::vector<WorldWrench<S>>& wrenches) {
        bool any = false;
        for (const Load& load : mechanism.scene().loads)
            if (const auto* impulse = std::get_if<Impulse>(&load); impulse && impulse->at == time)
                add_point_load(make_point_load(mechanism, *impulse), bodies, wrenches), any = true;
        return any;
    }

  private:
    struct BodyTorque {
        std::size_t body;
        Vector3<S> vector;
        bool in_body;
    };
    struct PointLoad {
        std::size_t body;
        Vector3<S> vector;
        bool in_body;
        Vector3<S> point;  ///< from the centre of mass in body axes, or from the origin in world axes
        bool point_in_body;
    };
    struct BodyDrag {
        std::size_t body;
        Vector3<S> rotational;
        S translational;
    };
    struct BodySpring {
        std::size_t body;
        S stiffness;
        Quaternion<S> rest;
    };
    struct PointSpringLoad {
        std::size_t first, second;
        Vector3<S> arm_first, arm_second;
        S stiffness, rest_length;
    };
    bool has_gravity_ = false;
    Vector3<S> gravity_;
    std::vector<BodyTorque> torques_;
    std::vector<PointLoad> forces_;
    std::vector<BodyDrag> drags_;
    std::vector<BodySpring> springs_;
    std::vector<PointSpringLoad> point_springs_;
    std::vector<S> motors_;

    static std::size_t body_index(const maximal::Mechanism<double>& mechanism, const std::string& name) {
        return static_cast<std::size_t>(mechanism.number_of(name));
    }
    template <class AnyPointLoad>
    static PointLoad make_point_load(const maximal::Mechanism<double>& mechanism, const AnyPointLoad& load) {
        const std::size_t body = body_index(mechanism, load.body);
        const bool in_body = load.point_frame == Frame::body;
        const Vector3<double> point = in_body ? mechanism.arm(static_cast<int>(body), load.point) : load.point;
        return {body, cast<S>(load.vector), load.frame == Frame::body, cast<S>(point), in_body};
    }
    static void add_point_load(const PointLoad& load, const std::vector<MovingBody<S>>& bodies,
                               std::vector<WorldWrench<S>>& wrenches) {
        const MovingBody<S>& body = bodies[load.body];
        const Vector3<S> arm = load.point_in_body ? body.R * load.point : load.point - body.x;
        wrenches[load.body].add_force_at(arm, load.in_body ? body.R * load.vector : load.vector);
    }
    void add_load(const maximal::Mechanism<double>& mechanism, const Load& load) {
        if (const auto* gravity = std::get_if<Gravity>(&load)) {
            has_gravity_ = true, gravity_ = gravity_ + cast<S>(gravity->acceleration_W);
        } else if (const auto* torque = std::get_if<Torque>(&load)) {
            torques_.push_back(
                {body_index(mechanism, torque->body), cast<S>(torque->vector), torque->frame == Frame::body});
        } else if (const auto* force = std::get_if<Force>(&load)) {
            forces_.push_back(make_point_load(mechanism, *force));
        } else if (const auto* drag = std::get_if<Drag>(&load)) {
            drags_.push_back({body_index(mechanism, drag->body), cast<S>(drag->rotational), S(drag->translational)});
        } else if (const auto* spring = std::get_if<Spring>(&load)) {
            springs_.push_back({body_index(mechanism, spring->body), S(spring->stiffness),
                                cast<S>(normalized(spring->rest_orientation))});
        } else if (const auto* motor = std::get_if<Motor>(&load)) {
            for (std::size_t k = 0; k < mechanism.links.size(); ++k)
                if (!mechanism.links[k].closes && mechanism.links[k].name == motor->joint)
                    motors_[k] += S(motor->force);
        } else if (const auto* point_spring = std::get_if<PointSpring>(&load)) {
            const std::size_t first = body_index(mechanism, point_spring->first),
                              second = body_index(mechanism, point_spring->second);
            point_springs_.push_back({first, second,
                                      cast<S>(mechanism.arm(static_cast<int>(first), point_spring->first_point)),
                                      cast<S>(mechanism.arm(static_cast<int>(second), point_spring->second_point)),
                                      S(point_spring->stiffness), S(point_spring->rest_length)});
        }
    }
};

/// The angle equal to `angle` modulo 2 pi that is nearest to `before`.
template <class S>
S nearest_angle(S angle, S before) {
    constexpr S turn = 2 * std::numbers::pi_v<S>;
    return angle + turn * std::round((before - angle) / turn);
}

/// Updates the one or two coordinates of a joint from its bodies: rad, nearest to the previous values; or m.
template <class S>
void update_coordinates(const PairView<S>& at, std::array<S, 2>& coordinate) {
    const JointPair<S>& pair = at.pair;
    if (pair.kind == maximal::Kind::prismatic) {
        coordinate[0] = dot(at.first_axis(), at.gap());
    } else if (pair.kind == maximal::Kind::revolute) {
        const Quaternion<S> J = at.joint();
        coordinate[0] = nearest_angle<S>(2 * std::atan2(dot(vector_part(J), pair.axes_to[0]), J.w), coordinate[0]);
    } else if (pair.kind == maximal::Kind::universal) {
        // the rotation about the first axis moves the second axis from its zero position, and vice versa
        const auto angle = [](const Vector3<S>& axis, const Vector3<S>& rest, const Vector3<S>& now) {
            return std::atan2(dot(cross(axis, rest), now), dot(rest, now) - dot(axis, rest) * dot(axis, now));
        };
        const Quaternion<S> J = at.joint();
        const Vector3<S>&first = pair.axes_to[0], &second = pair.axes_to[1];
        coordinate[0] = nearest_angle<S>(angle(first, second, rotate(J, second)), coordinate[0]);
        coordinate[1] = nearest_angle<S>(-angle(second, first, rotate_back(J, first)), coordinate[1]);
    }
}

/// Adds the forces of a joint's spring, damper and motor to its two bodies. `coordinate`: used by joints with a spring.
template <class S>
void add_joint_forces(const PairView<S>& at, S motor, const std::array<S, 2>& coordinate, WorldWrench<S>& wrench_from,
                      WorldWrench<S>& wrench_to) {
    const JointPair<S>& pair = at.pair;
    const auto twist = [&](const Vector3<S>& torque) {
        wrench_to.torque = wrench_to.torque + torque, wrench_from.torque = wrench_from.torque - torque;
    };
    const auto size = [&](std::size_t i, S rate) {
        return -pair.stiffness[i] * (coordinate[i] - pair.rest[i]) - pair.damping[i] * rate;
    };
    const Vector3<S> relative = at.to.w - at.from.w;
    if (pair.kind == maximal::Kind::spherical) {
        Vector3<S> torque;
        if (pair.has_spring) {
            const Quaternion<S> r = conjugate(pair.rest_orientation) * at.joint();
            torque = at.to.R * Vector3<S>((S(-2) * pair.stiffness[0] * r.w) * vector_part(r));
        }
        twist(torque - pair.damping[0] * relative);
    } else if (pair.kind == maximal::Kind::revolute) {
        const Vector3<S> axis = at.axis_to(0);
        twist((motor + size(0, dot(axis, relative))) * axis);
    } else if (pair.kind == maximal::Kind::universal) {
        // w2 - w1 = e1 x' + e2 y';  t . e1 = Q1, t . e2 = Q2
        const Vector3<S> e1 = at.first_axis(), e2 = at.axis_to(1);
        const S c = dot(e1, e2), scale = 1 / (1 - c * c), along1 = dot(e1, relative), along2 = dot(e2, relative);
        const S Q1 = size(0, scale * (along1 - c * along2)), Q2 = size(1, scale * (along2 - c * along1));
        twist(scale * ((Q1 - c * Q2) * e1 + (Q2 - c * Q1) * e2));
    } else if (pair.kind == maximal::Kind::prismatic) {
        // the force on both bodies acts at the child's point
        const Vector3<S> axis = at.first_axis(), arm_to = at.arm_to(), arm_from = at.to.x + arm_to - at.from.x;
        const S rate = dot(axis, at.to.velocity_at(arm_to) - at.from.velocity_at(arm_from));
        const Vector3<S> force = (motor + size(0, rate)) * axis;
        wrench_to.add_force_at(arm_to, force);
        wrench_from.add_force_at(arm_from, -force);
    }
}

}  // namespace polhode::multibody
