// The motion of a body at one time: what scenes, solvers, reference solutions and checks exchange.
#pragma once

#include "body/algebra.h"

namespace polhode {

/// The motion of a body at one time, over a scalar S.
template <class S>
struct BodyMotion {
    Quaternion<S> q;                ///< body to world; of unit length unless said otherwise
    Vector3<S> angular_velocity_B;  ///< rad/s
    Vector3<S> position_W;          ///< of the centre of mass, m
    Vector3<S> velocity_W;          ///< of the centre of mass, m/s
};

/// The same motion over another scalar.
template <class To, class From>
BodyMotion<To> cast(const BodyMotion<From>& m) {
    return {cast<To>(m.q), cast<To>(m.angular_velocity_B), cast<To>(m.position_W), cast<To>(m.velocity_W)};
}

/// The motion of a body with its time. q is as the method left it, not normalised.
struct Sample : BodyMotion<double> {
    double t = 0;  ///< s

    Sample() = default;
    /// A motion at time t (s).
    Sample(double time, const BodyMotion<double>& motion) : BodyMotion(motion), t(time) {}
    /// The same by its parts: attitude, angular velocity in body axes, position and velocity of the centre of mass.
    Sample(double time, const Quaternion<double>& attitude, const Vector3<double>& rate_B,
           const Vector3<double>& p = {}, const Vector3<double>& v = {})
        : BodyMotion{attitude, rate_B, p, v}, t(time) {}
};

}  // namespace polhode
