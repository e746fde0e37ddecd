// The right-hand sides dy/dt = f(t, y) of one body, on a plain array and over any scalar. P is the scalar of the
// body's constants and the loads, S that of the state. Array layout: w (posed axes), q (w, x, y, z), then, with
// translation, p and v of the centre of mass (world axes). Rotation about a fixed axis has its own layout.
// motion/systems.h selects the system of a scene and defines everything else about its state.
#pragma once

#include <array>

#include "motion/equations.h"

namespace polhode {

/// The vector in y[i], y[i + 1], y[i + 2].
template <class S>
Vector3<S> vector_at(const S* y, int i) {
    return {y[i], y[i + 1], y[i + 2]};
}
/// The quaternion (w, x, y, z) in y[i] .. y[i + 3].
template <class S>
Quaternion<S> quaternion_at(const S* y, int i) {
    return {y[i], y[i + 1], y[i + 2], y[i + 3]};
}
/// Writes a vector to y[i], y[i + 1], y[i + 2].
template <class S>
[[gnu::always_inline]] inline void put(S* y, int i, const Vector3<S>& v) {
    y[i] = v[0], y[i + 1] = v[1], y[i + 2] = v[2];
}
/// Writes a quaternion (w, x, y, z) to y[i] .. y[i + 3].
template <class S>
[[gnu::always_inline]] inline void put(S* y, int i, const Quaternion<S>& q) {
    y[i] = q.w, y[i + 1] = q.x, y[i + 2] = q.y, y[i + 3] = q.z;
}

/// The layout of the state (w, q) or (w, q, p, v) of one body.
struct BodyState {
    static constexpr int rotation = 7;  ///< components of (w, q)
    static constexpr int motion = 13;   ///< components of (w, q, p, v)

    /// The components of one quantity.
    struct Block {
        int first;  ///< index of the first component
        int size;   ///< number of components
    };
    /// w, q, p, v
    static constexpr std::array<Block, 4> blocks{{{0, 3}, {3, 4}, {7, 3}, {10, 3}}};

    /// w in posed axes, rad/s.
    template <class S>
    static Vector3<S> angular_velocity(const S* y) {
        return vector_at(y, 0);
    }
    /// q, posed axes to world axes.
    template <class S>
    static Quaternion<S> attitude(const S* y) {
        return quaternion_at(y, 3);
    }
    /// p of the centre of mass, world axes, m.
    template <class S>
    static Vector3<S> position(const S* y) {
        return vector_at(y, 7);
    }
    /// v of the centre of mass, world axes, m/s.
    template <class S>
    static Vector3<S> velocity(const S* y) {
        return vector_at(y, 10);
    }
    /// Writes w and q to y.
    template <class S>
    static void set_rotation(S* y, const Vector3<S>& w, const Quaternion<S>& q) {
        put(y, 0, w), put(y, 3, q);
    }
    /// Writes p and v to y.
    template <class S>
    static void set_translation(S* y, const Vector3<S>& p, const Vector3<S>& v) {
        put(y, 7, p), put(y, 10, v);
    }
};

/// Rotation about one principal axis e, q = q0 (c, s e). The state is w along e, c and s.
template <class P>
struct AxisEquations {
    static constexpr int dimension = 3;  ///< components of the state
    P inverse_moment = P(1);             ///< about the axis, 1/(kg m^2)
    P damping = P(0);                    ///< D of the torque cc c^2 + cs c s + ss s^2 - D w along the axis, N m s
    P cc = P(0);                         ///< coefficient of c^2, N m
    P cs = P(0);                         ///< coefficient of c s, N m
    P ss = P(0);                         ///< coefficient of s^2, N m

    /// dy/dt.
    template <class S>
    void derivative(double, const S* y, S* dy) const {
        const S half_rate = P(0.5) * y[0];
        dy[0] = inverse_moment * ((cc * (y[1] * y[1]) + cs * (y[1] * y[2]) + ss * (y[2] * y[2])) - damping * y[0]);
        dy[1] = -half_rate * y[2];
        dy[2] = half_rate * y[1];
    }
};

/// Torque-free rotation in principal axes. w decouples from q.
template <class P>
struct FreeEquations {
    static constexpr int dimension = 7;  ///< components of the state
    PrincipalInertia<P> inertia;         ///< principal inertia of the body

    /// dy/dt.
    template <class S>
    void derivative(double, const S* y, S* dy) const {
        const Vector3<S> w = vector_at(y, 0);
        const Quaternion<S> q = quaternion_at(y, 3);
        put(dy, 0, inertia.gyroscopic_acceleration(w));
        put(dy, 3, attitude_rate(P(0.5), q, w));
    }
};

/// Rotation, with translation if `translation` is set, and with the inertia in the form `Inertia`.
template <class P, class Inertia, bool translation>
struct LoadedEquations {
    static constexpr int dimension = translation ? 13 : 7;  ///< components of the state
    Inertia inertia;                                        ///< inertia of the body
    const Forcing<P>* forcing = nullptr;                    ///< the loads

    /// dy/dt at time t (s).
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

}  // namespace polhode
