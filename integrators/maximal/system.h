// A mechanism in maximal coordinates as a first-order system dy/dt = f(y), over any scalar.
//
// State: q, p, L and P of each body that can move (momenta in world axes, L about the centre of mass), then the
// angles of revolute and universal joints with a spring, because springs count revolutions, and the coordinates of
// joints that the caller requests. Constraints are enforced
// at acceleration level only. Momenta include the added inertia (Kind::added_inertia). Dynamics computes the
// multipliers, Loads the forces.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "integrators/maximal/loop_rows.h"
#include "motion/body_equations.h"
#include "motion/mechanism_motion.h"
#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode::maximal {

/// Constraint errors of a mechanism.
template <class P>
struct JointGap {
    P point{0};     ///< m: distance of points that should coincide, or error of a distance or slider
    P turn{0};      ///< rad: error of an axis or attitude
    P velocity{0};  ///< m/s and rad/s: constraint velocity
};

/// The first-order system of a mechanism.
template <class P>
class System {
  public:
    static constexpr int body_size = 13;  ///< components per body: q, p, L, P

    /// `start`: the motion of every body at t = 0 before any impulse, in the scene's order: q, angular_velocity_B,
    /// position_W and velocity_W. `coordinates`: those of the joints at t = 0, where they differ from the scene's
    /// (dependent joints). `locked`: indices of joints whose coordinates are locked. `counted`: indices of joints whose
    /// coordinates are components of the state. The scene must outlive this object.
    template <class Start>
    explicit System(const Scene& scene, const Start& start, std::span<const std::array<P, 2>> coordinates = {},
                    LoopRows loops = LoopRows::shortest, std::span<const int> locked = {},
                    std::span<const int> counted = {})
        : mechanism_(std::make_shared<Mechanism<P>>(scene, locked, counted)) {
        for (const auto& body : start)
            start_.push_back({body.q, body.angular_velocity_B, body.position_W, body.velocity_W});
        for (std::size_t k = 0; k < coordinates.size(); ++k) mechanism_->links[k].coordinate = coordinates[k];
        for (int b = 0; b < mechanism_->world(); ++b) {
            place_.push_back(mechanism_->movable(b) ? dimension_ : -1);
            if (mechanism_->movable(b)) dimension_ += body_size;
        }
        angles_ = dimension_;
        dimension_ += mechanism_->turns;
        dynamics_ = std::make_shared<Dynamics<P>>(*mechanism_);
        loads_ = Loads<P>(*mechanism_, 0);
        std::vector<P> y(dimension_, P(0));
        initial(y.data());
        choose_loop_rows(*mechanism_, *dynamics_, placements(y.data()), loops);
    }

    int dimension() const { return dimension_; }
    const Mechanism<P>& mechanism() const { return *mechanism_; }
    const Dynamics<P>& dynamics() const { return *dynamics_; }
    /// Index of a body's first component in y, or -1 if it does not move.
    int place(int body) const { return place_[body]; }
    /// Index in y of the first joint coordinate.
    int angles() const { return angles_; }
    /// The loads of the piece that was entered last.
    const Loads<P>& loads() const { return loads_; }

    void initial(P* y) const {
        for (int b = 0; b < mechanism_->world(); ++b) {
            if (place_[b] < 0) continue;
            const MaximalBody<P>& body = mechanism_->bodies[b];
            put(y, place_[b], start_[b].q);
            put(y, place_[b] + 4, start_[b].position_W);
            put(y, place_[b] + 7, rotate(start_[b].q, body.inertia * start_[b].angular_velocity_B));
            put(y, place_[b] + 10, body.mass * start_[b].velocity_W);
        }
        for (const Link<P>& link : mechanism_->links)
            for (int i = 0; link.angles >= 0 && i < link.coordinates(); ++i)
                y[angles_ + link.angles + i] = link.coordinate[i];
    }

