// ARKODE's ARKStep for one posed problem, with a fixed step or a tolerance.
//
// ArkodeSession sets up the solver and its callbacks, advances it, and handles events (restart), samples inside a step
// (a second session from the start of the step) and error flags. It satisfies SolverSession (run/solver_run.h).
#pragma once

#include <arkode/arkode_arkstep.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "integrators/sundials/sundials_session.h"

namespace polhode {

/// One of ARKODE's default Butcher tables.
struct ArkodeTable {
    bool implicit;  // diagonally implicit if true, otherwise explicit
    int order;
};

/// SystemType: a System.
///
/// Uses ARKStep although ERKStep does less work. ERKStep 6.4 reuses the last stage's rate for the next step's first
/// stage if the last abscissa is 1, which is correct only if that stage equals the end of the step. Measured on a free
/// symmetric body, its default tables of orders 6 and 8 then show orders 3.0 and 7.1.
template <class SystemType>
class ArkodeSession : public SundialsSession<SystemType> {
    using Base = SundialsSession<SystemType>;
    using Base::absolute_, Base::context_, Base::end_, Base::linear_, Base::matrix_, Base::nonlinear_, Base::offset_,
        Base::state_, Base::t_;
    using Base::demand;

  public:
    using Base::dimension, Base::y;

    /// With a tolerance R: absolute tolerance R times each component's scale. Without: steps of given length, with
    /// implicit stages solved to round-off. Throws std::bad_alloc if there is not enough memory.
    ArkodeSession(const Problem& problem, ArkodeTable table, std::optional<double> tolerance)
        : Base(problem, tolerance.value_or(newton_tolerance)), table_(table) {
        memory_.reset(ARKStepCreate(explicit_part(), implicit_part(), 0, state_.get(), context_));
        if (!memory_) throw std::bad_alloc();
        void* memory = memory_.get();
        Base* base = this;  // user data of the callbacks
        demand(ARKStepSetErrHandlerFn(memory, Base::note_message, base));
        demand(ARKStepSVtolerances(memory, this->tolerance_, absolute_.get()));
        demand(ARKStepSetUserData(memory, base));
        if constexpr (dimension == run_time)
            if (this->system_.projects()) demand(ARKStepSetPostprocessStepFn(memory, project));
        demand(ARKStepSetOrder(memory, table.order));
        // no interpolation is used: choose the least expensive polynomial
        demand(ARKStepSetInterpolantType(memory, ARK_INTERP_LAGRANGE));
        demand(ARKStepSetInterpolantDegree(memory, 0));
        // the caller detects steps that do not change t
        demand(ARKStepSetMaxHnilWarns(memory, -1));
        if (!table.implicit) return;
        Base::make_newton();
        demand(ARKStepSetNonlinearSolver(memory, nonlinear_.get()));
        demand(ARKStepSetLinearSolver(memory, linear_.get(), matrix_.get()));
        demand(ARKStepSetJacFn(memory, Base::fill_jacobian));
        if (tolerance) return;
        // a fixed step cannot be shortened: new Jacobian in each step and up to 20 iterations
        demand(ARKStepSetLSetupFrequency(memory, 1));
        demand(ARKStepSetJacEvalFrequency(memory, 1));
        demand(ARKStepSetMaxNonlinIters(memory, 20));
    }

    /// Returns to t = 0 and resets all counts.
    void restart() {
        Base::begin();
        steps_ = 0;
        counts_ = {}, counted_ = {};
        if (aside_) aside_->restart();
    }

    /// Processes an event: impulses, then the loads of this segment. Restarts ARKODE's step control.
    int enter(const Segment& segment) {
        Base::pass(segment);
        if (!(end_ > t_)) return ARK_SUCCESS;
        offset_ = 0, reached_ = t_;
        count();
        const int flag = ARKStepReInit(memory_.get(), explicit_part(), implicit_part(), t_, state_.get());
        counted_ = told();
        return flag;
    }

    /// A step of length h from t on the caller's clock; ARKODE's own clock accumulates rounding errors.
    int fixed_step(double t, double h) {
        if (h != length_)
            if (const int flag = ARKStepSetFixedStep(memory_.get(), length_ = h); flag != ARK_SUCCESS) return flag;
        offset_ = t - reached_;
        const int flag = ARKStepEvolve(memory_.get(), reached_ + h, state_.get(), &reached_, ARK_ONE_STEP);
        Base::rethrow();
        t_ = t + h;
        if (flag >= 0) ++steps_;
        return flag;
    }

    /// One step with ARKODE's step control, cut at the segment's end. Returns its flag; if it is >= 0, time() and the
    /// state have advanced. Rethrows exceptions of a user-defined torque.
    int step() {
        before_ = t_;
        std::copy_n(y(), this->system_.size(), y_before_.begin());
        return controlled_step();
    }

