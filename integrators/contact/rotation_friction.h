// Torsional and rolling friction at a contact, and the choice of the next mode with them.
//
// With the normal n, the angular velocity splits into the spin w_n = w . n and the rolling velocity w_t = w - w_n n.
// The plane exerts a torque on the body about the contact point:
//   rolling friction    -rho N w_t / |w_t| while w_t is not zero; else it holds w_t at zero up to rho N
//   torsional friction  -sigma N sign(w_n) n while w_n is not zero; else it holds w_n at zero up to sigma N
// with the coefficients rho and sigma in m. A motion that is held removes its direction from the inverse inertia
// (HeldRotation).
//
// In a mode, each component of the plane's force and torque is either given by a law or holds its motion, so that six
// linear equations determine all of them (RotationModeChoice).
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "integrators/contact/contact_state.h"
#include "integrators/contact/small_system.h"
#include "integrators/contact/transitions.h"
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

/// A body with one contact, in the axes of the contact (the normal is the third).
template <class P>
struct RotatingContact {
    P inverse_mass{1};
    Matrix3<P> inverse_inertia;
    Vector3<P> arm;                                 ///< from the centre of mass to the contact, m
    Vector3<P> acceleration, angular_acceleration;  ///< by the loads: contact point, body
    Vector3<P> slip, angular_velocity;              ///< exactly zero components are zero
    P friction{0}, rolling{0}, torsional{0};
    P rounding{0};  ///< relative error of forces: a friction that exceeds its limit by less is at the limit
};

/// The next mode of a contact.
template <class P>
struct RotationMode {
    bool slides = false;
    bool holds_rolling = false, holds_spin = false;
    int spin = 0;
    std::optional<Vector3<P>> slip_start, rolling_start;  ///< directions of motions that start from zero
};

/// Chooses the first mode that is consistent: one that holds more motions comes first.
template <class P>
class RotationModeChoice {
  public:
    RotationModeChoice(const RotatingContact<P>& contact, Exceeded exceeded)
        : contact_(contact),
          exceeded_(exceeded),
          response_(contact),
          rounded_(round(contact)),
          slip_(tangential(contact.slip)),
          rolls_(tangential(contact.angular_velocity)) {}

    /// Nothing if no mode is consistent.
    std::optional<RotationMode<P>> choose() const {
        const bool slips = length(slip_) > P(0) || !(contact_.friction > P(0));
        const bool may_hold = contact_.rolling > P(0) && !(length(rolls_) > P(0)) && exceeded_ != Exceeded::rolling;
        for (const int spin : spins())
            for (const bool holds_rolling : {true, false})
                for (const bool slides : {false, true}) {
                    if ((holds_rolling && !may_hold) || (slips && !slides)) continue;
                    if (!slides && exceeded_ == Exceeded::slip) continue;
                    RotationMode<P> mode;
                    mode.slides = slides, mode.holds_rolling = holds_rolling;
                    mode.holds_spin = spin == holds, mode.spin = mode.holds_spin ? 0 : spin;
                    if (find_directions(mode) && is_consistent(mode)) return mode;
                }
        return {};
    }

  private:
    static constexpr int holds = 2;  // among the signs of the spin

    template <class S>
    struct Solution {
        Vector3<S> force, torque, slip_rate, rotation_rate;
    };
    // Accelerations of the contact point and of the body by unit forces and torques.
    template <class S>
    struct Response {
        std::array<Vector3<S>, 6> linear, angular;
        Vector3<S> acceleration, angular_acceleration;
        S friction, rolling, torsional;