    /// Selects the loads that act from `begin` (s) on.
    void select_loads(double begin) { loads_ = Loads<P>(*mechanism_, begin); }
    /// Adds a force on the coordinate of a joint to the loads that are selected.
    void add_motor(std::size_t joint, const P& force) { loads_.add_motor(joint, force); }
    /// Applies an impulse on the coordinate of a joint of one coordinate to y.
    void push(std::size_t joint, const P& impulse, P* y) const {
        const std::vector<Placement<P>> at = placements(y);
        const Link<P>& link = mechanism_->links[joint];
        const Row<P> row = view(link, at).coordinate_rows()[0];
        std::vector<Wrench<P>> given(at.size());
        given[static_cast<std::size_t>(link.to.body)].add_to(row, impulse);
        given[static_cast<std::size_t>(link.from.body)].add_from(row, impulse);
        add_impulses(at, std::move(given), y);
    }
    /// Selects the loads that act from `begin` (s) on, and applies the impulses at that time to y, propagated through
    /// all joints.
    void enter(double begin, P* y) {
        loads_ = Loads<P>(*mechanism_, begin);
        const std::vector<Placement<P>> at = placements(y);
        std::vector<Wrench<P>> given(at.size());
        if (loads_.add_impulses(begin, at, given)) add_impulses(at, std::move(given), y);
    }

    template <class S>
    void derivative(const S* y, S* dy) const {
        rates(y, dy);
    }
    /// Computes dy and returns the multipliers.
    template <class S>
    std::vector<S> rates(const S* y, S* dy) const {
        const std::vector<Placement<S>> at = placements(y);
        const Rows<S> rows = dynamics_->constraints(at);
        std::vector<Wrench<S>> on(at.size());
        add_forces(*mechanism_, loads_, at, y + angles_, on);
        std::vector<S> lambda = dynamics_->multipliers(at, rows, on);
        dynamics_->add_constraint_forces(rows, lambda, on);
        put_rates(at, on, dy);
        return lambda;
    }
    /// Computes the rates of a state from its placements and all that acts on the bodies.
    template <class S>
    void put_rates(const std::vector<Placement<S>>& at, const std::vector<Wrench<S>>& on, S* dy) const {
        for (int b = 0; b < mechanism_->world(); ++b) {
            if (place_[b] < 0) continue;
            const Vector3<S> h = (P(1) / P(2)) * at[b].angular_velocity_B;
            put(dy, place_[b], at[b].q * Quaternion<S>{S(P(0)), h[0], h[1], h[2]});
            put(dy, place_[b] + 4, at[b].velocity_W);
            put(dy, place_[b] + 7, on[b].torque_W + at[b].world(on[b].torque_B));
            put(dy, place_[b] + 10, on[b].force_W);
        }
        for (const Link<P>& link : mechanism_->links) {
            if (link.angles < 0) continue;
            const std::array<S, 2> rates = view(link, at).rates();
            for (int i = 0; i < link.coordinates(); ++i) dy[angles_ + link.angles + i] = rates[i];
        }
    }

    /// The motion of every body, in the scene's order.
    std::vector<BodyMotion<P>> motions(const P* y) const {
        const std::vector<Placement<P>> at = placements(y);
        std::vector<BodyMotion<P>> all = start_;
        for (int b = 0; b < mechanism_->world(); ++b) {
            if (place_[b] < 0) continue;
            all[b] = {at[b].q, at[b].angular_velocity_B, at[b].position_W, at[b].velocity_W};
        }
        return all;
    }

    /// Forces and torques of each joint, then each loop, on its second body, in the scene's order, under the loads of
    /// the piece that was entered last. They include springs, dampers and motors. `lambda`: the multipliers, if
    /// already known. `further`: what else acts on each body; may be empty.
    std::vector<Reaction<P>> reactions(const P* y, const P* lambda = nullptr,
                                       const std::vector<Wrench<P>>& further = {}) const;

