// The loads of a scene on a mechanism: forces and torques on each body, and generalized forces on the joints.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "integrators/maximal/rows.h"

namespace polhode::maximal {

/// Force and torque on a body about its centre of mass, or the corresponding momenta. Torques are given in two
/// frames.
template <class S>
struct Wrench {
    Vector3<S> force_W;   ///< N
    Vector3<S> torque_W;  ///< N m, world axes
    Vector3<S> torque_B;  ///< N m, additional torque in body axes

    /// Adds `size` times a row, as it acts on the link's second or first body.
    void add_to(const Row<S>& row, const S& size) {
        force_W = force_W + size * row.force_W;
        torque_B = torque_B + size * row.to_B;
    }
    void add_from(const Row<S>& row, const S& size) {
        force_W = force_W - size * row.force_W;
        torque_B = torque_B + size * row.from_B;
    }
};

/// The loads that act during one piece of the motion.
template <class P>
class Loads {
  public:
    Loads() = default;
    /// Selects the loads that act from `begin` (s) on. `mechanism` must outlive this object.
    Loads(const Mechanism<P>& mechanism, double begin) : mechanism_(&mechanism), motors_(mechanism.links.size(), P(0)) {
        for (const Load& load : mechanism.scene().loads) {
            const Window window = window_of(load);
            if (std::holds_alternative<Impulse>(load) || !(window.from <= begin && begin < window.until)) continue;
            if (const auto* motor = std::get_if<Motor>(&load)) {
                for (std::size_t k = 0; k < mechanism.links.size(); ++k)
                    if (mechanism.links[k].is_joint() && mechanism.links[k].name == motor->joint)
                        motors_[k] += P(motor->force);
            } else {
                acting_.push_back(&load);
            }
        }
    }

    void add_motor(std::size_t link, const P& force) { motors_[link] += force; }
    /// The sum of the motors on a joint.
    const P& motor(std::size_t link) const { return motors_[link]; }

    /// Adds the loads on each body. The last placement is the world's.
    template <class S>
    void add(const std::vector<Placement<S>>& at, std::vector<Wrench<S>>& on) const {
        for (const Load* load : acting_) {
            if (const auto* gravity = std::get_if<Gravity>(load)) {
                for (std::size_t b = 0; b < mechanism_->bodies.size(); ++b) {
                    const MaximalBody<P>& body = mechanism_->bodies[b];
                    const P weight = body.mass - body.added_mass;
                    on[b].force_W = on[b].force_W + cast<S>(Vector3<P>(weight * cast<P>(gravity->acceleration_W)));
                }
            } else if (const auto* torque = std::get_if<Torque>(load)) {
                Wrench<S>& wrench = on[mechanism_->number_of(torque->body)];
                Vector3<S>& sum = torque->frame == Frame::body ? wrench.torque_B : wrench.torque_W;
                sum = sum + cast<S>(cast<P>(torque->vector));
            } else if (const auto* force = std::get_if<Force>(load)) {
                add_at_point(*force, at, on);
            } else if (const auto* drag = std::get_if<Drag>(load)) {
                const int b = mechanism_->number_of(drag->body);
                const Vector3<P> c = cast<P>(drag->rotational);
                const Vector3<S>& w = at[b].angular_velocity_B;
                on[b].torque_B = on[b].torque_B - Vector3<S>(c[0] * w[0], c[1] * w[1], c[2] * w[2]);
                on[b].force_W = on[b].force_W - P(drag->translational) * at[b].velocity_W;
            } else if (const auto* spring = std::get_if<Spring>(load)) {
                // q q_rest* rotates the rest attitude to the current one, about an axis in world coordinates.
                const int b = mechanism_->number_of(spring->body);
                const Quaternion<S> turn = at[b].q * conjugate(normalized(cast<P>(spring->rest_orientation)));
                on[b].torque_W = on[b].torque_W - (P(2) * P(spring->stiffness)) * (turn.w * vector_part(turn));
            } else if (const auto* tie = std::get_if<PointSpring>(load)) {
                add_tie(*tie, at, on);
            }
        }
    }

    /// Adds the momenta that the impulses at exactly this time give each body if it were free. Returns whether there
    /// are any.
    bool add_impulses(double time, const std::vector<Placement<P>>& at, std::vector<Wrench<P>>& on) const {
        bool any = false;
        for (const Load& load : mechanism_->scene().loads)
            if (const auto* impulse = std::get_if<Impulse>(&load); impulse && impulse->at == time)
                add_at_point(*impulse, at, on), any = true;
        return any;
    }

