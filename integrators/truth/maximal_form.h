// The second formulation of the truth of a mechanism, written on its own so that a wrong sign in one of the two cannot
// pass: every body in world axes with all six freedoms, held by multipliers (integrators/maximal). Of the first
// formulation it shares the algebra, the bodies' mass properties and how they start, and nothing else. In
// multiprecision nothing drifts off its constraints that a sample would show.
#pragma once

#include <algorithm>
#include <vector>

#include "integrators/maximal/system.h"
#include "integrators/truth/motion.h"
#include "motion/problem.h"

namespace polhode::truth {

template <class P>
class MaximalForm : public maximal::System<P> {
    using Base = maximal::System<P>;

  public:
    static constexpr const char* name = "maximal coordinates";

    using Base::Base;

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
};

}  // namespace polhode::truth