        explicit Response(const RotatingContact<S>& c)
            : acceleration(c.acceleration),
              angular_acceleration(c.angular_acceleration),
              friction(c.friction),
              rolling(c.rolling),
              torsional(c.torsional) {
            for (std::size_t j = 0; j < 3; ++j) {
                Vector3<S> unit;
                unit[j] = S(1);
                angular[j] = c.inverse_inertia * cross(c.arm, unit);
                linear[j] = c.inverse_mass * unit + cross(angular[j], c.arm);
                angular[3 + j] = c.inverse_inertia * unit;
                linear[3 + j] = cross(angular[3 + j], c.arm);
            }
        }
        // Forces and torques of a mode with the directions d of the slip and e of rolling: six equations, one for each.
        std::optional<Solution<S>> solve(const RotationMode<P>& mode, const Vector3<S>& d, const Vector3<S>& e) const {
            std::vector<S> rows(36, S(0)), x(6, S(0));
            const auto demand = [&](std::size_t row, const std::array<Vector3<S>, 6>& by, const Vector3<S>& without,
                                    std::size_t axis) {
                for (std::size_t j = 0; j < 6; ++j) rows[6 * row + j] = by[j][axis];
                x[row] = S(0) - without[axis];
            };
            const auto give = [&](std::size_t row, const S& per_normal_force) {
                rows[6 * row + row] = S(1);
                rows[6 * row + 2] = rows[6 * row + 2] - per_normal_force;
            };
            demand(2, linear, acceleration, 2);
            for (std::size_t i = 0; i < 2; ++i) {
                if (mode.slides)
                    give(i, S(S(0) - friction * d[i]));
                else
                    demand(i, linear, acceleration, i);
                if (mode.holds_rolling)
                    demand(3 + i, angular, angular_acceleration, i);
                else
                    give(3 + i, S(S(0) - rolling * e[i]));
            }
            if (mode.holds_spin)
                demand(5, angular, angular_acceleration, 2);
            else
                give(5, S(S(0) - torsional * S(mode.spin)));
            if (!solve_pivoted(rows, x)) return {};
            Solution<S> result{{x[0], x[1], x[2]}, {x[3], x[4], x[5]}, acceleration, angular_acceleration};
            for (std::size_t j = 0; j < 6; ++j) {
                result.slip_rate = result.slip_rate + x[j] * linear[j];
                result.rotation_rate = result.rotation_rate + x[j] * angular[j];
            }
            return result;
        }
    };

    const RotatingContact<P>& contact_;
    Exceeded exceeded_;
    Response<P> response_;
    Response<double> rounded_;
    Vector3<P> slip_, rolls_;

    static Vector3<P> tangential(const Vector3<P>& v) { return {v[0], v[1], P(0)}; }
    static Vector3<P> unit(const Vector3<P>& v) { return (P(1) / length(v)) * v; }
    static Response<double> round(const RotatingContact<P>& c) {
        RotatingContact<double> rounded;
        rounded.inverse_mass = static_cast<double>(c.inverse_mass);
        rounded.inverse_inertia = cast<double>(c.inverse_inertia), rounded.arm = cast<double>(c.arm);
        rounded.acceleration = cast<double>(c.acceleration);
        rounded.angular_acceleration = cast<double>(c.angular_acceleration);
        rounded.friction = static_cast<double>(c.friction), rounded.rolling = static_cast<double>(c.rolling);
        rounded.torsional = static_cast<double>(c.torsional);
        return Response<double>(rounded);
    }

