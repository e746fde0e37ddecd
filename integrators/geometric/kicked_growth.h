// Linear stability of the splittings.
#pragma once

namespace polhode {

/// Half a kick, the free motion, half a kick, each stage of a composition of the order; a kick follows
/// v' = -c v - s theta exactly, theta held. Drag alone leaves v with exp(-c) whatever the order; where stages go
/// backwards that is what binary64 makes of it: beyond c of some hundred they multiply the rounding of what had
/// decayed.
double kicked_pendulum_growth(int order, double damping, double stiffness);
template <int order>
double kicked_pendulum_growth(double damping, double stiffness) {
    return kicked_pendulum_growth(order, damping, stiffness);
}

}  // namespace polhode
