// State of the game-engine updates: attitude and velocities in world axes, and the loads.
#pragma once

#include "integrators/game/gyroscopic_term.h"
#include "integrators/run/march.h"
#include "motion/world_loads.h"

namespace polhode {

/// Everything of a stepper (integrators/run/march.h) except its step, in the scalar S. With a pivot, w, tau and I are
/// about the pivot, and x, v follow from q, w.
template <class S>
class EngineState {
  public:
    explicit EngineState(const Problem& problem)
        : problem_(&problem),
          loads_(problem),
          inertia_{cast<S>(problem.body.full_inertia.tensor), cast<S>(problem.body.full_inertia.inverse)},
          pivoted_(problem.body.pivoted) {
        restart();
    }
    void restart() {
        const ExactBody<double>& body = problem_->body;
        q_ = cast<S>(body.q);
        w_ = cast<S>(rotate(body.q, body.angular_velocity_B));
        x_ = cast<S>(body.position_W), v_ = cast<S>(body.velocity_W);
        move_to_pivot();
        steps_ = 0;
    }
    void enter(const Segment& segment) {
        loads_.enter(segment);
        if (segment.impulses.empty()) return;
        const Matrix3<S> R = rotation_matrix(q_);
        Vector3<S> angular_impulse;
        WorldLoads<S>::apply_impulses(*problem_, segment, R, x_, angular_impulse, v_);
        w_ = w_ + R * (inertia_.inverse * (transposed(R) * angular_impulse));
        move_to_pivot();
    }
    Sample sample(double t) const { return sample_in_world(*problem_, t, cast<double>(q_), w_, x_, v_); }
    bool finite() const { return all_finite(w_, x_, v_) && all_finite(q_); }

  protected:
    /// Torque of the loads, world axes, N m.
    Vector3<S> torque_W(double t, const Matrix3<S>& R) const {
        return loads_.torque_W(
            t, R, [&] { return q_; }, w_, x_, v_);
    }
    Vector3<S> acceleration_W(const Matrix3<S>& R) const {
        return pivoted_ ? Vector3<S>() : loads_.acceleration_W(R, v_);
    }
    /// Rotates q by the rotation vector h w and normalises it.
    void rotate_attitude(S h) { q_ = normalized(quaternion_from_rotation_vector(h * w_) * q_); }
    /// q += (h/2) (0, w) q, then normalises q.
    void rotate_first_order(S h) {
        const Vector3<S> half = (h / 2) * w_;
        const Quaternion<S> change = Quaternion<S>{0, half[0], half[1], half[2]} * q_;
        q_ = normalized(Quaternion<S>{q_.w + change.w, q_.x + change.x, q_.y + change.y, q_.z + change.z});
    }
    /// Updates v by the acceleration, then x by the new v.
    void translate(S h, const Vector3<S>& acceleration) {
        v_ = v_ + h * acceleration;
        x_ = x_ + h * v_;
    }
    void move_to_pivot() {
        if (!pivoted_) return;
        x_ = rotate(q_, loads_.forcing().arm);
        v_ = cross(w_, x_);
    }

    const Problem* problem_;
    WorldLoads<S> loads_;
    BodyInertia<S> inertia_;
    bool pivoted_;
    Quaternion<S> q_;
    Vector3<S> w_;      ///< world axes
    Vector3<S> x_, v_;  ///< centre of mass
    long steps_ = 0;
};

}  // namespace polhode
