// What one point of a turning body says of the whole, and the other way round.
//
// r leads from a point at rest, or from the centre of mass, to the point; all vectors in the same axes, any frame; SI.
// A point says nothing of a turn about its own r: what comes back is the part of w or alpha across r, all of it where
// r is perpendicular to the axis.
#pragma once

#include "body/algebra.h"

namespace polhode {

/// v = w x r, the part of the point's velocity that the turn gives.
template <class S>
Vector3<S> velocity_of_point(const Vector3<S>& angular_velocity, const Vector3<S>& r) {
    return cross(angular_velocity, r);
}

/// a = alpha x r + w x (w x r)
template <class S>
Vector3<S> acceleration_of_point(const Vector3<S>& angular_velocity, const Vector3<S>& angular_acceleration,
                                 const Vector3<S>& r) {
    return cross(angular_acceleration, r) + cross(angular_velocity, cross(angular_velocity, r));
}

/// L = r x p of a point with momentum p = m v.
template <class S>
Vector3<S> angular_momentum_of_point(const Vector3<S>& r, const Vector3<S>& momentum) {
    return cross(r, momentum);
}

/// w = r x v / r^2: the part of w across r, w - (w.r) r / r^2. r must not be zero.
template <class S>
Vector3<S> angular_velocity_of_point(const Vector3<S>& r, const Vector3<S>& velocity) {
    return S(S(1) / dot(r, r)) * cross(r, velocity);
}

/// alpha = r x a / r^2. For w = 0, or w and r perpendicular, the part of alpha across r; else the centripetal part of a
/// adds (w.r) r x w / r^2. r must not be zero.
template <class S>
Vector3<S> angular_acceleration_of_point(const Vector3<S>& r, const Vector3<S>& acceleration) {
    return S(S(1) / dot(r, r)) * cross(r, acceleration);
}

/// alpha = r x a, as the article on rotational dynamics has it: without the 1/r^2 it is m^2/s^2, not rad/s^2, and right
/// at |r| = 1 m alone.
template <class S>
Vector3<S> angular_acceleration_as_written(const Vector3<S>& r, const Vector3<S>& acceleration) {
    return cross(r, acceleration);
}

}  // namespace polhode
