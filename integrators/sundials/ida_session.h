// IDA for a mechanism in maximal coordinates.
#pragma once

#include <fmt/format.h>
#include <ida/ida.h>
#include <ida/ida_ls.h>
#include <nvector/nvector_serial.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "integrators/maximal/constrained.h"
#include "integrators/run/solver_run.h"
#include "integrators/run/watch.h"
#include "integrators/sundials/ida_counts.h"
#include "integrators/sundials/sparse_solver.h"
#include "integrators/sundials/sundials_handles.h"
#include "motion/dual.h"
#include "motion/finite.h"
#include "motion/mechanism.h"

namespace polhode {

/// Not movable: the library holds pointers into it. Satisfies SolverSession (run/solver_run.h).
class IdaSession {
  public:
    /// Relative tolerance R, absolute tolerance R times each component's scale. The problem must be a mechanism and
    /// must outlive this object. Throws std::bad_alloc if there is not enough memory.
    IdaSession(const Problem& problem, maximal::Index index, double tolerance);
    IdaSession(const IdaSession&) = delete;
    IdaSession& operator=(const IdaSession&) = delete;

    /// Returns to t = 0 and resets all counts.
    void restart();
    /// Processes an event: impulses, then the loads of this segment. Discards the history of previous steps.
    int enter(const Segment& segment);
    /// One internal step, cut at the segment's end. Returns IDA's flag.
    int step();
    double time() const { return t_; }
    /// The motion at time(), with the reactions from the multipliers.
    Moment sample() { return moment_at(t_, y()); }
    /// The motion at a time within the last step.
    std::optional<Moment> sample_inside(double t) {
        IDAGetDky(memory_.get(), t, 0, interpolated_.get());
        return moment_at(t, N_VGetArrayPointer(interpolated_.get()));
    }
    int inside_flag() const { return IDA_SUCCESS; }
    SolverFailure failure(int flag);
    long steps() {
        collect_counts();
        return counts_.steps;
    }
    long rhs_evaluations() const { return evaluations_; }
    SolverCounts counts() {
        collect_counts();
        return {counts_.rejected_steps, counts_.newton_failures, {}};
    }

  private:
    struct FreeMemory {
        void operator()(void* memory) const { IDAFree(&memory); }
    };

    const Problem* problem_;
    std::vector<BodyMotion<double>> start_;
    maximal::System<double> system_;
    maximal::ConstrainedEquations<double> equations_;
    int n_;
    double tolerance_;
    SundialsContext context_;  // declared before the members that use it
    SundialsOwner<N_Vector> state_, state_rate_, absolute_, variable_ids_, interpolated_;
    SundialsOwner<SUNMatrix> matrix_;
    SundialsOwner<SUNLinearSolver> linear_;
    std::unique_ptr<void, FreeMemory> memory_;
    double t_ = 0, end_ = 0;
    long evaluations_ = 0;
    IdaCounts counts_;
    bool running_ = false;
    std::optional<double> not_finite_at_;
    std::string message_;

    double* y() { return N_VGetArrayPointer(state_.get()); }
    Moment moment_at(double t, const double* z) const;
    void set_tolerances();
    void make_consistent();
    void collect_counts();
    int check_finite(double t, const double* numbers, std::size_t count);
    static void check_flag(int flag) {
        if (flag != 0) throw std::bad_alloc();
    }
    static int residual(double t, N_Vector state, N_Vector rate, N_Vector result, void* session);
    static int fill_jacobian(double t, double c, N_Vector state, N_Vector, N_Vector, SUNMatrix J, void* session,
                             N_Vector, N_Vector, N_Vector);
    static void store_message(int code, const char*, const char*, char* text, void* session);
};

}  // namespace polhode
