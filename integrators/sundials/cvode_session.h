// CVODE for one posed problem, used by the methods, the tests and the benchmark of its vector.
//
// CvodeSession sets up the solver and its callbacks, advances it, and handles events (restart), dense output,
// projection and error flags. It satisfies SolverSession (run/solver_run.h).
//
// The library is CVODES, which contains CVODE. Conditioning needs its sensitivities, and one program cannot link both
// because they define the same symbols. Plain runs give the same bits (all scenes, three methods, two tolerances) and
// take 2 to 4 % longer, about 10 ns per step, because CVODES tests whether sensitivities are present (free body, I =
// (1, 2, 3), omega = (1, 1, 1), T = 100, interleaved: to 1e-6 291 us instead of 280, to 1e-10 771 instead of 751).
// Renaming the symbols of one library would avoid this, but only where both are compiled here.
#pragma once

#include <cvodes/cvodes.h>
#include <cvodes/cvodes_ls.h>
#include <cvodes/cvodes_proj.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "integrators/geometric/projection.h"
#include "integrators/sundials/sundials_session.h"

namespace polhode {

enum class Multistep { adams, bdf };

/// Solver of a step's implicit equation: fixed-point iteration y = g(y), or Newton's method with the Jacobian.
enum class Iteration { functional, newton };

/// CVODE's counts of failures, summed over its initialisations.
struct CvodeCounts {
    long rejected_steps = 0, newton_failures = 0, order_reductions = 0;

    void add(void* memory) {
        long rejected = 0, failures = 0, reductions = 0;
        CVodeGetNumErrTestFails(memory, &rejected);
        CVodeGetNumNonlinSolvConvFails(memory, &failures);
        CVodeGetNumStabLimOrderReds(memory, &reductions);
        rejected_steps += rejected, newton_failures += failures, order_reductions += reductions;
    }
    /// `detects_limit`: stability-limit detection is on (BDF only).
    SolverCounts to_solver_counts(bool detects_limit) const {
        SolverCounts counts{rejected_steps, newton_failures, {}};
        if (detects_limit) counts.order_reductions = order_reductions;
        return counts;
    }
};

/// Newton's method requires the default vector. SystemType: a System.
template <class SystemType, class Vector = typename VectorFor<SystemType::dimension>::type>
class CvodeSession : public SundialsSession<SystemType, Vector> {
    using Base = SundialsSession<SystemType, Vector>;

  protected:
    using Base::absolute_, Base::context_, Base::end_, Base::linear_, Base::matrix_, Base::nonlinear_, Base::state_,
        Base::t_;

  public:
    using Base::dimension, Base::y;

    /// Relative tolerance R, absolute tolerance R times each component's scale. Throws std::bad_alloc if there is not
    /// enough memory.
    CvodeSession(const Problem& problem, Multistep multistep, Iteration iteration, double tolerance)
        : Base(problem, tolerance) {
        memory_.reset(CVodeCreate(multistep == Multistep::adams ? CV_ADAMS : CV_BDF, context_));
        if (!memory_) throw std::bad_alloc();
        void* memory = memory_.get();
        Base* base = this;  // user data of the callbacks
        check_flag(CVodeSetErrHandlerFn(memory, Base::store_message, base));
        check_flag(CVodeInit(memory, Base::right_hand_side, 0, state_.get()));
        check_flag(CVodeSVtolerances(memory, this->tolerance_, absolute_.get()));
        check_flag(CVodeSetUserData(memory, base));
        // the caller detects steps that do not change t
        check_flag(CVodeSetMaxHnilWarns(memory, -1));
        if (iteration == Iteration::functional) {
            nonlinear_ = make_owner(SUNNonlinSol_FixedPoint(state_.get(), 0, context_));
            check_flag(CVodeSetNonlinearSolver(memory, nonlinear_.get()));
            check_flag(CVodeSetNonlinConvCoef(memory, functional_coefficient));
            check_flag(CVodeSetMaxNonlinIters(memory, functional_iterations));
        } else if constexpr (std::is_same_v<Vector, typename VectorFor<dimension>::type>) {
            Base::make_newton();
            check_flag(CVodeSetNonlinearSolver(memory, nonlinear_.get()));
            check_flag(CVodeSetLinearSolver(memory, linear_.get(), matrix_.get()));
            check_flag(CVodeSetJacFn(memory, Base::fill_jacobian));
        }
        if constexpr (dimension == run_time)
            if (this->system_.projects() && multistep == Multistep::bdf) {
                check_flag(CVodeSetProjFn(memory, compute_system_correction));
                check_flag(CVodeSetProjErrEst(memory, SUNFALSE));
            }
        detects_limit_ = multistep == Multistep::bdf;
        // for orders 3 to 5, which are not stable on the whole left half plane
        if (detects_limit_) check_flag(CVodeSetStabLimDet(memory, SUNTRUE));
    }

    /// Projects the end of each step and samples inside a step; BDF only. The error estimate is not projected:
    /// otherwise CVODE 6.4 compares the projected estimate of the current order with unprojected ones of neighbouring
    /// orders, and stays at order 1 (free symmetric body, T = 100, R = 1e-6: 7001 steps instead of 1283).
    void set_projection(const Projection<SystemType>& projection) {
        projection_ = projection;
        check_flag(CVodeSetProjFn(memory_.get(), compute_correction));
        check_flag(CVodeSetProjErrEst(memory_.get(), SUNFALSE));
    }

