// CVODE set up on one posed problem: what the methods, the tests and the benchmark of its vector share.
//
// The library is CVODES, of which CVODE is the part without sensitivities: conditioning needs the whole, and the two
// define the same symbols, so that one program cannot have both. Plain runs give the same bits (all scenes, three
// methods, two tolerances) and take 2 to 4 % longer, some 10 ns a step, by CVODES' questions whether there are
// sensitivities (free body, I = (1, 2, 3), omega = (1, 1, 1), T = 100, interleaved: to 1e-6 291 us instead of 280, to
// 1e-10 771 instead of 751). Renaming the symbols of one would save that
// and work only where both are compiled here.
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

/// How the implicit equation of a step is solved: y = g(y) iterated, or Newton's method with the Jacobian.
enum class Iteration { functional, newton };

/// What CVODE tells of its troubles, summed over its initialisations.
struct CvodeCounts {
    long rejected_steps = 0, newton_failures = 0, order_reductions = 0;

    void add(void* memory) {
        long rejected = 0, failures = 0, reductions = 0;
        CVodeGetNumErrTestFails(memory, &rejected);
        CVodeGetNumNonlinSolvConvFails(memory, &failures);
        CVodeGetNumStabLimOrderReds(memory, &reductions);
        rejected_steps += rejected, newton_failures += failures, order_reductions += reductions;
    }
    /// `detects_limit`: of stability, as CVODE can for BDF.
    SolverCounts told(bool detects_limit) const {
        SolverCounts counts{rejected_steps, newton_failures, {}};
        if (detects_limit) counts.order_reductions = order_reductions;
        return counts;
    }
};

/// Newton's method needs the vector by default. SystemType: a System.
template <class SystemType, class Vector = typename VectorFor<SystemType::dimension>::type>
class CvodeSession : public SundialsSession<SystemType, Vector> {
    using Base = SundialsSession<SystemType, Vector>;

  protected:
    using Base::absolute_, Base::context_, Base::end_, Base::linear_, Base::matrix_, Base::nonlinear_, Base::state_,
        Base::t_;

  public:
    using Base::dimension, Base::y;

    /// Relative tolerance R, absolute tolerance R times each component's scale.
    /// Throws std::bad_alloc where there is no memory for it.
    CvodeSession(const Problem& problem, Multistep multistep, Iteration iteration, double tolerance)
        : Base(problem, tolerance) {
        memory_.reset(CVodeCreate(multistep == Multistep::adams ? CV_ADAMS : CV_BDF, context_));
        if (!memory_) throw std::bad_alloc();
        void* memory = memory_.get();
        Base* base = this;  // what the callbacks are handed
        demand(CVodeSetErrHandlerFn(memory, Base::note_message, base));
        demand(CVodeInit(memory, Base::right_hand_side, 0, state_.get()));
        demand(CVodeSVtolerances(memory, this->tolerance_, absolute_.get()));
        demand(CVodeSetUserData(memory, base));
        // steps that vanish against t are counted by the caller
        demand(CVodeSetMaxHnilWarns(memory, -1));
        if (iteration == Iteration::functional) {
            nonlinear_ = owned(SUNNonlinSol_FixedPoint(state_.get(), 0, context_));
            demand(CVodeSetNonlinearSolver(memory, nonlinear_.get()));
            demand(CVodeSetNonlinConvCoef(memory, functional_coefficient));
            demand(CVodeSetMaxNonlinIters(memory, functional_iterations));
        } else if constexpr (std::is_same_v<Vector, typename VectorFor<dimension>::type>) {
            Base::make_newton();
            demand(CVodeSetNonlinearSolver(memory, nonlinear_.get()));
            demand(CVodeSetLinearSolver(memory, linear_.get(), matrix_.get()));
            demand(CVodeSetJacFn(memory, Base::fill_jacobian));
        }
        if constexpr (dimension == run_time)
            if (this->system_.projects() && multistep == Multistep::bdf) {
                demand(CVodeSetProjFn(memory, correct_own));
                demand(CVodeSetProjErrEst(memory, SUNFALSE));
            }
        detects_limit_ = multistep == Multistep::bdf;
        // of the orders 3 to 5, which are not stable on all of the left half plane
        if (detects_limit_) demand(CVodeSetStabLimDet(memory, SUNTRUE));
    }

    /// Projects each step's end; BDF only. Samples inside a step too. The error estimate is left as it is: with it
    /// projected CVODE 6.4 compares this order's projected estimate with its neighbours' unprojected ones, and stays at
    /// order 1 (free symmetric body, T = 100, R = 1e-6: 7001 steps instead of 1283).
    void project_onto(const Projection<SystemType>& projection) {
        projection_ = projection;
        demand(CVodeSetProjFn(memory_.get(), correct));
        demand(CVodeSetProjErrEst(memory_.get(), SUNFALSE));
    }

    /// Back to t = 0, all counts to zero.
    void restart() {
        Base::begin();
        steps_ = 0;
        counts_ = {};
        running_ = false;
    }

