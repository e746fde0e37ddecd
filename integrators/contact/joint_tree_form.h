// A mechanism in joint coordinates with limits and friction of joints, for JointDriver (follow_joints.h). Friction of a
// moving joint is a constant force on its coordinate. A joint that is held is locked; the multiplier of the lock is the
// force that holds it.
//
// A joint with a prescribed motion is a row of constraints with a given acceleration. Impulses do not change its rate.
//
// State: coordinates and rates of the tree, the time if motions are prescribed, then the time integrals of the forces
// that hold joints.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>
#include <vector>

#include "integrators/contact/contact_state.h"
#include "integrators/contact/joint_events.h"
#include "integrators/contact/prescribed_motions.h"
#include "motion/mechanism_motion_of.h"
#include "motion/tree.h"

namespace polhode::contact {

template <class P>
class JointTreeForm {
  public:
    static constexpr const char* name = "joint coordinates";

    /// The scene must outlive the form.
    explicit JointTreeForm(const Scene& scene)
        : scene_(&scene),
          tree_(scene, bodies_mass_properties<P>(scene)),
          joints_(event_joints<P>(scene)),
          motions_(scene) {
        for (const EventJoint<P>& one : joints_) links_.push_back(tree_.links().link_of_joint[one.joint]);
        for (std::size_t k = 0; k < motions_.size(); ++k)
            driven_.push_back(tree_.links().link_of_joint[motions_.joint(k)]);
        if (driven_.empty()) return;
        std::vector<typename Tree<P>::Start> starts;
        const auto states = motions_.states(P(0));
        for (std::size_t k = 0; k < driven_.size(); ++k)
            starts.push_back({driven_[k], states[k].coordinate, states[k].rate});
        tree_.restart(starts);
    }

    const std::vector<EventJoint<P>>& joints() const { return joints_; }
    std::vector<P> initial() const {
        std::vector<P> y(static_cast<std::size_t>(tree_.dimension()));
        tree_.initial(y.data());
        if (!driven_.empty()) y.push_back(P(0));
        return y;
    }
    /// Selects the loads from `begin` (s) on and applies the impulses there. All joints are free then.
    void enter(double begin, P* y) {
        begin_ = begin;
        locked_.clear(), held_ = 0;
        tree_.lock({}, driven_);
        tree_.set_loads(*scene_, begin);
        if (driven_.empty()) {
            tree_.apply_impulses(*scene_, begin, y);
            return;
        }
        y[tree_.dimension()] = P(begin);
        std::vector<P> longer = with_accelerations(y);
        tree_.apply_impulses(*scene_, begin, longer.data());
        std::copy_n(longer.begin(), tree_.dimension(), y);
    }
    /// Sets a constant force on each joint, and the joints that are held.
    void select(const std::vector<P>& forces, const std::vector<std::size_t>& held) {
        tree_.set_loads(*scene_, begin_);
        for (std::size_t e = 0; e < links_.size(); ++e)
            if (!(forces[e] == P(0))) tree_.add_motor(links_[e], forces[e]);
        std::vector<int> locked;
        for (const std::size_t e : held) locked.push_back(links_[e]);
        locked_ = std::move(locked);
        tree_.lock(locked_, driven_);
        held_ = held.size();
    }

    int dimension() const { return holding_force(held_); }
    /// Index of a joint's coordinate, and of the integral of the k-th force that holds a joint.
    int coordinate(std::size_t e) const { return link(e).coordinate; }
    int holding_force(std::size_t k) const {
        return tree_.dimension() + (driven_.empty() ? 0 : 1) + static_cast<int>(k);
    }
    template <class S>
    void derivative(const S* y, S* dy) const {
        if (driven_.empty()) {
            tree_.derivative(y, dy);
        } else {
            const std::vector<S> longer = with_accelerations(y);
            tree_.derivative(longer.data(), dy);
            dy[tree_.dimension()] = S(P(1));
        }
        const TreeWork<S>& at = tree_.template work<S>();
        // the multipliers of loops and couplings come first, those of driven joints last
        const std::size_t first = tree_.independent_loop_rows() - held_ - driven_.size();
        for (std::size_t k = 0; k < held_; ++k) dy[holding_force(k)] = at.multipliers[first + k];
    }

