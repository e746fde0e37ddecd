// Limits and friction of a revolute or prismatic joint for methods in maximal coordinates: impulses along its
// coordinate with bounds.
//
// Sequential impulses and soft steps:
//   friction  |lambda| <= F h, for a rate of zero: the motor of game engines at speed zero
//   limits    lambda >= 0 on the side of the limit, at the gap g:
//             without restitution  rate >= -g / h  (g > 0: the joint reaches the limit at the end of the step)
//             with restitution     rate >= -e rate_0  once g <= 0
//             g < 0                rate >= -b g, b = beta / h or that of a soft constraint, or separate correction
//                                  velocities (split impulses)
//
// Extended position-based dynamics (Mueller et al. 2020, sections 3.3.2 and 3.6; contact friction of section 3.5
// applied to a coordinate x), in a substep of length h:
//   positions   limits    g < 0: x changes by -g, without compliance
//               friction  x returns to its value at the start of the substep if this takes |lambda| < F h^2
//   velocities  friction  |lambda| <= F h, less what acted on positions, for a rate of zero
//               limits    a limit that acted on positions: rate = -e rate_0, rate_0 < 0 at the start of the substep; 0
//                         if |rate_0| <= 2 |a| h (rest)
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "integrators/multibody/joint_limits.h"
#include "integrators/multibody/velocity_rows.h"
#include "scene/scene.h"

namespace polhode::multibody {

template <class S>
class JointRow {
  public:
    std::size_t pair = 0;  ///< index of the pair

    JointRow(const Joint& joint, std::size_t pair_index)
        : pair(pair_index),
          friction_(S(joint.friction)),
          restitution_(S(joint.limits.restitution)),
          sides_{Side{limits_of<S>(joint)[0]}, Side{limits_of<S>(joint)[1]}} {}
    bool has_any() const {
        return friction_ > S(0) || std::ranges::any_of(sides_, [](const Side& side) { return side.exists(); });
    }
    /// Discards the impulses of the previous step.
    void forget() {
        friction_impulse_ = S(0);
        for (Side& side : sides_) side.impulse = S(0);
        has_rate_ = false;
    }
    /// At the start of a step of length h, before accelerations. `correction_rate`: of penetrations, 1/s.
    void start_step(const PairView<S>& at, S coordinate, S h, S correction_rate) {
        friction_bound_ = friction_ * h;
        set_row(at);
        const S rate = row_.velocity(at.from, at.to);
        for (Side& side : sides_) {
            const S gap = side.gap_at(coordinate);
            // the impulse of an impact does not act again
            if (side.bounce > S(0)) side.impulse = S(0);
            side.is_active = side.exists() && (restitution_ == S(0) || gap <= S(0));
            side.bounce = gap <= S(0) ? -restitution_ * std::min(side.sign * rate, S(0)) : S(0);
        }
        set_rates(coordinate, h, correction_rate);
    }
    /// At another position in the same step.
    void update(const PairView<S>& at, S coordinate, S h, S correction_rate) {
        set_row(at);
        set_rates(coordinate, h, correction_rate);
    }
    /// Starts from the impulses of the previous step times `ratio`.
    void warm_start(S ratio, MovingBody<S>& a, MovingBody<S>& b) {
        friction_impulse_ = std::clamp(ratio * friction_impulse_, -friction_bound_, friction_bound_);
        row_.apply_impulse(friction_impulse_, a, b);
        for (Side& side : sides_) {
            side.impulse = side.is_active ? ratio * side.impulse : S(0);
            row_.apply_impulse(side.sign * side.impulse, a, b);
        }
    }
    /// `softness`: of a limit that is passed.
    void solve(MovingBody<S>& a, MovingBody<S>& b, const Softness<S>& softness = {}) {
        solve_friction(a, b);
        for (Side& side : sides_)
            if (side.is_active)
                press(side, side.rate, side.impulse, a, b,
                      side.gap < S(0) && side.bounce == S(0) ? softness : Softness<S>{});
    }
    /// For separate correction velocities, which start at zero.
    void start_correction(S correction_rate) {
        for (Side& side : sides_) side.correction = S(0), side.rate = -correction_rate * side.gap;
    }
    void correct(MovingBody<S>& a, MovingBody<S>& b) {
        for (Side& side : sides_)
            if (side.is_active && side.gap < S(0)) press(side, side.rate, side.correction, a, b);
    }

