// A body's motion split into the free motion and kicks by the loads at a fixed attitude.
//
//   one stage:  kick(g h/2)  free(g h)  kick(g h/2)      (G. Strang 1968, SIAM J. Numer. Anal. 5, 506)
//   one step:   stages g_1 .. g_s of a symmetric composition; adjacent kicks are merged
//
// A kick advances L_W (and v) exactly along the flow of the torque (and force) at the current attitude and position,
// drag included. The free motion advances q and p.
#pragma once

#include <span>
#include <string>

#include "integrators/geometric/composition.h"
#include "integrators/geometric/free_flows.h"
#include "integrators/geometric/kick.h"
#include "integrators/geometric/momentum_state.h"

namespace polhode {

/// Flow: see free_flows.h. With `single_stage_when_free`, a step without loads is taken as one stage; for flows that
/// have the method's order by themselves.
template <class Flow, bool single_stage_when_free, class S = double>
class Splitting : public MomentumStateOf<S> {
    using Base = MomentumStateOf<S>;
    using Base::attitude_, Base::momentum_, Base::position_, Base::velocity_, Base::translates_, Base::failed_,
        Base::failed_at_, Base::evaluations_, Base::forcing, Base::has_loads, Base::torque_W, Base::acceleration_W;

  public:
    Splitting(const Problem& problem, const int& order) : Base(problem), flow_(problem), stages_(composition(order)) {}

    void enter(const Segment& segment) {
        Base::enter(segment);
        R_ = rotation_matrix(attitude_.value());
        flow_.prepare(transposed(R_) * momentum_.value());
        if (!has_loads()) return;
        if (forcing().has_damping)
            damping_ = RotationalDampingOf<S>(this->problem_->body.principal.moments, segment.forcing.damping);
        update_forces();
    }
    void step(double t, double step) {
        const S h = S(step);
        failed_at_ = t;
        if (!has_loads() && single_stage_when_free) {
            drift(h);
            return;
        }
        S before = 0;
        for (const double stage : stages_) {
            const S g = S(stage);
            if (has_loads()) kick(S(0.5) * (before + g) * h);
            drift(g * h);
            if (failed_) return;
            if (has_loads()) update_forces();
            before = g;
        }
        if (has_loads()) kick(S(0.5) * before * h);
    }

  private:
    Flow flow_;
    std::span<const double> stages_;
    RotationalDampingOf<S> damping_;
    Matrix3<S> R_;                      ///< at the current attitude
    Vector3<S> torque_, acceleration_;  ///< world axes, at the current attitude and position: torque without drag,
                                        ///< acceleration

    // The rates enter the torque only through drag, which the kick includes.
    void update_forces() {
        const Vector3<S> p = translates_ ? position_.value() : Vector3<S>();
        torque_ = torque_W(0, R_, attitude_.value(), {}, p, {});
        if (translates_) acceleration_ = acceleration_W(R_, {});
    }
    void kick(S h) {
        if (forcing().has_damping) {
            const Matrix3<S> back = transposed(R_);
            momentum_.add(R_ * damping_.change(h, back * momentum_.value(), back * torque_));
        } else {
            momentum_.add(h * torque_);
        }
        if (!translates_) return;
        if (forcing().has_translational_drag) {
            velocity_.add(damped_change(velocity_.value(), acceleration_, forcing().specific_drag, h));
        } else {
            velocity_.add(h * acceleration_);
        }
    }
    void drift(S h) {
        ++evaluations_;
        const Vector3<S> y = transposed(R_) * momentum_.value();
        if (has_loads()) flow_.prepare(y);
        RotationIncrementOf<S> d;
        if (!flow_.compute_rotation(y, h, d)) {
            failed_ = true;
            return;
        }
        attitude_.rotate(d);
        R_ = rotation_matrix(attitude_.value());
        if (translates_) position_.add(h * velocity_.value());
    }
};

/// Returns why a kick at a fixed attitude cannot represent the loads, or an empty string if it can.
inline std::string kick_refusal(const Problem& problem) {
    return problem.needs.user_torque ? "user-defined torques are not supported: they may depend on the rates, which a "
                                       "kick at fixed attitude ignores"
                                     : "";
}

}  // namespace polhode