    /// The motion at a time within the last step, later than the previous call's. ARKODE's interpolation has at most
    /// degree 5, so another session with the same table integrates there from the start of the step.
    auto sample_inside(double t) -> std::optional<decltype(this->sample())> {
        if (!aside_) aside_.reset(new ArkodeSession(*this->problem_, table_, this->tolerance_));
        ArkodeSession& aside = *aside_;
        aside.system_ = this->system_;
        std::copy(y_before_.begin(), y_before_.end(), aside.y());
        aside.t_ = aside.reached_ = before_, aside.end_ = t;
        inside_flag_ =
            ARKStepReInit(aside.memory_.get(), explicit_part(), implicit_part(), before_, aside.state_.get());
        // the table was accurate enough for the whole step, so it is for t - before
        if (inside_flag_ >= 0) inside_flag_ = ARKStepSetInitStep(aside.memory_.get(), t - before_);
        while (inside_flag_ >= 0 && aside.t_ < t) inside_flag_ = aside.controlled_step();
        if (inside_flag_ < 0) {
            this->message_ = aside.message_, this->not_finite_at_ = aside.not_finite_at_;
            return std::nullopt;
        }
        before_ = t;
        std::copy_n(aside.y(), this->system_.size(), y_before_.begin());
        return aside.sample();
    }
    /// Flag of the last sample_inside() that returned nothing.
    int inside_flag() const { return inside_flag_; }

    /// Number of steps since restart(), without steps for samples.
    long steps() const { return steps_; }
    /// Number of right-hand-side evaluations since restart(), without those for samples.
    long rhs_evaluations() const { return this->evaluations_; }
    /// Number of evaluations for samples inside a step since restart().
    long sample_evaluations() const { return aside_ ? aside_->evaluations_ : 0; }
    SolverCounts counts() {
        count();
        SolverCounts counts{counts_.rejected_steps, {}, {}};
        if (table_.implicit) counts.newton_failures = counts_.newton_failures;
        return counts;
    }

    /// Meaning of a flag below zero.
    SolverFailure failure(int flag) {
        const bool out_of_reach = flag == ARK_TOO_MUCH_ACC || flag == ARK_ERR_FAILURE || flag == ARK_CONV_FAILURE;
        return Base::explained("ARKODE", out_of_reach ? Status::tolerance_not_met : Status::failed,
                               ARKStepGetReturnFlagName(flag));
    }

  private:
    // ARKODE then iterates until a correction is below about 1e-15 of the scale
    static constexpr double newton_tolerance = 1e-14;

    struct FreeMemory {
        void operator()(void* memory) const { ARKStepFree(&memory); }
    };

    struct Counts {
        long rejected_steps = 0, newton_failures = 0;
    };
    Counts told() const {
        Counts counts;
        ARKStepGetNumErrTestFails(memory_.get(), &counts.rejected_steps);
        ARKStepGetNumNonlinSolvConvFails(memory_.get(), &counts.newton_failures);
        return counts;
    }
    void count() {
        const Counts now = told();
        counts_.rejected_steps += now.rejected_steps - counted_.rejected_steps;
        counts_.newton_failures += now.newton_failures - counted_.newton_failures;
        counted_ = now;
    }

    ARKRhsFn explicit_part() const { return table_.implicit ? nullptr : Base::right_hand_side; }
    ARKRhsFn implicit_part() const { return table_.implicit ? Base::right_hand_side : nullptr; }

    // projects the end of every accepted step onto the system's invariants
    static int project(realtype, N_Vector y, void* session) {
        ArkodeSession* self = static_cast<ArkodeSession*>(static_cast<Base*>(session));
        project_step(self->system_, VectorFor<dimension>::type::data(y));
        return ARK_SUCCESS;
    }

    int controlled_step() {
        // a stop time is valid until it is reached
        if (const int flag = ARKStepSetStopTime(memory_.get(), end_); flag != ARK_SUCCESS) return flag;
        const int flag = ARKStepEvolve(memory_.get(), end_, state_.get(), &reached_, ARK_ONE_STEP);
        Base::rethrow();
        if (flag == ARK_TOO_CLOSE) {
            Base::leap();
            ++steps_;
            return ARK_TSTOP_RETURN;
        }
        t_ = flag == ARK_TSTOP_RETURN ? end_ : reached_;
        if (flag >= 0) ++steps_;
        return flag;
    }

    ArkodeTable table_;
    std::unique_ptr<void, FreeMemory> memory_;
    std::unique_ptr<ArkodeSession> aside_;
    double reached_ = 0;  // s, on ARKODE's clock
    double length_ = 0;   // s, fixed step that was set last
    double before_ = 0;
    Numbers<dimension> y_before_{this->system_.size()};
    int inside_flag_ = ARK_SUCCESS;
    long steps_ = 0;
    Counts counts_, counted_;  // since restart(); ARKODE's counts at the last query
};

}  // namespace polhode