    /// Returns to t = 0 and resets all counts.
    void restart() {
        Base::reset_state();
        steps_ = 0;
        counts_ = {};
        running_ = false;
    }

    /// Processes an event: impulses, then the loads of this segment. Discards the history of previous steps.
    int enter(const Segment& segment) {
        collect_counts();
        Base::apply_event(segment);
        return resume();
    }

    /// One internal step, cut at the segment's end. Returns CVODE's flag; if it is >= 0, time() and the state have
    /// advanced. Rethrows exceptions of a user-defined torque.
    int step() {
        double reached = t_;
        const int flag = CVode(memory_.get(), end_, state_.get(), &reached, CV_ONE_STEP);
        Base::rethrow();
        if (flag == CV_TOO_CLOSE) {
            Base::take_euler_step();
            ++steps_;
            return CV_TSTOP_RETURN;
        }
        t_ = flag == CV_TSTOP_RETURN ? end_ : reached;
        return flag;
    }

    /// Restarts from the current state. Discards the history of previous steps.
    int resume() {
        collect_counts();
        if (!(end_ > t_)) return CV_SUCCESS;
        running_ = true;
        if (const int flag = CVodeReInit(memory_.get(), t_, state_.get()); flag != CV_SUCCESS) return flag;
        return CVodeSetStopTime(memory_.get(), end_);
    }

    /// The motion at a time within the last step, from the step's interpolating polynomial.
    auto sample_inside(double t) {
        CVodeGetDky(memory_.get(), t, 0, interpolated_.get());
        if constexpr (has_projection)
            if (projection_) projection_->project(Vector::data(interpolated_.get()));
        return std::optional(this->system_.motion(t, Vector::data(interpolated_.get())));
    }

    int inside_flag() const { return CV_SUCCESS; }

    /// Meaning of a flag below zero.
    SolverFailure failure(int flag) {
        const bool out_of_reach = flag == CV_TOO_MUCH_ACC || flag == CV_ERR_FAILURE || flag == CV_CONV_FAILURE;
        return Base::describe_failure("CVODE", out_of_reach ? Status::tolerance_not_met : Status::failed,
                                      CVodeGetReturnFlagName(flag));
    }

    /// Number of steps since restart().
    long steps() {
        collect_counts();
        return steps_;
    }
    long rhs_evaluations() const { return this->evaluations_; }
    SolverCounts counts() {
        collect_counts();
        return counts_.to_solver_counts(detects_limit_);
    }

  protected:
    using Base::check_flag, Base::system_;

    void* memory() { return memory_.get(); }
    /// The state at a time within the last step, valid until the next call.
    const double* interpolated_state(double t) {
        CVodeGetDky(memory_.get(), t, 0, interpolated_.get());
        return Vector::data(interpolated_.get());
    }
    /// Sets the current time and state to a time within the last step.
    void rewind(double t) {
        CVodeGetDky(memory_.get(), t, 0, state_.get());
        t_ = t;
    }

    // By default the iteration stops at a tenth of the tolerated error, and its remaining error acts as noise in the
    // step control. At R = 1e-12 a damped spin takes 5640 steps to 9.8e-10 rad, with these values 2940 to 2.0e-10 rad;
    // a Lagrange top takes 10592 to 6.9e-8 rad, with these values 7121 to 5.6e-9 rad.
    static constexpr double functional_coefficient = 1e-3;
    static constexpr int functional_iterations = 4;

  private:
    struct FreeMemory {
        void operator()(void* memory) const { CVodeFree(&memory); }
    };

    // the correction from y to the manifold; a positive flag requests a shorter step
    static int compute_correction(double, N_Vector y, N_Vector correction, double, N_Vector, void* session) {
        CvodeSession* self = static_cast<CvodeSession*>(static_cast<Base*>(session));
        double *change = Vector::data(correction), *from = Vector::data(y);
        std::copy(from, from + dimension, change);
        if (!self->projection_->project(change)) return 1;
        for (int i = 0; i < dimension; ++i) change[i] -= from[i];
        return CV_SUCCESS;
    }

    static int compute_system_correction(double, N_Vector y, N_Vector correction, double, N_Vector, void* session) {
        CvodeSession* self = static_cast<CvodeSession*>(static_cast<Base*>(session));
        double *change = Vector::data(correction), *from = Vector::data(y);
        const int n = self->system_.size();
        std::copy_n(from, n, change);
        project_step(self->system_, change);
        for (int i = 0; i < n; ++i) change[i] -= from[i];
        return CV_SUCCESS;
    }

    // adds CVODE's counts, which restart at every event
    void collect_counts() {
        if (!running_) return;
        running_ = false;
        long steps = 0;
        CVodeGetNumSteps(memory_.get(), &steps);
        steps_ += steps;
        counts_.add(memory_.get());
    }

    SundialsOwner<N_Vector> interpolated_ = make_owner(make_vector<Vector>(context_, this->system_.size()));
    std::unique_ptr<void, FreeMemory> memory_;
    // the invariants are known for the systems of one body
    static constexpr bool has_projection = requires { SystemType::rates; };
    struct NoProjection {};
    std::conditional_t<has_projection, std::optional<Projection<SystemType>>, NoProjection> projection_;
    long steps_ = 0;
    CvodeCounts counts_;
    bool running_ = false, detects_limit_ = false;
};

}  // namespace polhode
