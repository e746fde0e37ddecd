// Torsional and rolling friction at a contact, and the choice of the next mode of a ball with them.
//
// With the normal n, the angular velocity splits into the spin w_n = w . n and the rolling velocity w_t = w - w_n n.
// The plane exerts a torque on the body about the contact point:
//   rolling friction    -rho N w_t / |w_t| while w_t is not zero; else it holds w_t at zero up to rho N
//   torsional friction  -sigma N sign(w_n) n while w_n is not zero; else it holds w_n at zero up to sigma N
// with the coefficients rho and sigma in m. A motion that is held removes its direction from the inverse inertia
// (HeldRotation).
//
// The choice has a closed form for a ball (a sphere with its centre of mass in the middle and equal moments): with the
// arm s = -r n, the tangential parts of u' = a + F / m + W x s and I W = tau + s x F + M decouple from the normal ones,
// and N = -m a_n.
#pragma once

#include <optional>

#include "integrators/contact/contact_state.h"
#include "motion/equations.h"

namespace polhode::contact {

/// Number of observed functions of torsional and rolling friction.
inline constexpr int rotation_functions = 6;

/// Torsional and rolling friction in one mode.
template <class P>
struct RotationFriction {
    P rolling{0}, torsional{0};   ///< coefficients, m
    bool acts = false;            ///< whether a coefficient is not zero
    bool holds_rolling = false;   ///< w_t is zero and stays zero
    bool holds_spin = false;      ///< w_n is zero and stays zero
    bool starts_rolling = false;  ///< w_t starts from zero along `path`
    int spin = 0;                 ///< sign of w_n where torsional friction opposes it
    SlipPath<P> path;             ///< direction of w_t

    /// Whether the torque of rolling friction acts against w_t.
    bool opposes_rolling() const { return rolling > P(0) && !holds_rolling; }
    /// Whether two modes have the same equations.
    bool has_equations_of(const RotationFriction& other) const {
        return acts == other.acts && holds_rolling == other.holds_rolling && holds_spin == other.holds_spin &&
               spin == other.spin;
    }

    /// The torque for N = 1, given the normal n and the angular velocity w in the same axes, at the time t. `to_axes`
    /// maps world axes to these.
    template <class S, class N, class ToAxes>
    Vector3<S> torque(const Vector3<N>& n, const Vector3<S>& w, const S& t, const ToAxes& to_axes) const {
        Vector3<S> sum = S(0) * w;
        if (starts_rolling) {
            sum = sum - rolling * to_axes(path.at(t));
        } else if (opposes_rolling()) {
            const Vector3<S> rolls = w - dot(w, n) * n;
            sum = sum - (rolling / square_root(dot(rolls, rolls))) * rolls;
        }
        if (spin != 0) sum = sum - (torsional * P(spin)) * n;
        return sum;
    }
};

/// The inverse inertia of a body whose spin or rolling velocity is held: the torques that hold them are eliminated.
/// Both members are in the same axes as n.
template <class S, class I, class N>
Vector3<S> held_response(bool holds_rolling, bool holds_spin, const I& inertia, const I& inverse_inertia,
                         const Vector3<N>& n, const Vector3<S>& torque) {
    if (holds_rolling && holds_spin) return S(0) * torque;
    if (holds_rolling) return (dot(n, torque) / dot(n, inertia * n)) * n;
    if (!holds_spin) return inverse_inertia * torque;
    const auto z = inverse_inertia * n;
    const Vector3<S> y = inverse_inertia * torque;
    return y - (dot(n, y) / dot(n, z)) * z;
}

/// Which limit has just been reached.
enum class Exceeded {
    none,
    slip,     ///< the friction cone
    rolling,  ///< rolling friction
    spin,     ///< torsional friction
};

/// A ball in contact, in the axes of the contact.
template <class P>
struct BallContact {
    P mass{1}, moment{1}, radius{1};
    Vector3<P> acceleration, torque;    ///< by loads, m/s^2 and N m
    Vector3<P> slip, angular_velocity;  ///< exactly zero components are zero
    P friction{0}, rolling{0}, torsional{0};
    P rounding{0};  ///< relative error of forces: a friction that exceeds its limit by less is at the limit
};

/// The next mode of a ball.
template <class P>
struct BallMode {
    bool slides = false;
    bool holds_rolling = false, holds_spin = false;
    int spin = 0;
    std::optional<Vector3<P>> slip_start, rolling_start;  ///< directions of motions that start from zero
};

template <class P>
class BallModeChoice {
  public:
    BallModeChoice(const BallContact<P>& ball, Exceeded exceeded)
        : ball_(ball),
          exceeded_(exceeded),
          normal_force_(-(ball.mass * ball.acceleration[2])),
          arm_(P(0), P(0), -ball.radius),
          a_(tangential(ball.acceleration)),
          tau_(tangential(ball.torque)),
          rolls_(tangential(ball.angular_velocity)),
          limit_(ball.rolling * normal_force_),
          slip_limit_(ball.friction * normal_force_) {
        is_rolling_ = length(rolls_) > P(0);
    }