    /// Constraint errors of the state.
    JointGap<P> gap(const P* y) const;

    /// Placements of all bodies, with the world last.
    template <class S>
    std::vector<Placement<S>> placements(const S* y) const {
        std::vector<Placement<S>> at(place_.size() + 1);
        at.back().axes = diagonal(Vector3<S>(S(P(1)), S(P(1)), S(P(1))));
        at.back().q = {S(P(1)), S(P(0)), S(P(0)), S(P(0))};
        for (std::size_t b = 0; b < place_.size(); ++b) {
            const MaximalBody<P>& body = mechanism_->bodies[b];
            if (place_[b] < 0) {
                at[b].q = cast<S>(start_[b].q);
                at[b].axes = cast<S>(rotation_matrix(start_[b].q));
                at[b].position_W = cast<S>(start_[b].position_W);
                continue;
            }
            at[b].q = quaternion_at(y, place_[b]);
            at[b].axes = rotation_matrix(at[b].q);
            at[b].position_W = vector_at(y, place_[b] + 4);
            at[b].angular_velocity_B = body.inverse_inertia * at[b].body(vector_at(y, place_[b] + 7));
            at[b].velocity_W = (P(1) / body.mass) * vector_at(y, place_[b] + 10);
        }
        return at;
    }

    /// A link with the placements of its two bodies.
    template <class S>
    LinkView<P, S> view(const Link<P>& link, const std::vector<Placement<S>>& at) const {
        return {link, at[link.from.body], at[link.to.body]};
    }

  private:
    // Adds momenta that each body would get if it were free, and the impulses of all joints.
    void add_impulses(const std::vector<Placement<P>>& at, std::vector<Wrench<P>> given, P* y) const {
        const Rows<P> rows = dynamics_->constraints(at);
        dynamics_->add_constraint_forces(rows, dynamics_->impulses(at, rows, given), given);
        for (int b = 0; b < mechanism_->world(); ++b) {
            if (place_[b] < 0) continue;
            put(y, place_[b] + 7, vector_at(y, place_[b] + 7) + given[b].torque_W + at[b].world(given[b].torque_B));
            put(y, place_[b] + 10, vector_at(y, place_[b] + 10) + given[b].force_W);
        }
    }

    std::shared_ptr<Mechanism<P>> mechanism_;  // not moved: dynamics and loads refer to it
    std::shared_ptr<Dynamics<P>> dynamics_;
    Loads<P> loads_;
    std::vector<BodyMotion<P>> start_;
    std::vector<int> place_;
    int dimension_ = 0, angles_ = 0;
};

