// Velocity, acceleration and angular momentum of a point of a rotating body, and the inverse relations.
//
// r points from a point at rest, or from the centre of mass, to the point. All vectors are in the same axes, in any
// frame, in SI units. The motion of one point does not determine the rotation about its own r: the inverse functions
// return the component of w or alpha perpendicular to r, which is all of it where r is perpendicular to the axis.
#pragma once

#include "body/algebra.h"

namespace polhode {

/// Velocity of a point due to rotation: v = w x r.
template <class S>
Vector3<S> velocity_of_point(const Vector3<S>& angular_velocity, const Vector3<S>& r) {
    return cross(angular_velocity, r);
}

/// Acceleration of a point due to rotation: a = alpha x r + w x (w x r).
template <class S>
Vector3<S> acceleration_of_point(const Vector3<S>& angular_velocity, const Vector3<S>& angular_acceleration,
                                 const Vector3<S>& r) {
    return cross(angular_acceleration, r) + cross(angular_velocity, cross(angular_velocity, r));
}

/// Angular momentum L = r x p of a point with momentum p = m v.
template <class S>
Vector3<S> angular_momentum_of_point(const Vector3<S>& r, const Vector3<S>& momentum) {
    return cross(r, momentum);
}

/// w = r x v / r^2: the component of w perpendicular to r, w - (w.r) r / r^2. r must not be zero.
template <class S>
Vector3<S> angular_velocity_of_point(const Vector3<S>& r, const Vector3<S>& velocity) {
    return S(S(1) / dot(r, r)) * cross(r, velocity);
}

/// alpha = r x a / r^2: for w = 0, or w perpendicular to r, the component of alpha perpendicular to r. Otherwise the
/// centripetal part of a adds (w.r) r x w / r^2. r must not be zero.
template <class S>
Vector3<S> angular_acceleration_of_point(const Vector3<S>& r, const Vector3<S>& acceleration) {
    return S(S(1) / dot(r, r)) * cross(r, acceleration);
}

/// alpha = r x a, as printed in the article on rotational dynamics. Without the factor 1/r^2 its unit is m^2/s^2
/// instead of rad/s^2, and the value is correct only at |r| = 1 m.
template <class S>
Vector3<S> angular_acceleration_as_written(const Vector3<S>& r, const Vector3<S>& acceleration) {
    return cross(r, acceleration);
}

}  // namespace polhode