    /// Nothing if no mode is consistent.
    std::optional<BallMode<P>> choose() const {
        BallMode<P> mode;
        choose_spin(mode);
        const bool slips = length(ball_.slip) > P(0) || !(ball_.friction > P(0));
        if (slips) {
            mode.slides = true;
            choose_rolling(slip_force(), mode);
            return mode;
        }
        if (rests(mode) || rolls(mode) || slides_without_rolling(mode) || slides_and_rolls(mode)) return mode;
        return {};
    }

  private:
    const BallContact<P>& ball_;
    Exceeded exceeded_;
    P normal_force_;
    Vector3<P> arm_, a_, tau_, rolls_;
    P limit_, slip_limit_;  // largest torque against rolling, largest friction
    bool is_rolling_ = false;

    static Vector3<P> tangential(const Vector3<P>& v) { return {v[0], v[1], P(0)}; }
    static Vector3<P> unit(const Vector3<P>& v) { return (P(1) / length(v)) * v; }
    bool may_hold_rolling() const { return ball_.rolling > P(0) && !is_rolling_ && exceeded_ != Exceeded::rolling; }
    bool is_within_cone(const Vector3<P>& F) const {
        return exceeded_ != Exceeded::slip && length(F) <= slip_limit_ * (P(1) + ball_.rounding);
    }

    void choose_spin(BallMode<P>& mode) const {
        if (!(ball_.torsional > P(0))) return;
        const P& w = ball_.angular_velocity[2];
        const P& tau = ball_.torque[2];
        if (w > P(0) || w < P(0))
            mode.spin = w > P(0) ? 1 : -1;
        else if (exceeded_ != Exceeded::spin && Elementary<P>::magnitude(tau) <= ball_.torsional * normal_force_)
            mode.holds_spin = true;
        else
            mode.spin = tau > P(0) ? 1 : -1;
    }
    Vector3<P> slip_force() const {
        if (!(ball_.friction > P(0))) return {};
        return -(slip_limit_ * unit(ball_.slip));
    }
    // the torque against a rolling velocity that is not zero
    Vector3<P> opposing_torque() const {
        return is_rolling_ && ball_.rolling > P(0) ? Vector3<P>(-(limit_ * unit(rolls_))) : Vector3<P>();
    }
    // rolling with a given friction force
    void choose_rolling(const Vector3<P>& F, BallMode<P>& mode) const {
        if (!(ball_.rolling > P(0)) || is_rolling_) return;
        const Vector3<P> T = tau_ + cross(arm_, F);
        if (may_hold_rolling() && length(T) <= limit_)
            mode.holds_rolling = true;
        else
            mode.rolling_start = unit(T);
    }
    bool rests(BallMode<P>& mode) const {
        const Vector3<P> F = -(ball_.mass * a_);
        if (!may_hold_rolling() || !is_within_cone(F) || !(length(tau_ + cross(arm_, F)) <= limit_)) return false;
        mode.holds_rolling = true;
        return true;
    }
    // (I + m r^2) W = tau - m s x a + M,  F = -m (a + W x s)
    bool rolls(BallMode<P>& mode) const {
        const Vector3<P> T = tau_ - ball_.mass * cross(arm_, a_);
        const bool starts = ball_.rolling > P(0) && !is_rolling_;
        if (starts && !(length(T) > limit_) && exceeded_ != Exceeded::rolling) return false;
        if (starts && !(length(T) > P(0))) return false;
        const Vector3<P> M = starts ? Vector3<P>(-(limit_ * unit(T))) : opposing_torque();
        const P about = ball_.moment + ball_.mass * ball_.radius * ball_.radius;
        const Vector3<P> W = (P(1) / about) * (T + M);
        if (!is_within_cone(-(ball_.mass * (a_ + cross(W, arm_))))) return false;
        if (starts) mode.rolling_start = unit(T);
        return true;
    }
    bool slides_without_rolling(BallMode<P>& mode) const {
        if (!may_hold_rolling() || !(length(a_) > P(0))) return false;
        const Vector3<P> direction = unit(a_);
        const P pull = ball_.mass * length(a_);
        const bool slips = pull > slip_limit_ || exceeded_ == Exceeded::slip;
        if (!slips || !(length(tau_ - slip_limit_ * cross(arm_, direction)) <= limit_)) return false;
        mode.slides = mode.holds_rolling = true;
        mode.slip_start = direction;
        return true;
    }
    // u' = a + (tau + M) x s / I + (1 / m + r^2 / I) F. If both motions start, their directions are iterated.
    bool slides_and_rolls(BallMode<P>& mode) const {
        const bool starts = ball_.rolling > P(0) && !is_rolling_;
        Vector3<P> M = opposing_torque(), direction;
        for (int i = 0; i < 300; ++i) {
            const Vector3<P> C = a_ + (P(1) / ball_.moment) * cross(tau_ + M, arm_);
            if (!(length(C) > P(0))) return false;
            const Vector3<P> next = unit(C);
            const P change = length(next - direction);
            direction = next;
            if (!starts || !(change > P(8) * Elementary<P>::epsilon())) break;
            if (i == 299) return false;
            M = -(limit_ * unit(tau_ - slip_limit_ * cross(arm_, direction)));
        }
        mode.slides = true;
        mode.slip_start = direction;
        if (starts) mode.rolling_start = unit(tau_ - slip_limit_ * cross(arm_, direction));
        return true;
    }
};

}  // namespace polhode::contact
