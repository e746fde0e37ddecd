// Linear stability of the splitting methods.
#pragma once

namespace polhode {

/// Spectral radius of one step on a damped pendulum: half a kick, the free motion, half a kick for each stage of a
/// composition of this order. A kick follows v' = -c v - s theta exactly at fixed theta. With drag alone, v is
/// multiplied by exp(-c) at every order. Where stages go backwards, binary64 achieves this only for c up to some
/// hundred; beyond, backward stages amplify the rounding errors of the decayed velocity.
double kicked_pendulum_growth(int order, double damping, double stiffness);
template <int order>
double kicked_pendulum_growth(double damping, double stiffness) {
    return kicked_pendulum_growth(order, damping, stiffness);
}

}  // namespace polhode
