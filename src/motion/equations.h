// Euler's rigid-body equations with quaternion kinematics, as one template for every scalar.
//
//   I dw/dt + w x I w = tau(q, w, p)      (axes fixed in the body, about the centre of mass or a fixed pivot)
//   dq/dt = 1/2 q (0, w)
//   dp/dt = v,  dv/dt = a + R(q) f_B - k v
//
// P is the scalar of the parameters, S that of the state. Both are double in an integrator; S is a dual number for
// Jacobians; both are multiprecision numbers, traced Taylor coefficients or balls for the reference solution. The
// right-hand side is polynomial in (w, q, p, v): rotations enter by the homogeneous form |q|^2 R(q).
//
// "Posed axes" are the body-fixed axes in which w and the torque are expressed: the principal axes, or the body's own
// axes (`FullInertia`). q maps posed axes to world axes.
#pragma once

#include <array>
#include <functional>
#include <type_traits>
#include <vector>

#include "body/algebra.h"
#include "scene/scene.h"

namespace polhode {

/// A force that is constant in world axes and acts at a point of the body.
template <class P>
struct ForceAtBodyPoint {
    Vector3<P> arm;      ///< the point, from the centre of mass or the pivot, posed axes, m
    Vector3<P> force_W;  ///< N
};

/// The first moments of all forces F_n constant in world axes at body points r_n (from the centre of mass or the
/// pivot, posed axes): m_b = sum of F_n,b r_n for each world axis b. The total torque is the sum of m_b x R(q)^T e_b.
template <class P>
struct FieldMoments {
    std::array<Vector3<P>, 3> moment;                  ///< N m
    std::array<bool, 3> present{false, false, false};  ///< which moments are not zero

    /// Adds a force to the moments.
    void add(const ForceAtBodyPoint<P>& force) {
        for (int b = 0; b < 3; ++b) {
            moment[b] = moment[b] + force.force_W[b] * force.arm;
            present[b] = !(moment[b] == Vector3<P>());
        }
    }
};

/// A force that is constant in world or posed axes and acts at a fixed point of the world. In flight its torque
/// depends on the body's position.
template <class P>
struct ForceAtWorldPoint {
    Vector3<P> point_W;  ///< m
    Vector3<P> force;    ///< N
    Frame frame;         ///< axes of `force`: world, or body for posed axes
};

/// A torsional spring. With r = rest* q its torque is -2 k r_w r_v in posed axes.
template <class P>
struct SpringTorque {
    P stiffness;         ///< k, N m
    Quaternion<P> rest;  ///< posed axes to world axes at rest
};

/// A user-defined torque (N m, posed axes) as a function of t (s), q, w (rad/s, posed axes), p and v (m, m/s, world
/// axes).
using PosedUserTorque = std::function<Vector3<double>(double, const Quaternion<double>&, const Vector3<double>&,
                                                      const Vector3<double>&, const Vector3<double>&)>;

/// The loads between two events, in posed axes. Absent terms are skipped, not multiplied by zero.
template <class P>
struct Forcing {
    bool has_torque = false;                         ///< `torque` is not zero
    bool has_world_torque = false;                   ///< `torque_W` is not zero
    bool has_damping = false;                        ///< `damping` is not zero
    bool has_translational_drag = false;             ///< `specific_drag` is not zero
    bool has_body_force = false;                     ///< `specific_force` is not zero
    Vector3<P> torque;                               ///< constant in posed axes, N m
    Vector3<P> torque_W;                             ///< constant in world axes, N m
    Matrix3<P> damping;                              ///< torque -D w, N m s
    std::vector<ForceAtBodyPoint<P>> body_points;    ///< forces constant in world axes at body points
    FieldMoments<P> field;                           ///< moments of `body_points`, which the right-hand side reads
    bool only_field = false;                         ///< no other torque acts, so that the right-hand side skips them
    std::vector<ForceAtWorldPoint<P>> world_points;  ///< forces at fixed points of the world
    std::vector<SpringTorque<P>> springs;            ///< torsional springs
    std::vector<PosedUserTorque> user_torques;       ///< user-defined torques

    Vector3<P> acceleration_W;  ///< gravity plus forces constant in world axes over the mass, m/s^2
    Vector3<P> specific_force;  ///< forces constant in posed axes over the mass, m/s^2
    P specific_drag = P(0);     ///< c/m, 1/s
    bool pivoted = false;       ///< p and v follow from the rotation: p = R arm
    Vector3<P> arm;             ///< pivot to centre of mass, posed axes, m

