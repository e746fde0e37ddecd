// State shared by methods on the rotation group: angular momentum in world axes and attitude.
//
//   y = L_W, q (and p, v if the forces couple them to the attitude),   w_B = I^-1 R(q)^T L_W   in principal axes
//
// L_W changes only by loads: without loads it is constant to the last bit, whatever the method does to q.
#pragma once

#include "body/orientation.h"
#include "integrators/closed_form/compensated_rotation.h"
#include "integrators/run/march.h"
#include "motion/world_loads.h"

namespace polhode {

/// The part of a Stepper that does not depend on the method, for a problem posed in principal axes. S: scalar of the
/// state.
template <class S>
class MomentumStateOf {
  public:
    explicit MomentumStateOf(const Problem& problem)
        : problem_(&problem),
          loads_(problem),
          translates_(problem.needs.translation == Translation::integrated && !problem.body.pivoted),
          moments_(cast<S>(problem.body.principal.moments)),
          inverse_moments_(cast<S>(problem.body.principal_inertia.inverse_moments)) {
        restart();
    }
    void restart() {
        attitude_ = CompensatedAttitudeOf<S>(cast<S>(problem_->body.initial_q));
        set_angular_velocity(problem_->body.initial_angular_velocity);
        position_ = CompensatedVectorOf<S>(cast<S>(problem_->body.position_W));
        velocity_ = CompensatedVectorOf<S>(cast<S>(problem_->body.velocity_W));
        evaluations_ = 0;
        failed_ = false;
    }
    void enter(const Segment& segment) {
        loads_.enter(segment);
        if (segment.impulses.empty()) return;
        double y[LoadedMotion::dimension];
        write_state(y);
        if (translates_) {
            LoadedMotion(*problem_).enter(segment, y);
            velocity_ = CompensatedVectorOf<S>(cast<S>(LoadedMotion::velocity(y)));
        } else {
            FreeRotation(*problem_).enter(segment, y);
        }
        set_angular_velocity(LoadedMotion::angular_velocity(y));
    }
    Sample sample(double t) const {
        double y[LoadedMotion::dimension];
        write_state(y);
        if (problem_->needs.translation != Translation::integrated) return FreeRotation(*problem_).motion(t, y);
        if (!translates_) {
            Vector3<double> p, v;
            pivoted_center(LoadedMotion::attitude(y), LoadedMotion::angular_velocity(y),
                           problem_->segments.front().forcing.arm, p, v);
            LoadedMotion::set_translation(y, p, v);
        }
        return LoadedMotion(*problem_).motion(t, y);
    }
    bool finite() const {
        return all_finite(momentum_.value(), position_.value(), velocity_.value()) && all_finite(attitude_.value());
    }
    long rhs_evaluations() const { return evaluations_; }
    bool failed() const { return failed_; }
    void explain(Trajectory& trajectory) const { report_unsolved_step(trajectory, sample(failed_at_)); }

  protected:
    /// Whether any load couples L, p or v to the attitude, the rates or the time.
    bool has_loads() const { return translates_ || forcing().any_torque(); }
    const Forcing<S>& forcing() const { return loads_.forcing(); }

    Vector3<S> rates(const Vector3<S>& y_B) const {
        const Vector3<S>& r = inverse_moments_;
        return {r[0] * y_B[0], r[1] * y_B[1], r[2] * y_B[2]};
    }
    /// Torque in world axes at the attitude R = R(q), angular velocity w in principal axes, position and velocity.
    Vector3<S> torque_W(double t, const Matrix3<S>& R, const Quaternion<S>& q, const Vector3<S>& w, const Vector3<S>& p,
                        const Vector3<S>& v) const {
        return loads_.torque_W(
            t, R, [&] { return q; }, R * w, p, v);
    }
    Vector3<S> acceleration_W(const Matrix3<S>& R, const Vector3<S>& v) const { return loads_.acceleration_W(R, v); }

    const Problem* problem_;
    WorldLoads<S> loads_;
    bool translates_;
    Vector3<S> moments_, inverse_moments_;
    CompensatedVectorOf<S> momentum_, position_, velocity_;
    CompensatedAttitudeOf<S> attitude_;
    long evaluations_ = 0;
    bool failed_ = false;
    double failed_at_ = 0;  ///< s, start of the failed step

  private:
    void set_angular_velocity(const Vector3<double>& w) {
        const Quaternion<double> q = cast<double>(attitude_.value());
        const Vector3<double>& moments = problem_->body.principal.moments;
        const Vector3<double> y_B(moments[0] * w[0], moments[1] * w[1], moments[2] * w[2]);
        momentum_ = CompensatedVectorOf<S>(cast<S>((1 / squared_norm(q)) * rotate(q, y_B)));
    }
    void write_state(double* y) const {
        const Quaternion<double> q = cast<double>(attitude_.value());
        const Vector3<double>& inverse = problem_->body.principal_inertia.inverse_moments;
        const Vector3<double> y_B = rotate_back(q, cast<double>(momentum_.value()));
        LoadedMotion::set_rotation(y, Vector3<double>(inverse[0] * y_B[0], inverse[1] * y_B[1], inverse[2] * y_B[2]),
                                   q);
        LoadedMotion::set_translation(y, cast<double>(position_.value()), cast<double>(velocity_.value()));
    }
};
using MomentumState = MomentumStateOf<double>;

/// march() of a stepper on MomentumState, in principal axes for any formulation of the problem.
template <class S, class... Options>
Trajectory march_momentum(const Problem& problem, const Settings& settings, const Options&... options) {
    if (problem.formulation == Formulation::full)
        return march<S>(pose(problem.scene, Formulation::full_principal), settings, options...);
    return march<S>(problem, settings, options...);
}

/// Returns why a stepper for rotations only refuses the problem, or an empty string.
inline std::string translation_refusal(const Problem& problem) {
    return problem.needs.translation == Translation::integrated && !problem.body.pivoted
               ? "this method integrates only the rotation; scenes whose translation must be integrated too are not "
                 "supported"
               : "";
}

}  // namespace polhode
