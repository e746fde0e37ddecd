// The loads of a scene as a game update sums them: force and torque in world axes, by the body's orientation matrix A.
//
// The torque is about the pivot where there is one, else about the centre of mass x. A may have drifted: it is used as
// it is, A r for a point of the body and A^T w for the rates in body axes.
#pragma once

#include <type_traits>

#include "motion/finite.h"
#include "motion/problem.h"
#include "motion/rounded.h"

namespace polhode {

/// S: the scalar in which they are summed.
template <class S = double>
class WorldLoads {
  public:
    /// A problem posed with Formulation::full, whose axes are the body's own.
    explicit WorldLoads(const Problem& problem) { enter(problem.segments.front()); }

    void enter(const Segment& segment) {
        if constexpr (as_posed)
            forcing_ = &segment.forcing;
        else
            forcing_ = rounded<S>(segment.forcing);
    }
    /// What acts on the segment entered last.
    const Forcing<S>& forcing() const {
        if constexpr (as_posed)
            return *forcing_;
        else
            return forcing_;
    }

    /// `attitude()` gives the quaternion of A, which only springs and a user's torque ask for.
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

    /// dv/dt of the centre of mass of a body that is not held.
    Vector3<S> acceleration_W(const Matrix3<S>& A, const Vector3<S>& v) const {
        const Forcing<S>& f = forcing();
        Vector3<S> a = f.acceleration_W;
        if (f.has_body_force) a = a + A * f.specific_force;
        if (f.has_translational_drag) a = a - f.specific_drag * v;
        return a;
    }

    /// L += r x J, and v += J / m where the body is not held.
    static void strike(const Problem& problem, const Segment& segment, const Matrix3<S>& A, const Vector3<S>& x,
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

/// The sample at time t (s) of a body whose attitude is q, with w and the velocity v and place x of its centre of mass
/// in world axes; of a held body place and velocity are where the attitude says.
template <class S>
Sample sample_in_world(const Problem& problem, double t, const Quaternion<double>& q, const Vector3<S>& w,
                       const Vector3<S>& x, const Vector3<S>& v) {
    Sample s{t, q, rotate_back(q, cast<double>(w)), cast<double>(x), cast<double>(v)};
    if (problem.body.pivoted) pivoted_center(s.q, s.angular_velocity_B, problem.body.arm, s.position_W, s.velocity_W);
    return s;
}

}  // namespace polhode