  private:
    const Mechanism<P>* mechanism_ = nullptr;
    std::vector<const Load*> acting_;
    std::vector<P> motors_;

    // A force or an impulse.
    template <class S, class AtPoint>
    void add_at_point(const AtPoint& load, const std::vector<Placement<S>>& at, std::vector<Wrench<S>>& on) const {
        const int b = mechanism_->number_of(load.body);
        const Vector3<P> given = cast<P>(load.vector);
        const Vector3<S> F_W = load.frame == Frame::world ? cast<S>(given) : at[b].world(given);
        on[b].force_W = on[b].force_W + F_W;
        if (load.point_frame == Frame::world) {
            const Vector3<S> arm_W = cast<P>(load.point) - at[b].position_W;
            on[b].torque_W = on[b].torque_W + cross(arm_W, F_W);
        } else {
            const Vector3<S> F_B = load.frame == Frame::world ? at[b].body(given) : cast<S>(given);
            on[b].torque_B = on[b].torque_B + cross(mechanism_->arm(b, load.point), F_B);
        }
    }
    // k (d - d0) along the line between two points.
    template <class S>
    void add_tie(const PointSpring& tie, const std::vector<Placement<S>>& at, std::vector<Wrench<S>>& on) const {
        const int first = mechanism_->number_of(tie.first), second = mechanism_->number_of(tie.second);
        const Vector3<P> arm1 = mechanism_->arm(first, tie.first_point),
                         arm2 = mechanism_->arm(second, tie.second_point);
        const Vector3<S> d =
            (at[second].position_W + at[second].world(arm2)) - (at[first].position_W + at[first].world(arm1));
        S scale(P(tie.stiffness));
        if (tie.rest_length != 0)
            scale = scale - P(P(tie.stiffness) * P(tie.rest_length)) / S(square_root(S(dot(d, d))));
        const Vector3<S> pull = scale * d;
        on[first].force_W = on[first].force_W + pull;
        on[first].torque_B = on[first].torque_B + cross(arm1, at[first].body(pull));
        on[second].force_W = on[second].force_W - pull;
        on[second].torque_B = on[second].torque_B - cross(arm2, at[second].body(pull));
    }
};

/// Rows and magnitudes of the forces of a joint's spring, damper and motor. `angles`: the joint coordinates in the
/// state. The last placement is the world's.
template <class P, class S>
std::vector<std::pair<Row<S>, S>> joint_forces(const Mechanism<P>& mechanism, const Loads<P>& loads, std::size_t k,
                                               const std::vector<Placement<S>>& at, const S* angles) {
    const Link<P>& link = mechanism.links[k];
    std::vector<std::pair<Row<S>, S>> forces;
    if (!link.has_spring() && !link.has_damper() && loads.motor(k) == P(0)) return forces;
    const LinkView<P, S> view(link, at[link.from.body], at[link.to.body]);
    if (link.kind == Kind::spherical) {
        forces.emplace_back(view.torque_row(view.spherical_torque_B()), S(P(1)));
        return forces;
    }
    const std::vector<Row<S>> rows = view.coordinate_rows();
    const std::array<S, 2> rates = view.rates();
    for (std::size_t i = 0; i < rows.size(); ++i) {
        S size = S(loads.motor(k)) - link.damping[i] * rates[i];
        if (!(link.stiffness[i] == P(0))) {
            const S x = link.kind == Kind::prismatic ? view.displacement() : angles[link.angles + static_cast<int>(i)];
            size = size - link.stiffness[i] * (x - S(link.rest[i]));
        }
        forces.emplace_back(rows[i], size);
    }
    return forces;
}

/// Adds all forces on each body: loads, and the springs, dampers and motors of the joints.
template <class P, class S>
void add_forces(const Mechanism<P>& mechanism, const Loads<P>& loads, const std::vector<Placement<S>>& at,
                const S* angles, std::vector<Wrench<S>>& on) {
    loads.add(at, on);
    for (std::size_t k = 0; k < mechanism.links.size(); ++k)
        for (const auto& [row, size] : joint_forces(mechanism, loads, k, at, angles)) {
            on[mechanism.links[k].to.body].add_to(row, size);
            on[mechanism.links[k].from.body].add_from(row, size);
        }
}

}  // namespace polhode::maximal
