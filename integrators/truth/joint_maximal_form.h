// Second formulation of a mechanism with limits and friction of joints, written independently: every body in maximal
// coordinates (integrators/maximal). A joint that is held has a row of constraints for its coordinate; the multiplier
// is the force that holds it. Impulses act on the momenta of all bodies and are propagated by the joints' multipliers.
//
// State: that of maximal::System, then the coordinates of the joints with limits or friction, integrated from their
// rates, and the time integrals of the forces that hold joints.
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "integrators/contact/contact_state.h"
#include "integrators/contact/joint_events.h"
#include "integrators/maximal/system.h"
#include "integrators/truth/motion.h"

namespace polhode::truth {

template <class P>
class JointMaximalForm {
  public:
    static constexpr const char* name = "maximal coordinates";
    using System = maximal::System<P>;

    /// `start`: motions of the bodies at t = 0; `coordinates`: of the joints. The scene must outlive the form.
    JointMaximalForm(const Scene& scene, Motions<P> start, std::vector<std::array<P, 2>> coordinates)
        : scene_(&scene),
          start_(std::move(start)),
          coordinates_(std::move(coordinates)),
          joints_(contact::event_joints<P>(scene)),
          free_(scene, start_, std::span<const std::array<P, 2>>(coordinates_)) {}

    const std::vector<contact::EventJoint<P>>& joints() const { return joints_; }
    std::vector<P> initial() const {
        std::vector<P> y(static_cast<std::size_t>(free_.dimension()));
        free_.initial(y.data());
        for (const contact::EventJoint<P>& one : joints_) y.push_back(coordinates_[one.joint][0]);
        return y;
    }
    void enter(double begin, P* y) {
        begin_ = begin;
        system_.reset(), held_ = 0;
        free_.enter(begin, y);
    }
    void select(const std::vector<P>& forces, const std::vector<std::size_t>& held) {
        std::vector<int> locked;
        for (const std::size_t e : held) locked.push_back(static_cast<int>(joints_[e].joint));
        held_ = held.size();
        system_.emplace(*scene_, start_, std::span<const std::array<P, 2>>(coordinates_), maximal::LoopRows::shortest,
                        locked);
        system_->select_loads(begin_);
        for (std::size_t e = 0; e < joints_.size(); ++e) system_->add_motor(joints_[e].joint, forces[e]);
    }

    int dimension() const { return holding_force(held_); }
    int coordinate(std::size_t e) const { return free_.dimension() + static_cast<int>(e); }
    int holding_force(std::size_t k) const {
        return free_.dimension() + static_cast<int>(joints_.size()) + static_cast<int>(k);
    }
    template <class S>
    void derivative(const S* y, S* dy) const {
        const std::vector<S> multipliers = system_->rates(y, dy);
        const std::vector<maximal::Placement<S>> at = system_->placements(y);
        for (std::size_t e = 0; e < joints_.size(); ++e)
            dy[coordinate(e)] = system_->view(system_->mechanism().links[joints_[e].joint], at).rates()[0];
        for (std::size_t k = 0; k < held_; ++k) {
            const int row = system_->dynamics().first_row(scene_->joints.size() + k);
            dy[holding_force(k)] = multipliers[static_cast<std::size_t>(row)];
        }
    }

    std::vector<P> rates(const P* y) const {
        const std::vector<maximal::Placement<P>> at = free_.placements(y);
        std::vector<P> all;
        for (const contact::EventJoint<P>& one : joints_)
            all.push_back(free_.view(free_.mechanism().links[one.joint], at).rates()[0]);
        return all;
    }
    std::vector<P> response(const P* y) const {
        const std::size_t n = joints_.size();
        const std::vector<P> before = rates(y);
        std::vector<P> matrix(n * n);
        for (std::size_t j = 0; j < n; ++j) {
            std::vector<P> pushed(y, y + free_.dimension());
            push(j, P(1), pushed.data());
            const std::vector<P> after = rates(pushed.data());
            for (std::size_t i = 0; i < n; ++i) matrix[i * n + j] = after[i] - before[i];
        }
        return matrix;
    }
    void push(std::size_t e, const P& impulse, P* y) const { free_.push(joints_[e].joint, impulse, y); }
    /// The rate is a function of momenta, which remain as they are; it is zero up to rounding.
    void stop(std::size_t, P*) const {}

    Motions<P> motion(const P* y) const {
        Motions<P> all = free_.motions(y);
        for (Motion<P>& body : all) body.q = normalized(body.q);
        return all;
    }
    std::vector<Reaction<P>> reactions(const P* y) const { return system_->reactions(y); }

    std::vector<contact::Block> blocks(const Scales& scales) const {
        std::vector<contact::Block> all;
        const maximal::Mechanism<P>& mechanism = free_.mechanism();
        for (int b = 0; b < mechanism.world(); ++b) {
            const int first = free_.place(b);
            if (first < 0) continue;
            const maximal::MaximalBody<P>& body = mechanism.bodies[static_cast<std::size_t>(b)];
            const double reach = static_cast<double>(body.reach());
            const double velocity = std::max(scales.velocity, scales.angular_velocity * reach);
            all.push_back({first, 4, 1});
            all.push_back({first + 4, 3, std::max(scales.position, reach)});
            all.push_back({first + 7, 3, static_cast<double>(body.least_moment()) * scales.angular_velocity});
            all.push_back({first + 10, 3, static_cast<double>(body.mass) * velocity});
        }
        for (int i = free_.angles(); i < free_.dimension(); ++i) all.push_back({i, 1, 1});
        return all;
    }

  private:
    const Scene* scene_;
    Motions<P> start_;
    std::vector<std::array<P, 2>> coordinates_;
    std::vector<contact::EventJoint<P>> joints_;
    System free_;                   // no joint is held
    std::optional<System> system_;  // the equations in the current mode
    double begin_ = 0;
    std::size_t held_ = 0;
};

}  // namespace polhode::truth