template <class P>
std::vector<Reaction<P>> System<P>::reactions(const P* y, const P* given, const std::vector<Wrench<P>>& further) const {
    const std::vector<Placement<P>> at = placements(y);
    const Rows<P> rows = dynamics_->constraints(at);
    std::vector<Wrench<P>> on(at.size());
    add_forces(*mechanism_, loads_, at, y + angles_, on);
    for (std::size_t b = 0; b < further.size(); ++b) {
        on[b].force_W = on[b].force_W + further[b].force_W;
        on[b].torque_W = on[b].torque_W + further[b].torque_W;
        on[b].torque_B = on[b].torque_B + further[b].torque_B;
    }
    const std::vector<P> lambda =
        given ? std::vector<P>(given, given + dynamics_->rows()) : dynamics_->multipliers(at, rows, on);
    dynamics_->add_constraint_forces(rows, lambda, on);

    const std::size_t count = static_cast<std::size_t>(
        std::ranges::count_if(mechanism_->links, [](const Link<P>& link) { return link.is_in_scene(); }));
    std::vector<Reaction<P>> all(count);
    for (std::size_t k = 0; k < count; ++k) {
        Reaction<P>& reaction = all[k];
        const auto add = [&](const Row<P>& row, const P& size) {
            reaction.force_W = reaction.force_W + size * row.force_W;
            reaction.torque_W = reaction.torque_W + size * row.torque_W;
        };
        for (std::size_t i = 0; i < rows[k].size(); ++i) add(rows[k][i], lambda[dynamics_->first_row(k) + i]);
        for (const auto& [row, size] : joint_forces(*mechanism_, loads_, k, at, y + angles_)) add(row, size);
    }
    for (std::size_t k = count; k < mechanism_->links.size(); ++k) {
        if (mechanism_->links[k].joint < 0) continue;
        Reaction<P>& reaction = all[static_cast<std::size_t>(mechanism_->links[k].joint)];
        for (std::size_t i = 0; i < rows[k].size(); ++i) {
            const P& size = lambda[dynamics_->first_row(k) + i];
            reaction.force_W = reaction.force_W + size * rows[k][i].force_W;
            reaction.torque_W = reaction.torque_W + size * rows[k][i].torque_W;
        }
    }
    // Bodies at rest in the world: the joint balances all other loads on the body, from the leaves inwards.
    std::vector<std::size_t> resting;
    for (std::size_t k = 0; k < count; ++k)
        if (const Link<P>& link = mechanism_->links[k]; !link.closes && !mechanism_->movable(link.to.body))
            resting.push_back(k);
    std::stable_sort(resting.begin(), resting.end(), [&](std::size_t a, std::size_t b) {
        return mechanism_->depth[mechanism_->links[a].to.body] > mechanism_->depth[mechanism_->links[b].to.body];
    });
    for (const std::size_t k : resting) {
        const Link<P>& link = mechanism_->links[k];
        const int child = link.to.body, parent = link.from.body;
        const Vector3<P> arm_W = at[child].world(link.to.arm_B);
        const Vector3<P> about_center = on[child].torque_W + at[child].world(on[child].torque_B);
        all[k] = {-on[child].force_W, cross(arm_W, on[child].force_W) - about_center};
        const Vector3<P> from_parent = at[child].position_W + arm_W - at[parent].position_W;
        on[parent].force_W = on[parent].force_W - all[k].force_W;
        on[parent].torque_W = on[parent].torque_W - all[k].torque_W - cross(from_parent, all[k].force_W);
    }
    return all;
}

template <class P>
JointGap<P> System<P>::gap(const P* y) const {
    const std::vector<Placement<P>> at = placements(y);
    JointGap<P> worst;
    const auto raise = [](P& largest, const P& value) {
        const P size = value < P(0) ? P(-value) : value;
        if (largest < size) largest = size;
    };
    for (const Link<P>& link : mechanism_->links) {
        if (!link.is_in_scene()) continue;
        const Placement<P>&from = at[link.from.body], &to = at[link.to.body];
        const Vector3<P> apart = view(link, at).apart();
        if (link.kind == Kind::distance) {
            raise(worst.point, length(apart) - link.length);
        } else if (link.kind == Kind::prismatic) {
            for (const Vector3<P>& t : link.across_from) raise(worst.point, dot(t, from.body(apart)));
        } else {
            raise(worst.point, length(apart));
        }
        if (link.kind == Kind::prismatic || link.kind == Kind::fixed) {
            const Quaternion<P> turn = conjugate(from.q * link.orientation) * to.q;
            raise(worst.turn, P(2) * length(vector_part(turn)));
        } else if (link.kind == Kind::revolute) {
            for (const Vector3<P>& u : link.across_from)
                raise(worst.turn, dot(from.world(u), to.world(link.axes_to[0])));
        } else if (link.kind == Kind::universal) {
            raise(worst.turn, dot(from.world(link.axis_from), to.world(link.axes_to[1])) - link.between);
        }
    }
    for (const P& slip : dynamics_->velocity_errors(at, dynamics_->constraints(at))) raise(worst.velocity, slip);
    return worst;
}

}  // namespace polhode::maximal
