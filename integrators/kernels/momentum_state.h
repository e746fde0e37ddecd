// The state that methods on the rotation group share: the angular momentum in world axes and the attitude.
//
//   y = L_W, q (and p, v where the forces tie them to the attitude),   w_B = I^-1 R(q)^T L_W   in principal axes
//
// L_W changes by the loads alone: without them it is constant to the last bit, whatever the method does to q.
#pragma once

#include <cmath>

#include "body/orientation.h"
#include "integrators/game/world_loads.h"
#include "integrators/kernels/turn.h"
#include "integrators/march.h"

namespace polhode {

/// The part of a Stepper that does not depend on the method. Of a problem in principal axes.
class MomentumState {
  public:
    explicit MomentumState(const Problem& problem)
        : problem_(&problem),
          loads_(problem),
          forcing_(&problem.segments.front().forcing),
          translates_(problem.needs.dimension == 13 && !problem.body.pivoted),
          moments_(problem.principal.moments),
          inverse_moments_(problem.principal_inertia.inverse_moments) {
        restart();
    }
    void restart() {
        attitude_ = TurnedAttitude(problem_->initial_q);
        set_angular_velocity(problem_->initial_angular_velocity);
        position_ = CompensatedVector(problem_->body.position_W);
        velocity_ = CompensatedVector(problem_->body.velocity_W);
        evaluations_ = 0;
        failed_ = false;
    }
    void enter(const Segment& segment) {
        loads_.enter(segment);
        forcing_ = &segment.forcing;
        if (segment.impulses.empty()) return;
        double y[13];
        write(y);
        if (translates_) {
            polhode::enter<LoadedMotion<double>>(*problem_, segment, y);
            velocity_ = CompensatedVector(vector_at(y, 10));
        } else {
            polhode::enter<FreeRotation<double>>(*problem_, segment, y);
        }
        set_angular_velocity(vector_at(y, 0));
    }
    Sample sample(double t) const {
        double y[13];
        write(y);
        if (problem_->needs.dimension != 13) return sample_of<FreeRotation<double>>(*problem_, t, y);
        if (!translates_) {
            Vector3<double> p, v;
            pivoted_center(quaternion_at(y, 3), vector_at(y, 0), forcing_->arm, p, v);
            put(y, 7, p);
            put(y, 10, v);
        }
        return sample_of<LoadedMotion<double>>(*problem_, t, y);
    }
    bool finite() const {
        const Vector3<double> L = momentum_.value(), p = position_.value(), v = velocity_.value();
        double zeros = squared_norm(attitude_.value()) * 0;
        for (int i = 0; i < 3; ++i) zeros += (L[i] + p[i] + v[i]) * 0;
        return zeros == 0;
    }
    long rhs_evaluations() const { return evaluations_; }
    bool failed() const { return failed_; }
    void explain(Trajectory& trajectory) const {
        trajectory.status = Status::failed;
        trajectory.message = "the step's implicit equations were not solved: it is too long for them";
    }

  protected:
    /// Whether anything acts that ties L, p or v to the attitude, the rates or the time.
    bool loaded() const { return translates_ || forcing_->any_torque(); }

    Vector3<double> rates(const Vector3<double>& y_B) const {
        const Vector3<double>& r = inverse_moments_;
        return {r[0] * y_B[0], r[1] * y_B[1], r[2] * y_B[2]};
    }
    /// Torque in world axes at an attitude R = R(q), angular velocity w in principal axes, place and velocity.
    Vector3<double> torque_W(double t, const Matrix3<double>& R, const Quaternion<double>& q, const Vector3<double>& w,
                             const Vector3<double>& p, const Vector3<double>& v) const {
        return loads_.torque_W(
            t, R, [&] { return q; }, R * w, p, v);
    }
    Vector3<double> acceleration_W(const Matrix3<double>& R, const Vector3<double>& v) const {
        return loads_.acceleration_W(R, v);
    }

    const Problem* problem_;
    WorldLoads loads_;
    const Forcing<double>* forcing_;
    bool translates_;
    Vector3<double> moments_, inverse_moments_;
    CompensatedVector momentum_, position_, velocity_;
    TurnedAttitude attitude_;
    long evaluations_ = 0;
    bool failed_ = false;

  private:
    void set_angular_velocity(const Vector3<double>& w) {
        const Quaternion<double> q = attitude_.value();
        const Vector3<double> y_B(moments_[0] * w[0], moments_[1] * w[1], moments_[2] * w[2]);
        momentum_ = CompensatedVector((1 / squared_norm(q)) * rotate(q, y_B));
    }
    void write(double* y) const {
        const Quaternion<double> q = attitude_.value();
        put(y, 0, rates(rotate_back(q, momentum_.value())));
        put(y, 3, q);
        put(y, 7, position_.value());
        put(y, 10, velocity_.value());
    }
};

/// march() of a stepper on MomentumState, in principal axes whatever the problem was posed in.
template <class S, class... Options>
Trajectory march_momentum(const Problem& problem, const Settings& settings, const Options&... options) {
    if (problem.formulation == Formulation::full)
        return march<S>(pose(problem.scene, Formulation::full_principal), settings, options...);
    return march<S>(problem, settings, options...);
}

/// The same of a stepper that knows the rotation alone: `unsupported` where translation is integrated beside it.
template <class S>
Trajectory march_rotation(const Problem& problem, const Settings& settings) {
    if (problem.needs.dimension == 13 && !problem.body.pivoted)
        return unsupported("its equations are those of the rotation: where translation is integrated beside it, not");
    return march_momentum<S>(problem, settings);
}

}  // namespace polhode