    // signs of the spin, `holds` where it is held, 0 without torsional friction
    std::vector<int> spins() const {
        if (!(contact_.torsional > P(0))) return {0};
        const P& spin = contact_.angular_velocity[2];
        if (spin > P(0) || spin < P(0)) return {spin > P(0) ? 1 : -1};
        if (exceeded_ == Exceeded::spin) return {1, -1};
        return {holds, 1, -1};
    }
    bool starts_slip(const RotationMode<P>& mode) const {
        return mode.slides && contact_.friction > P(0) && !(length(slip_) > P(0));
    }
    bool starts_rolling(const RotationMode<P>& mode) const {
        return !mode.holds_rolling && contact_.rolling > P(0) && !(length(rolls_) > P(0));
    }
    Vector3<P> slip_direction_of(const RotationMode<P>& mode) const {
        if (mode.slip_start) return *mode.slip_start;
        return length(slip_) > P(0) ? unit(slip_) : Vector3<P>();
    }
    Vector3<P> rolling_direction_of(const RotationMode<P>& mode) const {
        if (mode.rolling_start) return *mode.rolling_start;
        return length(rolls_) > P(0) ? unit(rolls_) : Vector3<P>();
    }
    // Finds the directions in which motions start. If a holding force or torque has just exceeded its limit, the motion
    // starts against it; otherwise along its acceleration.
    bool find_directions(RotationMode<P>& mode) const {
        const bool slips = starts_slip(mode), rolls = starts_rolling(mode);
        if (!slips && !rolls) return true;
        if (slips != rolls && exceeded_ == (slips ? Exceeded::slip : Exceeded::rolling)) {
            RotationMode<P> held = mode;
            (slips ? held.slides : held.holds_rolling) = !slips;
            const auto solution = response_.solve(held, slip_direction_of(held), rolling_direction_of(held));
            if (!solution) return false;
            const Vector3<P> holding = tangential(slips ? solution->force : solution->torque);
            if (!(length(holding) > P(0))) return false;
            (slips ? mode.slip_start : mode.rolling_start) = unit(-holding);
            return true;
        }
        // both directions depend on each other
        if (slips) mode.slip_start = Vector3<P>();
        if (rolls) mode.rolling_start = Vector3<P>();
        for (int i = 0; i < most_iterations; ++i) {
            P change(0);
            // friction makes a ball roll, so the direction of the slip comes first
            if (slips && !turn_to_start(mode, mode.slip_start, true, change)) return false;
            if (rolls && !turn_to_start(mode, mode.rolling_start, false, change)) return false;
            if (slips != rolls || !(change > P(8) * Elementary<P>::epsilon())) return true;
        }
        return false;
    }
    static constexpr int most_iterations = 300;
    // replaces the direction of the slip or of rolling by the direction of its acceleration
    bool turn_to_start(const RotationMode<P>& mode, std::optional<Vector3<P>>& direction, bool is_slip,
                       P& change) const {
        const auto acceleration = [&]<class S>(const Response<S>& by, const Vector3<S>& d) {
            const Vector3<S> other = cast<S>(is_slip ? rolling_direction_of(mode) : slip_direction_of(mode));
            const auto solution = is_slip ? by.solve(mode, d, other) : by.solve(mode, other, d);
            if (!solution || !(solution->force[2] > S(0))) return std::optional<Vector3<S>>();
            return std::optional<Vector3<S>>(is_slip ? solution->slip_rate : solution->rotation_rate);
        };
        const std::optional<Vector3<P>> found =
            forward_direction<P>([&](const Vector3<double>& d) { return acceleration(rounded_, d); },
                                 [&](const Vector3<P>& d) { return acceleration(response_, d); });
        if (!found) return false;
        change = std::max(change, length(Vector3<P>(*found - *direction)));
        direction = found;
        return true;
    }
    bool is_consistent(const RotationMode<P>& mode) const {
        const auto solution = response_.solve(mode, slip_direction_of(mode), rolling_direction_of(mode));
        if (!solution || !(solution->force[2] > P(0))) return false;
        const P& N = solution->force[2];
        const P cone = contact_.friction * N * (P(1) + contact_.rounding);
        if (!mode.slides && length(tangential(solution->force)) > cone) return false;
        if (mode.holds_rolling && length(tangential(solution->torque)) > contact_.rolling * N) return false;
        if (mode.holds_spin && Elementary<P>::magnitude(solution->torque[2]) > contact_.torsional * N) return false;
        const bool spin_starts = mode.spin != 0 && contact_.angular_velocity[2] == P(0);
        if (!spin_starts) return true;
        if (exceeded_ != Exceeded::spin) return P(mode.spin) * solution->rotation_rate[2] > P(0);
        RotationMode<P> held = mode;
        held.holds_spin = true, held.spin = 0;
        const auto holding = response_.solve(held, slip_direction_of(held), rolling_direction_of(held));
        return holding && P(mode.spin) * holding->torque[2] < P(0);
    }
};

}  // namespace polhode::contact
