// The state of motion of a body at one time, shared by scenes, solvers, reference solutions and checks.
#pragma once

#include "body/algebra.h"

namespace polhode {

/// Attitude, angular velocity, position and velocity of a body at one time, over a scalar S.
template <class S>
struct BodyMotion {
    Quaternion<S> q;                ///< body to world; of unit length unless documented otherwise
    Vector3<S> angular_velocity_B;  ///< rad/s
    Vector3<S> position_W;          ///< centre of mass, m
    Vector3<S> velocity_W;          ///< centre of mass, m/s
};

/// Converts the motion to another scalar.
template <class To, class From>
BodyMotion<To> cast(const BodyMotion<From>& m) {
    return {cast<To>(m.q), cast<To>(m.angular_velocity_B), cast<To>(m.position_W), cast<To>(m.velocity_W)};
}

/// The motion of a body at a time t. q is the method's output and is not normalised.
struct Sample : BodyMotion<double> {
    double t = 0;  ///< s

    Sample() = default;
    /// A motion at time t (s).
    Sample(double time, const BodyMotion<double>& motion) : BodyMotion(motion), t(time) {}
    /// From its parts: attitude, angular velocity in body axes (rad/s), position (m) and velocity (m/s) of the centre
    /// of mass.
    Sample(double time, const Quaternion<double>& attitude, const Vector3<double>& rate_B,
           const Vector3<double>& p = {}, const Vector3<double>& v = {})
        : BodyMotion{attitude, rate_B, p, v}, t(time) {}
};

}  // namespace polhode
