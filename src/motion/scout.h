// A coarse run that estimates the size of a motion before it is solved: Bogacki & Shampine (1989), orders 3 and 2.
#pragma once

#include <algorithm>
#include <cmath>

namespace polhode {

/// Error tolerance per step, relative to a component's scale.
inline constexpr double scout_tolerance = 1e-3;

/// Integrates from the leg's start to its end. Y: a state with operator[] and size. rate(t, y, dy): the right-hand
/// side. change_of(difference, y): the largest error of a step relative to its scale. arrived(t, y): called after
/// each accepted step; returns whether it has changed y. `steps` counts attempts. Returns false after more than
/// `most_steps` attempts or if the step size vanishes.
template <class Y, class LegType, class Rate, class ChangeOf, class OnStep>
bool scout_leg(const LegType& leg, Y& y, long& steps, long most_steps, const Rate& rate, const ChangeOf& change_of,
               const OnStep& on_step) {
    const std::size_t n = y.size();
    double t = leg.begin, h = (leg.end - leg.begin) / 100;
    Y k1 = y, k2 = y, k3 = y, k4 = y, z = y, next = y, difference = y;
    rate(t, y, k1);
    while (t < leg.end) {
        if (++steps > most_steps) return false;
        h = std::min(h, leg.end - t);
        for (std::size_t i = 0; i < n; ++i) z[i] = y[i] + h / 2 * k1[i];
        rate(t + h / 2, z, k2);
        for (std::size_t i = 0; i < n; ++i) z[i] = y[i] + h * 3 / 4 * k2[i];
        rate(t + h * 3 / 4, z, k3);
        for (std::size_t i = 0; i < n; ++i) next[i] = y[i] + h / 9 * (2 * k1[i] + 3 * k2[i] + 4 * k3[i]);
        rate(t + h, next, k4);
        for (std::size_t i = 0; i < n; ++i)
            difference[i] = h * (-5.0 / 72 * k1[i] + k2[i] / 12 + k3[i] / 9 - k4[i] / 8);
        const double error = change_of(difference, next) / scout_tolerance;
        if (!std::isfinite(error) || error > 1) {
            h *= std::isfinite(error) ? std::max(0.2, 0.9 * std::cbrt(1 / error)) : 0.1;
            if (t + h == t) return false;
            continue;
        }
        t = leg.end - t <= h ? leg.end : t + h;
        y = next, k1 = k4;
        if (on_step(t, y)) rate(t, y, k1);
        h *= error > 0 ? std::min(5.0, 0.9 * std::cbrt(1 / error)) : 5.0;
    }
    return true;
}

}  // namespace polhode
