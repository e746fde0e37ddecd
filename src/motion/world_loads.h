// A scene's loads as game updates sum them: force and torque in world axes, using the body's orientation matrix A.
//
// The torque is about the pivot, or else about the centre of mass x. A may have drifted and is used unchanged: A r
// for a point of the body, A^T w for the rates in body axes.
#pragma once

#include <type_traits>

#include "motion/finite.h"
#include "motion/problem.h"
#include "motion/rounded.h"

namespace polhode {

/// S: the scalar of the sums.
template <class S = double>
class WorldLoads {
  public:
    /// The problem must be posed with Formulation::full, whose axes are the body's own.
    explicit WorldLoads(const Problem& problem) { enter(problem.segments.front()); }

    void enter(const Segment& segment) {
        if constexpr (as_posed)
            forcing_ = &segment.forcing;
        else
            forcing_ = rounded<S>(segment.forcing);
    }
    /// The loads of the segment entered last.
    const Forcing<S>& forcing() const {
        if constexpr (as_posed)
            return *forcing_;
        else
            return forcing_;
    }

    /// Torque in world axes. `attitude()` returns the quaternion of A; it is called only for springs and user-defined
    /// torques.
    template <class Attitude>
    Vector3<S> torque_W(double t, const Matrix3<S>& A, const Attitude& attitude, const Vector3<S>& w,
                        const Vector3<S>& x, const Vector3<S>& v) const {
        const Forcing<S>& f = forcing();
        Vector3<S> sum;
        for (int b = 0; b < 3; ++b)
            if (f.field.present[b]) {
                Vector3<S> axis;
                axis[b] = 1;
                sum = sum + cross(A * f.field.moment[b], axis);
            }
        if (f.only_field) return sum;
        if (f.has_torque) sum = sum + A * f.torque;
        if (f.has_world_torque) sum = sum + f.torque_W;
        if (f.has_damping) sum = sum - A * (f.damping * (transposed(A) * w));
        for (const ForceAtWorldPoint<S>& load : f.world_points) {
            const Vector3<S> arm = f.pivoted ? load.point_W : load.point_W - x;
            sum = sum + cross(arm, load.frame == Frame::body ? A * load.force : load.force);
        }
        if (f.springs.empty() && f.user_torques.empty()) return sum;
        const Quaternion<S> q = attitude();
        for (const SpringTorque<S>& spring : f.springs) {
            const Quaternion<S> r = conjugate(spring.rest) * q;
            sum = sum + A * ((-2 * spring.stiffness * r.w) * vector_part(r));
        }
        for (const PosedUserTorque& user : f.user_torques)
            sum = sum + A * cast<S>(user(t, cast<double>(q), cast<double>(transposed(A) * w), cast<double>(x),
                                         cast<double>(v)));
        return sum;
    }

    /// dv/dt of the centre of mass of a body without a pivot, m/s^2.
    Vector3<S> acceleration_W(const Matrix3<S>& A, const Vector3<S>& v) const {
        const Forcing<S>& f = forcing();
        Vector3<S> a = f.acceleration_W;
        if (f.has_body_force) a = a + A * f.specific_force;
        if (f.has_translational_drag) a = a - f.specific_drag * v;
        return a;
    }

    /// Applies impulses: L += r x J, and v += J / m for a body without a pivot.
    static void apply_impulses(const Problem& problem, const Segment& segment, const Matrix3<S>& A, const Vector3<S>& x,
                               Vector3<S>& L, Vector3<S>& v) {
        const bool held = problem.body.pivoted;
        for (const PosedImpulse<double>& impulse : segment.impulses) {
            const Vector3<S> vector = cast<S>(impulse.vector), point = cast<S>(impulse.point);
            const Vector3<S> J = impulse.frame == Frame::world ? vector : A * vector;
            Vector3<S> arm = A * point;
            if (impulse.point_frame == Frame::world) arm = held ? point : point - x;
            L = L + cross(arm, J);
            if (!held) v = v + S(1 / problem.body.mass) * J;
        }
    }

  private:
    static constexpr bool as_posed = std::is_same_v<S, double>;

    std::conditional_t<as_posed, const Forcing<double>*, Forcing<S>> forcing_;
};

/// The sample at time t (s) of a body with attitude q and with w, position x and velocity v of its centre of mass in
/// world axes. With a pivot, position and velocity follow from the attitude.
template <class S>
Sample sample_in_world(const Problem& problem, double t, const Quaternion<double>& q, const Vector3<S>& w,
                       const Vector3<S>& x, const Vector3<S>& v) {
    Sample s{t, q, rotate_back(q, cast<double>(w)), cast<double>(x), cast<double>(v)};
    if (problem.body.pivoted) pivoted_center(s.q, s.angular_velocity_B, problem.body.arm, s.position_W, s.velocity_W);
    return s;
}

}  // namespace polhode
