// A scene's body, initial state and loads as exact functions of its binary64 numbers, in any scalar P with / and
// sqrt: 128-bit floats for values that the integrators round once, multiprecision for the reference solution.
#pragma once

#include <vector>

#include "body/elementary.h"
#include "body/mass_properties.h"
#include "body/rigid_body.h"
#include "motion/equations.h"
#include "scene/scene.h"

namespace polhode {

/// A body and its initial state. All quantities are in body axes unless noted; the inertia is about the pivot, or
/// else about the centre of mass.
template <class P>
struct ExactBody {
    P mass = P(0);                  ///< kg
    Matrix3<P> inertia_B;           ///< about `origin`, kg m^2
    bool pivoted = false;           ///< a body point is held at the world's origin
    Vector3<P> center;              ///< centre of mass, from the body's own origin, m
    Vector3<P> origin;              ///< reference point of the equations: pivot or centre of mass, m
    Vector3<P> arm;                 ///< from `origin` to the centre of mass, m (zero without a pivot)
    Quaternion<P> q;                ///< body to world at t = 0, normalised
    Vector3<P> angular_velocity_B;  ///< at t = 0, rad/s
    Vector3<P> position_W;          ///< centre of mass at t = 0, m
    Vector3<P> velocity_W;          ///< centre of mass at t = 0, m/s
};

/// Position p (m) and velocity v (m/s) of the centre of mass of a body that rotates about a fixed pivot, world axes:
/// p = R(q) arm, v = R(q) (w x arm), with w in body axes.
template <class P>
void pivoted_center(const Quaternion<P>& q, const Vector3<P>& w, const Vector3<P>& arm, Vector3<P>& p, Vector3<P>& v) {
    const P scale = P(1) / squared_norm(q);
    p = scale * rotate(q, arm);
    v = scale * rotate(q, cross(w, arm));
}

/// The scene's body and initial state, exact in the scalar P. Instantiated for double and Wide; for other scalars
/// include motion/exact_body_of.h.
template <class P>
ExactBody<P> exact_body(const Scene& scene);

/// Whether a load with this window (not an impulse) acts on the segment that starts at `begin` (s).
inline bool acts(const Window& window, double begin) { return window.from <= begin && begin < window.until; }

/// The loads that act from `begin` (s) on, in the axes that q_BP maps to body axes (1: body axes). The caller adds
/// user torques.
template <class P>
Forcing<P> forcing_at(const Scene& scene, const ExactBody<P>& body, double begin, const Quaternion<P>& q_BP) {
    Forcing<P> f;
    f.pivoted = body.pivoted;
    f.arm = rotate_back(q_BP, body.arm);
    const auto posed = [&](const Vector3<P>& v_B) { return rotate_back(q_BP, v_B); };
    const auto field = [&](const Vector3<P>& arm_B, const Vector3<P>& force_W) {
        f.body_points.push_back({posed(arm_B), force_W});
        f.field.add(f.body_points.back());
    };
    Matrix3<P> damping_B;
    for (const Load& load : scene.loads) {
        if (!acts(window_of(load), begin)) continue;
        if (const auto* gravity = std::get_if<Gravity>(&load)) {
            const Vector3<P> g = cast<P>(gravity->acceleration_W);
            f.acceleration_W = f.acceleration_W + g;
            if (body.pivoted && !(body.arm == Vector3<P>())) field(body.arm, body.mass * g);
        } else if (const auto* couple = std::get_if<Torque>(&load)) {
            const Vector3<P> v = cast<P>(couple->vector);
            if (couple->frame == Frame::body)
                f.torque = f.torque + posed(v), f.has_torque = true;
            else
                f.torque_W = f.torque_W + v, f.has_world_torque = true;
        } else if (const auto* force = std::get_if<Force>(&load)) {
            const Vector3<P> F = cast<P>(force->vector), point = cast<P>(force->point);
            if (force->frame == Frame::world)
                f.acceleration_W = f.acceleration_W + (P(1) / body.mass) * F;
            else
                f.specific_force = f.specific_force + (P(1) / body.mass) * posed(F), f.has_body_force = true;
            if (force->point_frame == Frame::body) {
                const Vector3<P> arm = point - body.origin;
                if (arm == Vector3<P>()) continue;
                if (force->frame == Frame::world)
                    field(arm, F);
                else
                    f.torque = f.torque + posed(cross(arm, F)), f.has_torque = true;
            } else if (body.pivoted && force->frame == Frame::world) {
                f.torque_W = f.torque_W + cross(point, F), f.has_world_torque = true;
            } else {
                f.world_points.push_back({point, force->frame == Frame::world ? F : posed(F), force->frame});
            }
        } else if (const auto* drag = std::get_if<Drag>(&load)) {
            const P c = P(drag->translational);
            damping_B = damping_B + diagonal(cast<P>(drag->rotational));
            // at a pivot v = w x r: r x (-c (w x r)) = -c (r.r 1 - r r^T) w
            if (body.pivoted) damping_B = damping_B + parallel_axis(c, body.arm);
            f.specific_drag = f.specific_drag + c / body.mass;
            f.has_translational_drag = f.has_translational_drag || drag->translational != 0;
        } else if (const auto* spring = std::get_if<Spring>(&load)) {
            if (spring->stiffness != 0)
                f.springs.push_back({P(spring->stiffness), normalized(cast<P>(spring->rest_orientation)) * q_BP});
        }
    }
    const Matrix3<P> axes = rotation_matrix(q_BP);
    f.damping = transposed(axes) * damping_B * axes;
    f.has_damping = !(damping_B == Matrix3<P>());
    // omit loads whose sum vanishes exactly
    f.has_torque = f.has_torque && !(f.torque == Vector3<P>());
    f.has_world_torque = f.has_world_torque && !(f.torque_W == Vector3<P>());
    return f;
}

/// The impulses at time `at` (s), in file order, in the axes that q_BP maps to body axes.
template <class P>
std::vector<PosedImpulse<P>> impulses_at(const Scene& scene, const ExactBody<P>& body, double at,
                                         const Quaternion<P>& q_BP) {
    std::vector<PosedImpulse<P>> found;
    for (const Load& load : scene.loads)
        if (const auto* impulse = std::get_if<Impulse>(&load); impulse && impulse->at == at) {
            const Vector3<P> J = cast<P>(impulse->vector), point = cast<P>(impulse->point);
            const bool in_body = impulse->point_frame == Frame::body;
            found.push_back({impulse->frame == Frame::body ? rotate_back(q_BP, J) : J, impulse->frame,
                             in_body ? rotate_back(q_BP, point - body.origin) : point, impulse->point_frame});
        }
    return found;
}

/// Energy and angular momentum of a body.
template <class P>
struct Invariants {
    P kinetic = P(0);  ///< kinetic energy, J
    /// Kinetic energy plus the potentials of gravity, of springs and of forces constant in the world at a body point,
    /// J.
    P energy = P(0);
    Vector3<P> angular_momentum_W;  ///< about the pivot, or else about the centre of mass, kg m^2/s
};

/// Energy and angular momentum of a body at time t (s), under the loads that act then. `q`, of unit length, maps body
/// axes to world axes; w_B is the angular velocity (rad/s); p_W (m) and v_W (m/s) belong to the centre of mass.
template <class P>
Invariants<P> invariants(const Scene& scene, const ExactBody<P>& body, double t, const Quaternion<P>& q,
                         const Vector3<P>& w_B, const Vector3<P>& p_W, const Vector3<P>& v_W) {
    Invariants<P> result;
    const Vector3<P> L_B = body.inertia_B * w_B;
    result.kinetic = dot(w_B, L_B) / P(2);
    if (!body.pivoted) result.kinetic += body.mass * dot(v_W, v_W) / P(2);
    result.angular_momentum_W = rotate(q, L_B);
    result.energy = result.kinetic;
    // position of the centre of mass; at a pivot it follows from the attitude
    const Vector3<P> center_W = body.pivoted ? rotate(q, body.arm) : p_W;
    for (const Load& load : scene.loads) {
        if (!acts(window_of(load), t)) continue;
        if (const auto* gravity = std::get_if<Gravity>(&load)) {
            result.energy -= body.mass * dot(cast<P>(gravity->acceleration_W), center_W);
        } else if (const auto* force = std::get_if<Force>(&load)) {
            if (force->frame == Frame::world && force->point_frame == Frame::body) {
                const Vector3<P> from_center = cast<P>(force->point) - body.center;
                result.energy -= dot(cast<P>(force->vector), center_W + rotate(q, from_center));
            }
        } else if (const auto* spring = std::get_if<Spring>(&load)) {
            const Quaternion<P> r = conjugate(normalized(cast<P>(spring->rest_orientation))) * q;
            result.energy += P(2) * P(spring->stiffness) * dot(vector_part(r), vector_part(r));
        }
    }
    return result;
}

}  // namespace polhode