    std::vector<P> rates(const P* y) const {
        std::vector<P> all;
        for (std::size_t e = 0; e < links_.size(); ++e) all.push_back(y[link(e).rate]);
        return all;
    }
    /// The rates of all joints after a unit impulse on each joint, minus those before: row i, joint j.
    std::vector<P> response(const P* y) {
        const std::size_t n = links_.size();
        std::vector<P> matrix(n * n);
        for (std::size_t j = 0; j < n; ++j) {
            const std::vector<P> change = unit_response(j, y);
            for (std::size_t i = 0; i < n; ++i)
                matrix[i * n + j] = change[static_cast<std::size_t>(link(i).rate - tree_.links().coordinates)];
        }
        return matrix;
    }
    /// Applies an impulse on a joint's coordinate.
    void push(std::size_t e, const P& impulse, P* y) {
        const std::vector<P> change = unit_response(e, y);
        for (std::size_t k = 0; k < change.size(); ++k) {
            P& rate = y[static_cast<std::size_t>(tree_.links().coordinates) + k];
            rate = rate + impulse * change[k];
        }
    }
    /// Moves y back onto the constraints of loops and couplings, from which rounding in binary64 leads away.
    void project(P* y) requires std::is_same_v<P, double> {
        if (scene_->loops.empty() && scene_->couplings.empty()) return;
        tree_.lock({});
        tree_.project(y);
        tree_.lock(locked_, driven_);
    }
    /// Sets the rate of a joint that is at rest up to rounding to zero.
    void stop(std::size_t e, P* y) const { y[link(e).rate] = P(0); }

    std::vector<BodyMotion<P>> motion(const P* y) const {
        std::vector<BodyMotion<P>> all = tree_.motions(y);
        for (BodyMotion<P>& body : all) body.q = normalized(body.q);
        return all;
    }
    std::vector<Reaction<P>> reactions(const P* y) const {
        return driven_.empty() ? tree_.reactions(*scene_, y) : tree_.reactions(*scene_, with_accelerations(y).data());
    }
    std::vector<std::array<P, 2>> joint_coordinates(const P* y) const { return tree_.joint_coordinates(y); }

    std::vector<Block> blocks(const std::vector<double>& scales) const {
        std::vector<Block> all;
        const auto note = [&](int first, int size) {
            all.push_back({first, size, scales[static_cast<std::size_t>(first)]});
        };
        for (const Link<P>& one : tree_.links().links) {
            if (one.kind == LinkJoint::free) {
                note(one.coordinate, 4), note(one.coordinate + 4, 3);
                note(one.rate, 3), note(one.rate + 3, 3);
            } else {
                note(one.coordinate, one.coordinates()), note(one.rate, one.rates());
            }
        }
        return all;
    }

    /// Increases the scales of the state y at the start of a mode. With the scale x of a coordinate, its rate has at
    /// least the scales x / duration and sqrt(acceleration x). Prescribed coordinates and rates have their largest
    /// lengths over the run.
    void widen_scales(const P* y, std::vector<double>& scales) const {
        const auto widen = [&](int i, double size) {
            double& scale = scales[static_cast<std::size_t>(i)];
            scale = std::max(scale, std::abs(size));
        };
        std::vector<P> dy(static_cast<std::size_t>(dimension()));
        derivative(y, dy.data());
        for (const Link<P>& one : tree_.links().links)
            for (int i = 0; one.kind != LinkJoint::free && i < std::min(one.rates(), one.coordinates()); ++i) {
                const double size = scales[static_cast<std::size_t>(one.coordinate) + static_cast<std::size_t>(i)];
                const P& acceleration = dy[static_cast<std::size_t>(one.rate) + static_cast<std::size_t>(i)];
                widen(one.rate + i, std::sqrt(std::abs(static_cast<double>(acceleration)) * size));
                widen(one.rate + i, size / scene_->duration);
            }
        constexpr int points = 200;
        for (int i = 0; !driven_.empty() && i <= points; ++i) {
            const auto states = motions_.states(P(scene_->duration * i / points));
            for (std::size_t k = 0; k < driven_.size(); ++k) {
                const Link<P>& one = tree_.links().links[static_cast<std::size_t>(driven_[k])];
                widen(one.coordinate, static_cast<double>(states[k].coordinate));
                widen(one.rate, static_cast<double>(states[k].rate));
            }
        }
    }

  private:
    const Scene* scene_;
    Tree<P> tree_;
    std::vector<EventJoint<P>> joints_;
    PrescribedMotions<P> motions_;
    std::vector<int> links_;   // by event joint
    std::vector<int> locked_;  // links that are held
    std::vector<int> driven_;  // links with prescribed motions
    double begin_ = 0;
    std::size_t held_ = 0;

    // The state of the tree and the accelerations of driven links.
    template <class S>
    std::vector<S> with_accelerations(const S* y) const {
        const int n = tree_.dimension();
        std::vector<S> longer(y, y + n);
        for (const S& a : motions_.accelerations(y[n])) longer.push_back(a);
        return longer;
    }
    // The changes of all rates by a unit impulse on an event joint, at constant rates of the driven links. Releases the
    // held joints; the driver selects a mode afterwards.
    std::vector<P> unit_response(std::size_t e, const P* y) {
        tree_.lock({}, driven_);
        return tree_.unit_response(links_[e], driven_.empty() ? y : with_accelerations(y).data());
    }
    const Link<P>& link(std::size_t e) const { return tree_.links().links[static_cast<std::size_t>(links_[e])]; }
};

}  // namespace polhode::contact
