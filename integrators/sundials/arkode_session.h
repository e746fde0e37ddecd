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
    using Base::check_flag;

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
        check_flag(ARKStepSetErrHandlerFn(memory, Base::store_message, base));
        check_flag(ARKStepSVtolerances(memory, this->tolerance_, absolute_.get()));
        check_flag(ARKStepSetUserData(memory, base));
        if constexpr (dimension == run_time)
            if (this->system_.projects()) check_flag(ARKStepSetPostprocessStepFn(memory, project));
        check_flag(ARKStepSetOrder(memory, table.order));
        // no interpolation is used: choose the least expensive polynomial
        check_flag(ARKStepSetInterpolantType(memory, ARK_INTERP_LAGRANGE));
        check_flag(ARKStepSetInterpolantDegree(memory, 0));
        // the caller detects steps that do not change t
        check_flag(ARKStepSetMaxHnilWarns(memory, -1));
        if (!table.implicit) return;
        Base::make_newton();
        check_flag(ARKStepSetNonlinearSolver(memory, nonlinear_.get()));
        check_flag(ARKStepSetLinearSolver(memory, linear_.get(), matrix_.get()));
        check_flag(ARKStepSetJacFn(memory, Base::fill_jacobian));
        if (tolerance) return;
        // a fixed step cannot be shortened: new Jacobian in each step and up to 20 iterations
        check_flag(ARKStepSetLSetupFrequency(memory, 1));
        check_flag(ARKStepSetJacEvalFrequency(memory, 1));
        check_flag(ARKStepSetMaxNonlinIters(memory, 20));
    }

    /// Returns to t = 0 and resets all counts.
    void restart() {
        Base::reset_state();
        steps_ = 0;
        counts_ = {}, last_counts_ = {};
        if (sample_session_) sample_session_->restart();
    }

    /// Processes an event: impulses, then the loads of this segment. Restarts ARKODE's step control.
    int enter(const Segment& segment) {
        Base::apply_event(segment);
        if (!(end_ > t_)) return ARK_SUCCESS;
        offset_ = 0, arkode_time_ = t_;
        update_counts();
        const int flag = ARKStepReInit(memory_.get(), explicit_part(), implicit_part(), t_, state_.get());
        last_counts_ = query_counts();
        return flag;
    }

    /// A step of length h from t on the caller's clock; ARKODE's own clock accumulates rounding errors.
    int fixed_step(double t, double h) {
        if (h != step_size_)
            if (const int flag = ARKStepSetFixedStep(memory_.get(), step_size_ = h); flag != ARK_SUCCESS) return flag;
        offset_ = t - arkode_time_;
        const int flag = ARKStepEvolve(memory_.get(), arkode_time_ + h, state_.get(), &arkode_time_, ARK_ONE_STEP);
        Base::rethrow();
        t_ = t + h;
        if (flag >= 0) ++steps_;
        return flag;
    }

    /// One step with ARKODE's step control, cut at the segment's end. Returns its flag; if it is >= 0, time() and the
    /// state have advanced. Rethrows exceptions of a user-defined torque.
    int step() {
        step_start_ = t_;
        std::copy_n(y(), this->system_.size(), y_step_start_.begin());
        return controlled_step();
    }

    /// The motion at a time within the last step, later than the previous call's. ARKODE's interpolation has at most
    /// degree 5, so another session with the same table integrates there from the start of the step.
    auto sample_inside(double t) -> std::optional<decltype(this->sample())> {
        if (!sample_session_) sample_session_.reset(new ArkodeSession(*this->problem_, table_, this->tolerance_));
        ArkodeSession& session = *sample_session_;
        session.system_ = this->system_;
        std::copy(y_step_start_.begin(), y_step_start_.end(), session.y());
        session.t_ = session.arkode_time_ = step_start_, session.end_ = t;
        inside_flag_ =
            ARKStepReInit(session.memory_.get(), explicit_part(), implicit_part(), step_start_, session.state_.get());
        // the table was accurate enough for the whole step, so it is for t - before
        if (inside_flag_ >= 0) inside_flag_ = ARKStepSetInitStep(session.memory_.get(), t - step_start_);
        while (inside_flag_ >= 0 && session.t_ < t) inside_flag_ = session.controlled_step();
        if (inside_flag_ < 0) {
            this->message_ = session.message_, this->not_finite_at_ = session.not_finite_at_;
            return std::nullopt;
        }
        step_start_ = t;
        std::copy_n(session.y(), this->system_.size(), y_step_start_.begin());
        return session.sample();
    }
    /// Flag of the last sample_inside() that returned nothing.
    int inside_flag() const { return inside_flag_; }

    /// Number of steps since restart(), without steps for samples.
    long steps() const { return steps_; }
    /// Number of right-hand-side evaluations since restart(), without those for samples.
    long rhs_evaluations() const { return this->evaluations_; }
    /// Number of evaluations for samples inside a step since restart().
    long sample_evaluations() const { return sample_session_ ? sample_session_->evaluations_ : 0; }
    SolverCounts counts() {
        update_counts();
        SolverCounts counts{counts_.rejected_steps, {}, {}};
        if (table_.implicit) counts.newton_failures = counts_.newton_failures;
        return counts;
    }

    /// Meaning of a flag below zero.
    SolverFailure failure(int flag) {
        const bool out_of_reach = flag == ARK_TOO_MUCH_ACC || flag == ARK_ERR_FAILURE || flag == ARK_CONV_FAILURE;
        return Base::describe_failure("ARKODE", out_of_reach ? Status::tolerance_not_met : Status::failed,
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
    Counts query_counts() const {
        Counts counts;
        ARKStepGetNumErrTestFails(memory_.get(), &counts.rejected_steps);
        ARKStepGetNumNonlinSolvConvFails(memory_.get(), &counts.newton_failures);
        return counts;
    }
    void update_counts() {
        const Counts now = query_counts();
        counts_.rejected_steps += now.rejected_steps - last_counts_.rejected_steps;
        counts_.newton_failures += now.newton_failures - last_counts_.newton_failures;
        last_counts_ = now;
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
        const int flag = ARKStepEvolve(memory_.get(), end_, state_.get(), &arkode_time_, ARK_ONE_STEP);
        Base::rethrow();
        if (flag == ARK_TOO_CLOSE) {
            Base::take_euler_step();
            ++steps_;
            return ARK_TSTOP_RETURN;
        }
        t_ = flag == ARK_TSTOP_RETURN ? end_ : arkode_time_;
        if (flag >= 0) ++steps_;
        return flag;
    }

    ArkodeTable table_;
    std::unique_ptr<void, FreeMemory> memory_;
    std::unique_ptr<ArkodeSession> sample_session_;
    double arkode_time_ = 0;  // s, on ARKODE's clock
    double step_size_ = 0;    // s, fixed step that was set last
    double step_start_ = 0;
    Numbers<dimension> y_step_start_{this->system_.size()};
    int inside_flag_ = ARK_SUCCESS;
    long steps_ = 0;
    Counts counts_, last_counts_;  // since restart(); ARKODE's counts at the last query
};

}  // namespace polhode
