// CVODE set up on one posed problem: what the methods, the tests and the benchmark of its vector share.
#pragma once

#include <cvode/cvode.h>
#include <cvode/cvode_ls.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
#include <sunnonlinsol/sunnonlinsol_newton.h>

#include <algorithm>
#include <exception>
#include <optional>
#include <string>
#include <utility>

#include "integrators/kernels/fixed_dense_solver.h"
#include "integrators/kernels/fixed_vector.h"
#include "integrators/kernels/sundials_handles.h"
#include "motion/dual.h"
#include "motion/problem.h"

namespace polhode {

enum class Multistep { adams, bdf };

/// How the implicit equation of a step is solved: y = g(y) iterated, or Newton's method with the Jacobian.
enum class Iteration { functional, newton };

/// Vector: FixedVector<N>, or a type with the same make() and data(). Newton's method needs FixedVector.
/// SystemType: one of motion/systems.h. The problem must outlive the session. Not to be moved: CVODE points into it.
template <class SystemType, class Vector = FixedVector<SystemType::dimension>>
class CvodeSession {
  public:
    static constexpr int dimension = SystemType::dimension;

    /// Relative tolerance R, absolute tolerance R times each component's scale.
    /// Throws std::bad_alloc where there is no memory for it.
    CvodeSession(const Problem& problem, Multistep multistep, Iteration iteration, double tolerance)
        : problem_(&problem), system_(system_on<SystemType>(problem, problem.segments.front())) {
        // CVODE refuses what is too small for binary64; below this its weights, the reciprocals, would overflow
        tolerance = std::max(tolerance, 1e-100);
        initial_state<SystemType>(problem, y());
        component_scales<SystemType>(problem, Vector::data(absolute_.get()));
        for (int i = 0; i < dimension; ++i) Vector::data(absolute_.get())[i] *= tolerance;

        memory_.reset(CVodeCreate(multistep == Multistep::adams ? CV_ADAMS : CV_BDF, context_));
        if (!memory_) throw std::bad_alloc();
        void* memory = memory_.get();
        demand(CVodeSetErrHandlerFn(memory, note_message, this));
        demand(CVodeInit(memory, right_hand_side, 0, state_.get()));
        demand(CVodeSVtolerances(memory, tolerance, absolute_.get()));
        demand(CVodeSetUserData(memory, this));
        // steps that vanish against t are counted by the caller
        demand(CVodeSetMaxHnilWarns(memory, -1));
        if (iteration == Iteration::functional) {
            nonlinear_ = owned(SUNNonlinSol_FixedPoint(state_.get(), 0, context_));
            demand(CVodeSetNonlinearSolver(memory, nonlinear_.get()));
        } else if constexpr (std::is_same_v<Vector, FixedVector<dimension>>) {
            nonlinear_ = owned(SUNNonlinSol_Newton(state_.get(), context_));
            demand(CVodeSetNonlinearSolver(memory, nonlinear_.get()));
            matrix_ = owned(FixedMatrix<dimension>::make(context_));
            linear_ = owned(FixedDenseSolver<dimension>::make(context_));
            demand(CVodeSetLinearSolver(memory, linear_.get(), matrix_.get()));
            demand(CVodeSetJacFn(memory, fill_jacobian));
        }
    }
    CvodeSession(const CvodeSession&) = delete;
    CvodeSession& operator=(const CvodeSession&) = delete;

    /// Back to t = 0, all counts to zero.
    void restart() {
        initial_state<SystemType>(*problem_, y());
        steps_ = rhs_evaluations_ = refused_ = 0;
        running_ = false;
        not_finite_at_.reset();
    }

    /// An event: impulses, then the loads of this segment. The history of the steps before it is dropped.
    int enter(const Segment& segment) {
        close();
        polhode::enter<SystemType>(*problem_, segment, y());
        system_ = system_on<SystemType>(*problem_, segment);
        t_ = segment.begin, end_ = segment.end;
        if (!(end_ > t_)) return CV_SUCCESS;
        running_ = true;
        if (const int flag = CVodeReInit(memory_.get(), t_, state_.get()); flag != CV_SUCCESS) return flag;
        return CVodeSetStopTime(memory_.get(), end_);
    }

    /// One internal step, cut at the segment's end; CVODE's flag. time() and the state have moved if it is >= 0.
    /// What a torque of the user's own throws comes out here.
    int step() {
        double reached = t_;
        const int flag = CVode(memory_.get(), end_, state_.get(), &reached, CV_ONE_STEP);
        if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
        if (flag == CV_TOO_CLOSE) return leap();
        t_ = flag == CV_TSTOP_RETURN ? end_ : reached;
        return flag;
    }

