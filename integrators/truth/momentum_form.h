// Second formulation of the reference, written independently so that a sign error in either of the two is detected:
// momenta in world axes, computed directly from the scene's loads. It shares with the first formulation only the
// algebra and the body's mass properties.
//
//   dL/dt = tau_W,  dq/dt = 1/2 q (0, w_B),  w_B = I^-1 R(q)^T L        L about the pivot or the centre of mass
//   dp/dt = P/m,    dP/dt = F_W                                         in flight
//
// R(q) is the homogeneous form, so the equations are polynomial in the state. They describe the motion for |q| = 1,
// which they preserve. State: L, q, and p, P if there is no pivot.
#pragma once

#include <utility>
#include <vector>

#include "integrators/truth/motion.h"
#include "motion/body_equations.h"
#include "motion/exact_body_of.h"
#include "motion/problem.h"
#include "scene/scene.h"

namespace polhode::truth {

template <class P>
class MomentumForm {
  public:
    static constexpr const char* name = "momentum form";

    explicit MomentumForm(const Scene& scene)
        : scene_(&scene), body_(mass_properties<P>(scene.body)), mass_(body_.mass), reference_(body_.center) {
        if (scene.pivot) {
            reference_ = cast<P>(*scene.pivot);
            to_center_ = body_.center - reference_;
        }
        // Steiner: I + m (|a|^2 1 - a a^T)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                inertia_[i][j] = body_.inertia[i][j] - mass_ * to_center_[i] * to_center_[j];
                if (i == j) inertia_[i][j] += mass_ * dot(to_center_, to_center_);
            }
        inverse_inertia_ = invert(inertia_);
    }

    int dimension() const { return scene_->pivot ? 7 : 13; }

    /// `moments`: any estimate of the principal moments.
    std::vector<Block> blocks(const Scales& scales, const Vector3<double>& moments) const {
        // the error of w is the error of L divided by the smallest moment
        double smallest = moments[0];
        for (int i = 1; i < 3; ++i) smallest = moments[i] < smallest ? moments[i] : smallest;
        std::vector<Block> blocks{{0, 3, smallest * scales.angular_velocity}, {3, 4, 1}};
        if (!scene_->pivot)
            blocks.insert(blocks.end(), {{7, 3, scales.position}, {10, 3, scene_->body.mass * scales.velocity}});
        return blocks;
    }

    void initial(P* y) const {
        const Initial& start = scene_->initial;
        const Quaternion<P> q = normalized(cast<P>(start.orientation));
        const Matrix3<P> axes = rotation_matrix(q);
        Vector3<P> w_B = cast<P>(start.angular_velocity);
        if (start.angular_velocity_frame == Frame::world) w_B = transposed(axes) * w_B;
        put(y, 0, axes * (inertia_ * w_B));
        put(y, 3, q);
        if (scene_->pivot) return;
        put(y, 7, cast<P>(start.position_W));
        put(y, 10, mass_ * cast<P>(start.velocity_W));
    }

    /// Sets the loads that act from `begin` on, and applies the impulses at that time to y.
    void enter(double begin, P* y) {
        acting_.clear();
        for (const Load& load : scene_->loads) {
            if (const auto* impulse = std::get_if<Impulse>(&load)) {
                if (impulse->at == begin) apply_impulse(*impulse, y);
                continue;
            }
            const Window window = window_of(load);
            if (window.from <= begin && begin < window.until) acting_.push_back(&load);
        }
    }

