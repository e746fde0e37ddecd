// Rounds the data of a right-hand side to another scalar, each number once.
#pragma once

#include "motion/body_equations.h"

namespace polhode {

template <class To, class From>
PrincipalInertia<To> rounded(const PrincipalInertia<From>& inertia) {
    return {cast<To>(inertia.gyroscopic), cast<To>(inertia.inverse_moments), inertia.isotropic};
}

template <class To, class From>
FullInertia<To> rounded(const FullInertia<From>& inertia) {
    return {cast<To>(inertia.tensor), cast<To>(inertia.inverse)};
}

template <class To, class From>
AxisEquations<To> rounded(const AxisEquations<From>& system) {
    return {To(system.inverse_moment), To(system.damping), To(system.cc), To(system.cs), To(system.ss)};
}

/// User-defined torques are functions of binary64 numbers and are kept.
template <class To, class From>
Forcing<To> rounded(const Forcing<From>& f) {
    Forcing<To> r;
    r.has_torque = f.has_torque;
    r.has_world_torque = f.has_world_torque;
    r.has_damping = f.has_damping;
    r.has_translational_drag = f.has_translational_drag;
    r.has_body_force = f.has_body_force;
    r.torque = cast<To>(f.torque);
    r.torque_W = cast<To>(f.torque_W);
    r.damping = cast<To>(f.damping);
    for (const auto& load : f.body_points) r.body_points.push_back({cast<To>(load.arm), cast<To>(load.force_W)});
    for (int b = 0; b < 3; ++b) r.field.moment[b] = cast<To>(f.field.moment[b]);
    r.field.present = f.field.present;
    r.only_field = f.only_field;
    for (const auto& load : f.world_points)
        r.world_points.push_back({cast<To>(load.point_W), cast<To>(load.force), load.frame});
    for (const auto& spring : f.springs) r.springs.push_back({To(spring.stiffness), cast<To>(spring.rest)});
    r.user_torques = f.user_torques;
    r.acceleration_W = cast<To>(f.acceleration_W);
    r.specific_force = cast<To>(f.specific_force);
    r.specific_drag = To(f.specific_drag);
    r.pivoted = f.pivoted;
    r.arm = cast<To>(f.arm);
    return r;
}

}  // namespace polhode
