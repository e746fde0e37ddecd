// The loads of a scene as a game update sums them: force and torque in world axes, by the body's orientation matrix A.
//
// The torque is about the pivot where there is one, else about the centre of mass x. A may have drifted: it is used as
// it is, A r for a point of the body and A^T w for the rates in body axes.
#pragma once

#include "motion/problem.h"

namespace polhode {

class WorldLoads {
  public:
    /// A problem posed with Formulation::full, whose axes are the body's own.
    explicit WorldLoads(const Problem& problem) : forcing_(&problem.segments.front().forcing) {}

    void enter(const Segment& segment) { forcing_ = &segment.forcing; }

    /// `attitude()` gives the quaternion of A, which only springs and a user's torque ask for.
    template <class Attitude>
    Vector3<double> torque_W(double t, const Matrix3<double>& A, const Attitude& attitude, const Vector3<double>& w,
                             const Vector3<double>& x, const Vector3<double>& v) const {
        const Forcing<double>& f = *forcing_;
        Vector3<double> sum;
        for (int b = 0; b < 3; ++b)
            if (f.field.present[b]) {
                Vector3<double> axis;
                axis[b] = 1;
                sum = sum + cross(A * f.field.moment[b], axis);
            }
        if (f.only_field) return sum;
        if (f.has_torque) sum = sum + A * f.torque;
        if (f.has_world_torque) sum = sum + f.torque_W;
        if (f.has_damping) sum = sum - A * (f.damping * (transposed(A) * w));
        for (const ForceAtWorldPoint<double>& load : f.world_points) {
            const Vector3<double> arm = f.pivoted ? load.point_W : load.point_W - x;
            sum = sum + cross(arm, load.frame == Frame::body ? A * load.force : load.force);
        }
        if (f.springs.empty() && f.user_torques.empty()) return sum;
        const Quaternion<double> q = attitude();
        for (const SpringTorque<double>& spring : f.springs) {
            const Quaternion<double> r = conjugate(spring.rest) * q;
            sum = sum + A * ((-2 * spring.stiffness * r.w) * vector_part(r));
        }
        for (const PosedUserTorque& user : f.user_torques) sum = sum + A * user(t, q, transposed(A) * w, x, v);
        return sum;
    }

    /// dv/dt of the centre of mass of a body that is not held.
    Vector3<double> acceleration_W(const Matrix3<double>& A, const Vector3<double>& v) const {
        const Forcing<double>& f = *forcing_;
        Vector3<double> a = f.acceleration_W;
        if (f.has_body_force) a = a + A * f.specific_force;
        if (f.has_translational_drag) a = a - f.specific_drag * v;
        return a;
    }

    /// L += r x J, and v += J / m where the body is not held.
    static void strike(const Problem& problem, const Segment& segment, const Matrix3<double>& A,
                       const Vector3<double>& x, Vector3<double>& L, Vector3<double>& v) {
        const bool held = problem.body.pivoted;
        for (const PosedImpulse<double>& impulse : segment.impulses) {
            const Vector3<double> J = impulse.frame == Frame::world ? impulse.vector : A * impulse.vector;
            Vector3<double> arm = A * impulse.point;
            if (impulse.point_frame == Frame::world) arm = held ? impulse.point : impulse.point - x;
            L = L + cross(arm, J);
            if (!held) v = v + (1 / problem.body.mass) * J;
        }
    }

  private:
    const Forcing<double>* forcing_;
};

}  // namespace polhode