    template <class S>
    void derivative(const S* y, S* dy) const {
        const Vector3<S> L = vector_at(y, 0);
        const Quaternion<S> q = quaternion_at(y, 3);
        const Matrix3<S> axes = rotation_matrix(q);
        const Vector3<S> w_B = inverse_inertia_ * (transposed(axes) * L);
        Vector3<S> position, momentum;
        if (!scene_->pivot) position = vector_at(y, 7), momentum = vector_at(y, 10);

        Vector3<S> torque_W, force_W;
        for (const Load* load : acting_) {
            if (const auto* gravity = std::get_if<Gravity>(load)) {
                const Vector3<P> weight = mass_ * cast<P>(gravity->acceleration_W);
                force_W = force_W + weight;
                if (scene_->pivot) torque_W = torque_W + cross(axes * to_center_, weight);
            } else if (const auto* couple = std::get_if<Torque>(load)) {
                torque_W = torque_W + in_world<S>(couple->frame, couple->vector, axes);
            } else if (const auto* force = std::get_if<Force>(load)) {
                const Vector3<S> F = in_world<S>(force->frame, force->vector, axes);
                force_W = force_W + F;
                torque_W = torque_W + cross(arm_W<S>(force->point_frame, force->point, axes, position), F);
            } else if (const auto* drag = std::get_if<Drag>(load)) {
                const Vector3<P> c = cast<P>(drag->rotational);
                torque_W = torque_W - axes * Vector3<S>(c[0] * w_B[0], c[1] * w_B[1], c[2] * w_B[2]);
                const P translational(drag->translational);
                if (scene_->pivot) {
                    // the centre of mass moves at R (w x a); its drag exerts the torque R (a x F)
                    const Vector3<S> velocity_B = cross(w_B, to_center_);
                    torque_W = torque_W - translational * (axes * cross(to_center_, velocity_B));
                } else {
                    force_W = force_W - (translational / mass_) * momentum;
                }
            } else if (const auto* spring = std::get_if<Spring>(load)) {
                // d = q q_rest* rotates the rest attitude into the present one; its axis is the spring's, in world axes
                const Quaternion<S> d = q * conjugate(normalized(cast<P>(spring->rest_orientation)));
                torque_W = torque_W - (P(2) * P(spring->stiffness)) * (d.w * vector_part(d));
            }
        }
        put(dy, 0, torque_W);
        const Vector3<S> h = (P(1) / P(2)) * w_B;
        put(dy, 3, q * Quaternion<S>{S(0), h[0], h[1], h[2]});
        if (scene_->pivot) return;
        put(dy, 7, (P(1) / mass_) * momentum);
        put(dy, 10, force_W);
    }

    Motion<P> motion(const P* y) const {
        Motion<P> m;
        m.q = normalized(quaternion_at(y, 3));
        const Matrix3<P> axes = rotation_matrix(m.q);
        m.angular_velocity_B = inverse_inertia_ * (transposed(axes) * vector_at(y, 0));
        if (scene_->pivot) {
            m.position_W = axes * to_center_;
            m.velocity_W = axes * cross(m.angular_velocity_B, to_center_);
        } else {
            m.position_W = vector_at(y, 7);
            m.velocity_W = (P(1) / mass_) * vector_at(y, 10);
        }
        return m;
    }

  protected:
    // state: L about the pivot or the centre of mass, q; without a pivot also position and momentum
    template <class S>
    static Vector3<S> angular_momentum(const S* y) {
        return vector_at(y, 0);
    }
    template <class S>
    static Vector3<S> linear_momentum(const S* y) {
        return vector_at(y, 10);
    }
    static void set_momenta(P* y, const Vector3<P>& angular, const Vector3<P>& linear) {
        put(y, 0, angular), put(y, 10, linear);
    }

  private:
    const Scene* scene_;
    MassProperties<P> body_;
    P mass_;
    Vector3<P> reference_, to_center_;  // body point that L refers to; from it to the centre of mass; body axes
    Matrix3<P> inertia_, inverse_inertia_;
    std::vector<const Load*> acting_;

    template <class S>
    static Vector3<S> in_world(Frame frame, const Vector3<double>& v, const Matrix3<S>& axes) {
        return frame == Frame::world ? cast<S>(cast<P>(v)) : axes * cast<P>(v);
    }
    // from the point that L refers to, to the point of application
    template <class S>
    Vector3<S> arm_W(Frame point_frame, const Vector3<double>& point, const Matrix3<S>& axes,
                     const Vector3<S>& position) const {
        if (point_frame == Frame::body) return axes * (cast<P>(point) - reference_);
        return cast<P>(point) - position;  // position is zero at a pivot: the pivot is at the world's origin
    }

    void apply_impulse(const Impulse& impulse, P* y) const {
        const Matrix3<P> axes = rotation_matrix(normalized(quaternion_at(y, 3)));
        const Vector3<P> position = scene_->pivot ? Vector3<P>() : vector_at(y, 7);
        const Vector3<P> J = in_world<P>(impulse.frame, impulse.vector, axes);
        const Vector3<P> arm = arm_W<P>(impulse.point_frame, impulse.point, axes, position);
        put(y, 0, vector_at(y, 0) + cross(arm, J));
        if (!scene_->pivot) put(y, 10, vector_at(y, 10) + J);
    }

    // the inverse of a positive definite matrix, by Gauss-Jordan elimination
    static Matrix3<P> invert(Matrix3<P> m) {
        Matrix3<P> result = diagonal(Vector3<P>(P(1), P(1), P(1)));
        for (int k = 0; k < 3; ++k) {
            const P scale = P(1) / m[k][k];
            m[k] = scale * m[k], result[k] = scale * result[k];
            for (int i = 0; i < 3; ++i) {
                if (i == k) continue;
                const P multiple = m[i][k];
                m[i] = m[i] - multiple * m[k], result[i] = result[i] - multiple * result[k];
            }
        }
        return result;
    }
};

}  // namespace polhode::truth
