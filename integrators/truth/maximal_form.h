// Second formulation of the reference for a mechanism, written independently so that a sign error in either of the two
// is detected. Every body has all six degrees of freedom in world axes and is constrained by multipliers
// (integrators/maximal). It shares with the first formulation only the algebra, the mass properties and the initial
// state. In multiprecision the drift from the constraints is not visible in any sample.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "integrators/maximal/system.h"
#include "integrators/truth/motion.h"
#include "motion/problem.h"
#include "motion/traced.h"

namespace polhode::truth {

/// The blocks of the state of a mechanism in maximal coordinates. `scales`: estimates over all bodies.
template <class P>
std::vector<Block> maximal_blocks(const maximal::System<P>& system, const Scales& scales) {
    std::vector<Block> all;
    const maximal::Mechanism<P>& mechanism = system.mechanism();
    for (int b = 0; b < mechanism.world(); ++b) {
        const int first = system.place(b);
        if (first < 0) continue;
        // the error of w is the error of L divided by the smallest moment
        const double moment = static_cast<double>(mechanism.bodies[b].least_moment());
        const double mass = static_cast<double>(mechanism.bodies[b].mass);
        // centres that do not move do not determine a scale
        const double reach = static_cast<double>(mechanism.bodies[b].reach());
        const double velocity = std::max(scales.velocity, scales.angular_velocity * reach);
        all.push_back({first, 4, 1});
        all.push_back({first + 4, 3, std::max(scales.position, reach)});
        all.push_back({first + 7, 3, moment * scales.angular_velocity});
        all.push_back({first + 10, 3, mass * velocity});
    }
    for (int i = system.angles(); i < system.dimension(); ++i) all.push_back({i, 1, 1});
    return all;
}

template <class P>
class MaximalForm : public maximal::System<P> {
    using Base = maximal::System<P>;

  public:
    static constexpr const char* name = "maximal coordinates";

    using Base::Base;

    /// Enters the leg as the base class does, then finds the variables that stay constant on it.
    void enter(double begin, P* y) {
        Base::enter(begin, y);
        find_constants(y);
    }

    template <class S>
    void derivative(const S* y, S* dy) const {
        if (constants_.empty()) return Base::derivative(y, dy);
        std::vector<S> seen(y, y + this->dimension());
        for (const auto& [i, value] : constants_) seen[i] = S(value);
        Base::derivative(seen.data(), dy);
    }

    /// `scales`: estimates over all bodies.
    std::vector<Block> blocks(const Scales& scales) const { return maximal_blocks<P>(*this, scales); }

    /// The motion of every body, in the scene's order.
    std::vector<Motion<P>> motion(const P* y) const {
        std::vector<Motion<P>> all;
        for (const BodyMotion<P>& m : this->motions(y))
            all.push_back({normalized(m.q), m.angular_velocity_B, m.position_W, m.velocity_W});
        return all;
    }

  private:
    std::vector<std::pair<int, P>> constants_;  // components of y with their values

    // Finds variables whose rates vanish identically, for any values of the others, once they are held constant: a
    // planar mechanism then has no third dimension here either. Terms that fold to zero are exactly zero.
    void find_constants(const P* y) {
        const int n = this->dimension();
        constants_.clear();
        for (int i = 0; i < n; ++i) constants_.emplace_back(i, y[i]);
        for (std::size_t before = 0; before != constants_.size();) {
            before = constants_.size();
            Tape<P> tape;
            std::vector<Traced<P>> state, rates(n);
            for (int i = 0; i < n; ++i) {
                tape.nodes.push_back({TapeNode<P>::Kind::state, i, 0, P(0), P(0)});
                state.emplace_back(P(1), i, &tape);
            }
            derivative(state.data(), rates.data());
            std::erase_if(constants_, [&](const auto& constant) {
                const Traced<P>& rate = rates[constant.first];
                return rate.node != Traced<P>::constant || rate.factor != 0;
            });
        }
    }
};

}  // namespace polhode::truth
