// The handful of first-order systems that a scene can be posed as, each dy/dt = f(t, y) on a plain array:
//
//   PrincipalAxisRotation   3   w, c, s        w along one principal axis e; q = q0 (c, s e)
//   FreeRotation            7   w, q           no torque: w decouples from q
//   LoadedRotation          7   w, q           torque from attitude, rate and time
//   LoadedMotion           13   w, q, p, v     torque or force that ties translation and rotation together
//   FullMotion             13   w, q, p, v     nothing left out: full tensor, body axes (--full, and the truth)
//
// Layout: y[0..2] = w (posed axes), y[3..6] = q (w, x, y, z), y[7..9] = p, y[10..12] = v (world axes).
#pragma once

#include <cstddef>

#include "motion/equations.h"

namespace polhode {

template <class S>
Vector3<S> vector_at(const S* y, int i) {
    return {y[i], y[i + 1], y[i + 2]};
}
template <class S>
Quaternion<S> quaternion_at(const S* y, int i) {
    return {y[i], y[i + 1], y[i + 2], y[i + 3]};
}
template <class S>
void put(S* y, int i, const Vector3<S>& v) {
    y[i] = v[0], y[i + 1] = v[1], y[i + 2] = v[2];
}
template <class S>
void put(S* y, int i, const Quaternion<S>& q) {
    y[i] = q.w, y[i + 1] = q.x, y[i + 2] = q.y, y[i + 3] = q.z;
}

template <class P>
struct PrincipalAxisRotation {
    static constexpr int dimension = 3;
    P inverse_moment = P(1), damping = P(0);
    P cc = P(0), cs = P(0), ss = P(0);  ///< torque along the axis: cc c^2 + cs c s + ss s^2 - damping w

    template <class S>
    void derivative(double, const S* y, S* dy) const {
        const S half_rate = P(0.5) * y[0];
        dy[0] = inverse_moment * ((cc * (y[1] * y[1]) + cs * (y[1] * y[2]) + ss * (y[2] * y[2])) - damping * y[0]);
        dy[1] = -half_rate * y[2];
        dy[2] = half_rate * y[1];
    }
};

template <class P>
struct FreeRotation {
    static constexpr int dimension = 7;
    PrincipalInertia<P> inertia;

    template <class S>
    void derivative(double, const S* y, S* dy) const {
        const Vector3<S> w = vector_at(y, 0);
        const Quaternion<S> q = quaternion_at(y, 3);
        put(dy, 0, inertia.gyroscopic_acceleration(w));
        put(dy, 3, attitude_rate(P(0.5), q, w));
    }
};

/// Rotation, and translation where `translation` is set, with the inertia as it is given.
template <class P, class Inertia, bool translation>
struct LoadedBody {
    static constexpr int dimension = translation ? 13 : 7;
    Inertia inertia;
    const Forcing<P>* forcing = nullptr;

    template <class S>
    void derivative(double t, const S* y, S* dy) const {
        const Vector3<S> w = vector_at(y, 0);
        const Quaternion<S> q = quaternion_at(y, 3);
        Vector3<S> p, v;
        if constexpr (translation) p = vector_at(y, 7), v = vector_at(y, 10);
        const Vector3<S> w_rate = inertia.angular_acceleration(w, torque(*forcing, t, w, q, p, v));
        put(dy, 0, w_rate);
        put(dy, 3, attitude_rate(P(0.5), q, w));
        if constexpr (translation) {
            put(dy, 7, v);
            if (forcing->pivoted) {
                put(dy, 10, rotate(q, cross(w_rate, forcing->arm) + cross(w, cross(w, forcing->arm))));
                return;
            }
            Vector3<S> a = cast<S>(forcing->acceleration_W);
            if (forcing->has_body_force) a = a + rotate(q, forcing->specific_force);
            if (forcing->has_translational_drag) a = a - forcing->specific_drag * v;
            put(dy, 10, a);
        }
    }
};

template <class P>
using LoadedRotation = LoadedBody<P, PrincipalInertia<P>, false>;
template <class P>
using LoadedMotion = LoadedBody<P, PrincipalInertia<P>, true>;
template <class P>
using FullMotion = LoadedBody<P, FullInertia<P>, true>;

}  // namespace polhode