    /// Whether any torque acts.
    bool any_torque() const { return !body_points.empty() || any_torque_beside_field(); }
    /// Whether any torque acts besides that of forces at body points.
    bool any_torque_beside_field() const {
        return has_torque || has_world_torque || has_damping || !world_points.empty() || !springs.empty() ||
               !user_torques.empty();
    }
};

/// The torque (N m, posed axes) at time t (s) and the state w, q, p, v. Only forces at world points and user-defined
/// torques read p.
template <class S, class P>
Vector3<Product<P, S>> torque(const Forcing<P>& f, double t, const Vector3<S>& w, const Quaternion<S>& q,
                              const Vector3<S>& p, const Vector3<S>& v) {
    using R = Product<P, S>;
    Vector3<R> sum = f.has_torque ? cast<R>(f.torque) : Vector3<R>();
    for (int b = 0; b < 3; ++b)
        if (f.field.present[b]) sum = sum + cross(f.field.moment[b], world_axis(q, b));
    if (f.only_field) return sum;
    if (f.has_world_torque) sum = sum + rotate_back(q, f.torque_W);
    if (f.has_damping) sum = sum - f.damping * w;
    for (const SpringTorque<P>& spring : f.springs) {
        const Quaternion<R> r = conjugate(spring.rest) * q;
        const R factor = spring.stiffness * (r.w + r.w);
        sum = sum - factor * vector_part(r);
    }
    for (const ForceAtWorldPoint<P>& load : f.world_points) {
        // the pivot is at the world's origin
        const Vector3<R> arm_W = f.pivoted ? cast<R>(load.point_W) : load.point_W - p;
        if (load.frame == Frame::body)
            sum = sum + cross(rotate_back(q, arm_W), load.force);
        else
            sum = sum + rotate_back(q, cross(arm_W, load.force));
    }
    if constexpr (std::is_same_v<S, double>) {
        for (const PosedUserTorque& user : f.user_torques) sum = sum + user(t, q, w, p, v);
    } else {
        (void)t, (void)v;
    }
    return sum;
}

/// dq/dt = 1/2 q (0, w); `half` is one half in the scalar of the parameters.
template <class S, class P>
[[gnu::always_inline]] inline Quaternion<Product<P, S>> attitude_rate(const P& half, const Quaternion<S>& q,
                                                                      const Vector3<S>& w) {
    const Vector3<Product<P, S>> h = half * w;
    return {-q.x * h[0] - q.y * h[1] - q.z * h[2], q.w * h[0] + q.y * h[2] - q.z * h[1],
            q.w * h[1] + q.z * h[0] - q.x * h[2], q.w * h[2] + q.x * h[1] - q.y * h[0]};
}

/// Inertia in principal axes: products of inertia vanish, and three gyroscopic coefficients remain.
template <class P>
struct PrincipalInertia {
    Vector3<P> gyroscopic;       ///< (I2 - I3)/I1 and cyclic
    Vector3<P> inverse_moments;  ///< 1/(kg m^2)
    bool isotropic = false;      ///< all three moments are equal: no gyroscopic term

    /// -I^-1 (w x I w), in rad/s^2 for w in rad/s.
    template <class S>
    Vector3<Product<P, S>> gyroscopic_acceleration(const Vector3<S>& w) const {
        return {gyroscopic[0] * (w[1] * w[2]), gyroscopic[1] * (w[2] * w[0]), gyroscopic[2] * (w[0] * w[1])};
    }
    /// I^-1 (tau - w x I w), in rad/s^2 for w in rad/s and tau in N m.
    template <class S>
    Vector3<Product<P, S>> angular_acceleration(const Vector3<S>& w, const Vector3<Product<P, S>>& tau) const {
        if (isotropic) return response(tau);
        const Vector3<Product<P, S>> g = gyroscopic_acceleration(w);
        return {g[0] + inverse_moments[0] * tau[0], g[1] + inverse_moments[1] * tau[1],
                g[2] + inverse_moments[2] * tau[2]};
    }
    /// I^-1 tau, in rad/s^2 for tau in N m.
    template <class T>
    Vector3<Product<P, T>> response(const Vector3<T>& tau) const {
        return {inverse_moments[0] * tau[0], inverse_moments[1] * tau[1], inverse_moments[2] * tau[2]};
    }
};

/// The full inertia tensor in the axes in which it was given.
template <class P>
struct FullInertia {
    Matrix3<P> tensor;   ///< I, kg m^2
    Matrix3<P> inverse;  ///< I^-1

    /// -I^-1 (w x I w), in rad/s^2 for w in rad/s.
    template <class S>
    Vector3<Product<P, S>> gyroscopic_acceleration(const Vector3<S>& w) const {
        return inverse * cross(tensor * w, w);
    }
    /// I^-1 (tau - w x I w), in rad/s^2 for w in rad/s and tau in N m.
    template <class S>
    Vector3<Product<P, S>> angular_acceleration(const Vector3<S>& w, const Vector3<Product<P, S>>& tau) const {
        return inverse * (tau + cross(tensor * w, w));
    }
    /// I^-1 tau, in rad/s^2 for tau in N m.
    template <class T>
    Vector3<Product<P, T>> response(const Vector3<T>& tau) const {
        return inverse * tau;
    }
};

/// An impulse to be applied.
template <class P>
struct PosedImpulse {
    Vector3<P> vector;  ///< N s
    Frame frame;        ///< axes of `vector`: world, or body for posed axes
    Vector3<P> point;   ///< m: from the centre of mass or the pivot in posed axes, or a point of the world
    Frame point_frame;  ///< frame of `point`: body or world
};

/// Applies an impulse: w jumps by I^-1 (r x J) and v by J / m. At a pivot v does not jump, since the reaction
/// balances it.
template <class P, class Inertia>
void apply(const PosedImpulse<P>& impulse, const Inertia& inertia, const P& mass, bool pivoted, Vector3<P>& w,
           const Quaternion<P>& q, const Vector3<P>& p, Vector3<P>& v) {
    const P scale = P(1) / squared_norm(q);
    const bool in_world = impulse.frame == Frame::world;
    const Vector3<P> kick_W = in_world ? impulse.vector : scale * rotate(q, impulse.vector);
    const Vector3<P> kick = in_world ? scale * rotate_back(q, impulse.vector) : impulse.vector;
    Vector3<P> arm = impulse.point;
    if (impulse.point_frame == Frame::world) arm = scale * rotate_back(q, pivoted ? impulse.point : impulse.point - p);
    w = w + inertia.response(cross(arm, kick));
    if (!pivoted) v = v + (P(1) / mass) * kick_W;
}

}  // namespace polhode