    double time() const { return t_; }
    double* y() { return Vector::data(state_.get()); }

    /// The motion at time(), as CVODE left it.
    Sample sample() { return sample_of<SystemType>(*problem_, t_, y()); }

    /// The motion at a time within the last step, by the step's own interpolating polynomial.
    Sample sample_inside(double t) {
        CVodeGetDky(memory_.get(), t, 0, inside_.get());
        return sample_of<SystemType>(*problem_, t, Vector::data(inside_.get()));
    }

    /// Since restart().
    long steps() {
        close();
        return steps_;
    }
    long rhs_evaluations() {
        close();
        return rhs_evaluations_ - refused_;
    }

    /// The time at which the right-hand side was not finite, since restart().
    std::optional<double> not_finite_at() const { return not_finite_at_; }

    /// What CVODE last said of a failure.
    const std::string& message() const { return message_; }

  private:
    struct FreeMemory {
        void operator()(void* memory) const { CVodeFree(&memory); }
    };

    static void demand(int flag) {
        if (flag != CV_SUCCESS) throw std::bad_alloc();  // nothing else can fail while the arguments are right
    }

    // A rate that is not finite ends the run: CVODE would try ever smaller steps until all its steps are spent. -1 says
    // so, but SUNDIALS 6.4's fixed-point solver takes it for a failure to converge and CVODE tries again: from the
    // first -1 on there is no other answer.
    static int right_hand_side(double t, N_Vector y, N_Vector rate, void* session) {
        CvodeSession* self = static_cast<CvodeSession*>(session);
        if (self->not_finite_at_ || self->thrown_) {
            ++self->refused_;
            return -1;
        }
        double* dy = Vector::data(rate);
        try {
            self->system_.derivative(t, Vector::data(y), dy);
        } catch (...) {  // C code lies between here and step()
            self->thrown_ = std::current_exception();
            return -1;
        }
        double zeros[2] = {0, 0};
        for (int i = 0; i < dimension; ++i) zeros[i & 1] += dy[i] * 0;
        if (zeros[0] + zeros[1] == 0) return 0;
        self->not_finite_at_ = t;
        return -1;
    }

    static int fill_jacobian(double t, N_Vector y, N_Vector, SUNMatrix J, void* session, N_Vector, N_Vector, N_Vector) {
        CvodeSession* self = static_cast<CvodeSession*>(session);
        auto& entries = FixedMatrix<dimension>::entries(J);
        jacobian(self->system_, t, Vector::data(y), entries.data());
        if (entries.allFinite()) return 0;
        self->not_finite_at_ = t;
        return -1;
    }

    static void note_message(int code, const char*, const char*, char* text, void* self) {
        if (code != CV_WARNING) static_cast<CvodeSession*>(self)->message_ = text;
    }

    // a segment of a rounding error's length, which CVODE cannot start on: one explicit Euler step is exact there
    int leap() {
        double rate[dimension];
        system_.derivative(t_, y(), rate);
        for (int i = 0; i < dimension; ++i) y()[i] += (end_ - t_) * rate[i];
        t_ = end_;
        ++steps_, ++rhs_evaluations_;
        message_.clear();
        return CV_TSTOP_RETURN;
    }

    // adds CVODE's counts, which start again at every event
    void close() {
        if (!running_) return;
        running_ = false;
        long steps = 0, evaluations = 0;
        CVodeGetNumSteps(memory_.get(), &steps);
        CVodeGetNumRhsEvals(memory_.get(), &evaluations);
        steps_ += steps, rhs_evaluations_ += evaluations;
    }

    const Problem* problem_;
    SystemType system_;
    SundialsContext context_;  // before all that lives in it
    SundialsOwner<N_Vector> state_ = owned(Vector::make(context_));
    SundialsOwner<N_Vector> absolute_ = owned(Vector::make(context_));
    SundialsOwner<N_Vector> inside_ = owned(Vector::make(context_));
    SundialsOwner<SUNNonlinearSolver> nonlinear_;
    SundialsOwner<SUNMatrix> matrix_;
    SundialsOwner<SUNLinearSolver> linear_;
    std::unique_ptr<void, FreeMemory> memory_;
    double t_ = 0, end_ = 0;
    long steps_ = 0, rhs_evaluations_ = 0, refused_ = 0;
    std::optional<double> not_finite_at_;
    bool running_ = false;
    std::string message_;
    std::exception_ptr thrown_;
};

}  // namespace polhode
