// The rules that select the next mode at a contact: admissible rolling, the direction in which slip starts, and the
// parts of an impact in which the slip has a constant direction.
#pragma once

#include <cmath>
#include <numbers>
#include <optional>

#include "integrators/contact/contact_state.h"

namespace polhode::contact {

/// Force of rolling, in the contact's axes: K F = -c.
template <class P>
Vector3<P> rolling_force(const ContactResponse<P>& at) {
    return -(inverse(at.matrix) * at.acceleration);
}

/// Whether a contact force presses and lies in the friction cone. A force that exceeds the cone by less than the
/// relative error `rounding` lies on it: the laws of rolling and sliding then agree.
template <class P>
bool is_admissible(const Vector3<P>& force, const P& mu, const P& rounding) {
    const P limit = mu * force[2] * (P(1) + rounding);
    return force[2] > P(0) && force[0] * force[0] + force[1] * force[1] <= limit * limit;
}

/// The acceleration c + N K (n - mu d) of the contact point that slides in the direction d, and the normal force.
template <class P>
struct SlidingStart {
    Vector3<P> acceleration;
    P normal_force = P(0), stiffness = P(0);  ///< N, and n . K (n - mu d)
};
template <class P>
SlidingStart<P> sliding_start(const ContactResponse<P>& at, const P& mu, const Vector3<P>& direction) {
    const Vector3<P> f(-(mu * direction[0]), -(mu * direction[1]), P(1)), d = at.matrix * f;
    SlidingStart<P> start;
    start.stiffness = d[2];
    start.normal_force = -at.acceleration[2] / d[2];
    start.acceleration = at.acceleration + start.normal_force * d;
    return start;
}

/// The tangential direction d whose acceleration is along d, forward. If there are several, the one with the largest
/// acceleration. `rounded` and `exact` return the acceleration for a direction, in binary64 and in P, or nothing if no
/// mode has that direction. A scan in binary64 finds it, the secant rule locates it.
template <class P, class Rounded, class Exact>
std::optional<Vector3<P>> forward_direction(const Rounded& rounded, const Exact& exact) {
    const auto across = [&](double angle, double& along) {
        const Vector3<double> d(std::cos(angle), std::sin(angle), 0);
        const std::optional<Vector3<double>> a = rounded(d);
        along = a ? d[0] * (*a)[0] + d[1] * (*a)[1] : -1;
        return a ? d[0] * (*a)[1] - d[1] * (*a)[0] : 0.0;
    };
    // a direction along an axis, which loads often have, is not an end of an interval of the scan
    constexpr int directions = 1440;
    constexpr double first = 0.37;
    const auto angle_of = [](int i) { return 2 * std::numbers::pi * (i + first) / directions; };
    std::optional<double> found;
    double best = 0, along_before = 0, before = across(angle_of(0), along_before);
    for (int i = 1; i <= directions; ++i) {
        double along = 0;
        const double low = angle_of(i - 1), high = angle_of(i);
        const double now = across(high, along);
        if ((before > 0) != (now > 0) && along > 0 && along_before > 0 && (!found || along > best)) {
            double a = low, b = high, unused = 0;
            for (int k = 0; k < 60; ++k) {
                const double middle = (a + b) / 2;
                ((across(middle, unused) > 0) == (before > 0) ? a : b) = middle;
            }
            found = (a + b) / 2, best = along;
        }
        before = now, along_before = along;
    }
    if (!found) return {};
    P x, y;
    Elementary<P>::sine_cosine(P(*found), y, x);
    const auto perpendicular = [&](const P& cosine, const P& sine) {
        const std::optional<Vector3<P>> a = exact(Vector3<P>(cosine, sine, P(0)));
        return a ? P(cosine * (*a)[1] - sine * (*a)[0]) : P(0);
    };
    P former(0), former_value(0), turn(0);
    for (int k = 0; k < 60; ++k) {
        // the secant rule; the first slope from a small angle
        P sine, cosine;
        Elementary<P>::sine_cosine(turn, sine, cosine);
        const P value = perpendicular(P(x * cosine - y * sine), P(y * cosine + x * sine));
        P next = k == 0 ? P(turn + P(1e-9)) : turn;
        if (k > 0) {
            if (value == former_value) break;
            next = turn - value * (turn - former) / (value - former_value);
        }
        former = turn, former_value = value;
        const P change = Elementary<P>::magnitude(P(next - turn));
        turn = next;
        if (!(change > Elementary<P>::epsilon() * P(4))) break;
    }
    P sine, cosine;
    Elementary<P>::sine_cosine(turn, sine, cosine);
    return Vector3<P>(x * cosine - y * sine, y * cosine + x * sine, P(0));
}

/// The direction in which a contact without slip starts to slide. `c` of an impact is (0, 0, -1).
template <class P>
std::optional<Vector3<P>> slip_direction(const ContactResponse<P>& at, const P& mu) {
    ContactResponse<double> rounded;
    rounded.acceleration = cast<double>(at.acceleration), rounded.matrix = cast<double>(at.matrix);
    const double friction = static_cast<double>(mu);
    return forward_direction<P>(
        [&](const Vector3<double>& d) -> std::optional<Vector3<double>> {
            const SlidingStart<double> start = sliding_start(rounded, friction, d);
            if (!(start.normal_force > 0) || !(start.stiffness > 0)) return {};
            return start.acceleration;
        },
        [&](const Vector3<P>& d) -> std::optional<Vector3<P>> { return sliding_start(at, mu, d).acceleration; });
}

}  // namespace polhode::contact