    /// For corrections of positions, at the start of a substep of length h, before accelerations.
    void start_positions(const PairView<S>& at, S coordinate, S h) {
        set_row(at);
        const S rate = row_.velocity(at.from, at.to);
        // |a| h: change of the rate in the previous substep, if no limit acted in it
        if (!has_rate_)
            gained_ = S(0);
        else if (!is_pressed())
            gained_ = std::abs(rate - rate_);
        rate_ = rate, has_rate_ = true;
        start_ = coordinate, friction_bound_ = friction_ * h, friction_impulse_ = S(0);
        for (Side& side : sides_) {
            side.impulse = S(0);
            side.approach = side.sign * rate < S(-2) * gained_ ? -side.sign * rate : S(0);
        }
    }
    /// Moves the bodies back to a limit that is passed. Returns the correction relative to the displacement of an
    /// impact.
    S correct_limits(const PairView<S>& at, S coordinate, S h, MovingBody<S>& a, MovingBody<S>& b) {
        set_row(at);
        S largest = S(0);
        for (Side& side : sides_) {
            const S gap = side.gap_at(coordinate);
            if (!(gap < S(0))) continue;
            side.impulse -= gap * mass_ / h;
            row_.displace(-side.sign * gap * mass_, a, b);
            if (side.approach > S(0)) largest = std::max(largest, -gap / (side.approach * h));
        }
        return largest;
    }
    bool has_friction() const { return friction_ > S(0); }
    /// Static friction: moves the bodies back to the coordinate at the start of the substep if friction can hold it.
    void hold(const PairView<S>& at, S coordinate, S h, MovingBody<S>& a, MovingBody<S>& b) {
        set_row(at);
        const S multiplier = (start_ - coordinate) * mass_, impulse = friction_impulse_ + multiplier / h;
        if (!(std::abs(impulse) < friction_bound_)) return;
        friction_impulse_ = impulse;
        row_.displace(multiplier, a, b);
    }
    /// Dynamic friction and the rates at limits that acted on positions, at the end of a substep.
    void solve_velocities(const PairView<S>& at, MovingBody<S>& a, MovingBody<S>& b) {
        set_row(at);
        solve_friction(a, b);
        set_limit_rate(a, b);
    }
    /// Sets the rate at a limit that acted on positions. Returns its largest change relative to the speed of an impact.
    S set_limit_rate(MovingBody<S>& a, MovingBody<S>& b) const {
        S largest = S(0);
        for (const Side& side : sides_) {
            if (!(side.impulse > S(0))) continue;
            const S missing = restitution_ * side.approach - side.sign * row_.velocity(a, b);
            row_.apply_impulse(side.sign * mass_ * missing, a, b);
            if (side.approach > S(0)) largest = std::max(largest, std::abs(missing) / side.approach);
        }
        return largest;
    }
    /// Whether a limit acted on positions in an impact: not at rest.
    bool has_impact() const {
        return std::ranges::any_of(sides_,
                                   [](const Side& side) { return side.impulse > S(0) && side.approach > S(0); });
    }

  private:
    struct Side : JointLimit<S> {
        S gap = S(0), bounce = S(0), rate = S(0), impulse = S(0), correction = S(0);
        S approach = S(0);  // corrections of positions: speed of an impact
        bool is_active = false;
    };
    S friction_, restitution_;
    std::array<Side, 2> sides_;
    VelocityRow<S> row_;
    S mass_ = S(0), friction_bound_ = S(0), friction_impulse_ = S(0);
    // corrections of positions: coordinate and rate at the start of the substep, change of the rate by loads
    S start_ = S(0), rate_ = S(0), gained_ = S(0);
    bool has_rate_ = false;

    bool is_pressed() const {
        return std::ranges::any_of(sides_, [](const Side& side) { return side.impulse > S(0); });
    }
    void solve_friction(MovingBody<S>& a, MovingBody<S>& b) {
        if (!has_friction()) return;
        const S before = friction_impulse_;
        friction_impulse_ = std::clamp(before - mass_ * row_.velocity(a, b), -friction_bound_, friction_bound_);
        row_.apply_impulse(friction_impulse_ - before, a, b);
    }
    void set_row(const PairView<S>& at) {
        row_ = coordinate_row(at);
        mass_ = 1 / coupling(row_, row_, at.from, at.to);
    }
    void set_rates(S coordinate, S h, S correction_rate) {
        for (Side& side : sides_) {
            side.gap = side.gap_at(coordinate);
            side.rate = side.gap > S(0) ? -side.gap / h : -correction_rate * side.gap;
            if (side.bounce > S(0)) side.rate = std::max(side.rate, side.bounce);
        }
    }
    // Raises the rate away from the limit to `rate` by an impulse that does not pull.
    void press(const Side& side, S rate, S& impulse, MovingBody<S>& a, MovingBody<S>& b,
               const Softness<S>& softness = {}) const {
        const S before = impulse, missing = side.sign * row_.velocity(a, b) - rate;
        impulse = std::max(S(0), before - softness.mass_scale * mass_ * missing - softness.impulse_scale * before);
        row_.apply_impulse(side.sign * (impulse - before), a, b);
    }
};

/// The rows of the joints of a scene that have friction or limits. `pairs`: with links numbered by joints, then by
/// loops.
template <class S>
std::vector<JointRow<S>> joint_rows(const Scene& scene, const std::vector<JointPair<S>>& pairs) {
    std::vector<JointRow<S>> rows;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        if (pairs[k].link >= scene.joints.size()) continue;
        if (JointRow<S> row(scene.joints[pairs[k].link], k); row.has_any()) rows.push_back(row);
    }
    return rows;
}

}  // namespace polhode::multibody