    /// An event: impulses, then the loads of this segment. The history of the steps before it is dropped.
    int enter(const Segment& segment) {
        close();
        Base::pass(segment);
        return resume();
    }

    /// One internal step, cut at the segment's end; CVODE's flag. time() and the state have moved if it is >= 0.
    /// What a torque of the user's own throws comes out here.
    int step() {
        double reached = t_;
        const int flag = CVode(memory_.get(), end_, state_.get(), &reached, CV_ONE_STEP);
        Base::rethrow();
        if (flag == CV_TOO_CLOSE) {
            Base::leap();
            ++steps_;
            return CV_TSTOP_RETURN;
        }
        t_ = flag == CV_TSTOP_RETURN ? end_ : reached;
        return flag;
    }

    /// Goes on from the state as it is now: the history of the steps before is dropped.
    int resume() {
        close();
        if (!(end_ > t_)) return CV_SUCCESS;
        running_ = true;
        if (const int flag = CVodeReInit(memory_.get(), t_, state_.get()); flag != CV_SUCCESS) return flag;
        return CVodeSetStopTime(memory_.get(), end_);
    }

    /// The motion at a time within the last step, by the step's own interpolating polynomial.
    auto sample_inside(double t) {
        CVodeGetDky(memory_.get(), t, 0, inside_.get());
        if constexpr (projects)
            if (projection_) projection_->project(Vector::data(inside_.get()));
        return std::optional(this->system_.motion(t, Vector::data(inside_.get())));
    }

    int inside_flag() const { return CV_SUCCESS; }

    /// What a flag below zero means.
    SolverFailure failure(int flag) {
        const bool out_of_reach = flag == CV_TOO_MUCH_ACC || flag == CV_ERR_FAILURE || flag == CV_CONV_FAILURE;
        return Base::explained("CVODE", out_of_reach ? Status::tolerance_not_met : Status::failed,
                               CVodeGetReturnFlagName(flag));
    }

    /// Since restart().
    long steps() {
        close();
        return steps_;
    }
    long rhs_evaluations() const { return this->evaluations_; }
    SolverCounts counts() {
        close();
        return counts_.told(detects_limit_);
    }

  protected:
    using Base::demand, Base::system_;

    void* memory() { return memory_.get(); }
    /// The state at a time within the last step, until the next call.
    const double* state_inside(double t) {
        CVodeGetDky(memory_.get(), t, 0, inside_.get());
        return Vector::data(inside_.get());
    }
    /// Makes a time within the last step the present one.
    void set_back(double t) {
        CVodeGetDky(memory_.get(), t, 0, state_.get());
        t_ = t;
    }

    // By default the iteration stops at a tenth of what the error test allows, and what is left of it is noise that
    // the step control takes for error: at R = 1e-12 a damped spin takes 5640 steps to 9.8e-10 rad, and with these 2940
    // to 2.0e-10; a Lagrange top 10592 to 6.9e-8, and with these 7121 to 5.6e-9.
    static constexpr double functional_coefficient = 1e-3;
    static constexpr int functional_iterations = 4;

  private:
    struct FreeMemory {
        void operator()(void* memory) const { CVodeFree(&memory); }
    };

    // the way from y to the manifold; a positive flag asks for a shorter step
    static int correct(double, N_Vector y, N_Vector correction, double, N_Vector, void* session) {
        CvodeSession* self = static_cast<CvodeSession*>(static_cast<Base*>(session));
        double *change = Vector::data(correction), *from = Vector::data(y);
        std::copy(from, from + dimension, change);
        if (!self->projection_->project(change)) return 1;
        for (int i = 0; i < dimension; ++i) change[i] -= from[i];
        return CV_SUCCESS;
    }

    static int correct_own(double, N_Vector y, N_Vector correction, double, N_Vector, void* session) {
        CvodeSession* self = static_cast<CvodeSession*>(static_cast<Base*>(session));
        double *change = Vector::data(correction), *from = Vector::data(y);
        const int n = self->system_.size();
        std::copy_n(from, n, change);
        project_step(self->system_, change);
        for (int i = 0; i < n; ++i) change[i] -= from[i];
        return CV_SUCCESS;
    }

    // adds CVODE's counts, which start again at every event
    void close() {
        if (!running_) return;
        running_ = false;
        long steps = 0;
        CVodeGetNumSteps(memory_.get(), &steps);
        steps_ += steps;
        counts_.add(memory_.get());
    }

    SundialsOwner<N_Vector> inside_ = owned(made<Vector>(context_, this->system_.size()));
    std::unique_ptr<void, FreeMemory> memory_;
    // what the motion keeps is known of the systems of one body
    static constexpr bool projects = requires { SystemType::rates; };
    struct NoProjection {};
    std::conditional_t<projects, std::optional<Projection<SystemType>>, NoProjection> projection_;
    long steps_ = 0;
    CvodeCounts counts_;
    bool running_ = false, detects_limit_ = false;
};

}  // namespace polhode
