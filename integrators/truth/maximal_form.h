// The second formulation of the truth of a mechanism, written on its own so that a wrong sign in one of the two cannot
// pass: every body in world axes with all six freedoms, held by multipliers (integrators/maximal). Of the first
// formulation it shares the algebra, the bodies' mass properties and how they start, and nothing else. In
// multiprecision nothing drifts off its constraints that a sample would show.
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

template <class P>
class MaximalForm : public maximal::System<P> {
    using Base = maximal::System<P>;

  public:
    static constexpr const char* name = "maximal coordinates";

    using Base::Base;

    /// As the system's; and finds what never changes from here on.
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
    std::vector<Block> blocks(const Scales& scales) const {
        std::vector<Block> all;
        const maximal::Mechanism<P>& mechanism = this->mechanism();
        for (int b = 0; b < mechanism.world(); ++b) {
            const int first = this->place(b);
            if (first < 0) continue;
            // the error of w is that of L over the smallest moment
            const double moment = static_cast<double>(mechanism.bodies[b].least_moment());
            const double mass = static_cast<double>(mechanism.bodies[b].mass);
            // centres that stay where they are have no scale of their own
            const double reach = static_cast<double>(mechanism.bodies[b].reach());
            const double velocity = std::max(scales.velocity, scales.angular_velocity * reach);
            all.push_back({first, 4, 1});
            all.push_back({first + 4, 3, std::max(scales.position, reach)});
            all.push_back({first + 7, 3, moment * scales.angular_velocity});
            all.push_back({first + 10, 3, mass * velocity});
        }
        for (int i = this->angles(); i < this->dimension(); ++i) all.push_back({i, 1, 1});
        return all;
    }

    /// The motion of every body, in the scene's order.
    std::vector<Motion<P>> motion(const P* y) const {
        std::vector<Motion<P>> all;
        for (const BodyMotion<P>& m : this->motions(y))
            all.push_back({normalized(m.q), m.angular_velocity_B, m.position_W, m.velocity_W});
        return all;
    }

  private:
    std::vector<std::pair<int, P>> constants_;  // components of y with their values

    // A planar mechanism has no third dimension, here too: of all variables those are left out whose rates vanish
    // identically, whatever values the others take, once they are left out. What folds to zero is zero exactly.
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
